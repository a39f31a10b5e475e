/// Depth: how far away it is where the volume has become opaque, near bright and far dark, for a look at forms and for other programs.
/// The distance itself [world units] is in the geometry layer of EXR files.
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/field.glsl"

uniform float step;      //! 0.5 [0.05, 4] log | Distance of the places that are looked at, in voxels
uniform float opacity;   //! 0.5 [0.01, 0.99] | How opaque it must have become
uniform float contrast;  //! 1 [0.1, 10] log | Power of the brightness: large values show the nearest parts only

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    bool inside = field_clip(ray);
    float stride = max(step * field_spacing(), (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    float t_end = t;
    float seen = -log(1.0 - opacity); // optical depth that is left
    Slice slice = Slice(1e30, vec4(0.0));
    if (inside) slice = slice_next(ray, slice_start(ray));
    for (int i = 0; i < 8192 && inside && (t < ray.t_max || slice.t < 1e30) && seen > 0.0; ++i) {
        if (slice.t <= t || t >= ray.t_max) {
            seen += log(max(1.0 - slice.color.a, 1e-6));
            t = seen > 0.0 ? t : slice.t;
            slice = slice_next(ray, slice.t);
            continue;
        }
        bool something = true;
        for (int k = 0; k < 8 && t >= t_end; ++k) {
            something = field_segment(ray, t, t_end);
            if (!something) t += ceil(max(t_end - t, 0.0) / stride) * stride;
        }
        if (!something || t >= ray.t_max || t >= slice.t) continue;
        float extinction = field_color(ray.origin + t * ray.direction).a;
        float part = extinction * stride;
        // Within the last step, to where it is reached.
        t += part > seen ? stride * (seen / part) : stride;
        seen -= part;
    }
    bool found = inside && seen <= 0.0;
    vec4 bounds = field_bounds();
    float shown = clamp(0.5 - 0.5 * (t - length(bounds.xyz)) / bounds.w, 0.0, 1.0);
    radiance = found ? vec4(vec3(pow(shown, contrast)), 1.0) : vec4(0.0, 0.0, 0.0, environment_transparent ? 0.0 : 1.0);
    geometry = found ? vec4(-ray.direction, t) : vec4(0.0);
    albedo = found ? vec4(1.0) : vec4(0.0);
}
