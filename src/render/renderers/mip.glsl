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
    // Slices count as what they show; one that hides more than half ends the ray.
    vec3 sliced = vec3(0.0);
    float t_sliced = 0.0;
    float hidden = 0.0;
    Slice slice = Slice(1e30, vec4(0.0));
    if (inside) slice = slice_next(ray, slice_start(ray));
    for (int i = 0; i < 4 && slice.t < 1e30 && hidden < 0.5; ++i) {
        vec3 here = slice.color.a * slice.color.rgb;
        bool brighter = slice.color.a > 0.0 && (hidden == 0.0 || dot(here - sliced, vec3(1.0)) > 0.0);
        sliced = brighter ? here : sliced;
        t_sliced = brighter ? slice.t : t_sliced;
        hidden = max(hidden, slice.color.a);
        ray.t_max = slice.color.a >= 0.5 ? min(slice.t, ray.t_max) : ray.t_max;
        slice = slice_next(ray, slice.t);
    }
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    float border;
    for (int brick = 0; brick < (inside && t < ray.t_max ? 8192 : 0); ++brick) {
        // Bricks that have nothing larger, or nothing that is seen, are stepped over.
        if (field_range(ray, t, border).y <= max(most, low)) t += ceil(max(border - t, 0.0) / stride) * stride;
        border = min(border, ray.t_max);
        for (int n = 0; n < (t < border ? 8192 : 0); ++n) {
            float value = field_value(ray.origin + t * ray.direction);
            where = value > most ? t : where;
            most = max(most, value);
            t += stride;
            if (t >= border) break;
        }
        if (t >= ray.t_max) break;
    }
    float shown = clamp((most - low) / max(high - low, 1e-6), 0.0, 1.0);
    vec3 color = colored ? field_tint(most) : vec3(1.0);
    vec3 light = color * shown;
    bool is_slice = hidden > 0.0 && dot(sliced - light, vec3(1.0)) >= 0.0;
    light = is_slice ? sliced : light;
    where = is_slice ? t_sliced : where;
    float cover = environment_transparent ? max(float(shown > 0.0), hidden) : 1.0;
    radiance = vec4(light, cover);
    if (shown > 0.0 || is_slice) {
        geometry = vec4(-ray.direction, where);
        albedo = vec4(is_slice ? sliced : color, 1.0);
    }
}
