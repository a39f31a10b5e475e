/// Maximum intensity projection: each pixel shows the largest value along its ray, as angiographies do.
/// Wallis, Miller, Lerner & Kleerup (1989, "Three-Dimensional Display in Nuclear Medicine").
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/field.glsl"

uniform float step;    //! 0.5 [0.05, 4] log | Distance of the places that are looked at, in voxels
uniform float low;     //! 0 [0, 1] | Values up to this are black (0: the lowest that is shown, 1: the highest)
uniform float high;    //! 1 [0, 1] | Values from this on are white
uniform bool colored;  //! false | White takes the colour that the transfer function gives to the value

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    bool inside = field_clip(ray);
    float most = 0.0;
    float where = ray.t_min;
    float stride = max(step * field_spacing(), (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    for (int i = 0; i < 8192 && inside && t < ray.t_max; ++i) {
        float value = field_value(ray.origin + t * ray.direction);
        where = value > most ? t : where;
        most = max(most, value);
        t += stride;
    }
    float shown = clamp((most - low) / max(high - low, 1e-6), 0.0, 1.0);
    vec3 color = colored ? field_tint(most) : vec3(1.0);
    float cover = environment_transparent ? float(shown > 0.0) : 1.0;
    radiance = vec4(color * shown, cover);
    if (shown > 0.0) {
        geometry = vec4(-ray.direction, where);
        albedo = vec4(color, 1.0);
    }
}
