/// Several isosurfaces at once, each as opaque as it is wanted, in the colours of the transfer function. One opaque surface with
/// shadows and global illumination: the renderers raymarch and pathtrace.
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/brdf.glsl"
#include "render/glsl/field.glsl"

uniform float step;      //! 0.5 [0.05, 4] log | Distance of the places where crossings are looked for, in voxels
uniform vec4 values;     //! (0.35, 0.7, 0, 0) [0, 1] | Isovalues of up to four surfaces, 0 to 1 over what the transfer function shows
uniform vec4 opacities;  //! (0.35, 1, 0, 0) [0, 1] | Their opacities seen straight on; 0: there is none
uniform float roughness; //! 0.35 [0, 1] | Roughness of the surfaces
uniform float sky_light; //! 1 [0, 4] | Strength of the environment's light

vec3 lit(ivec2 pixel, vec3 position, vec3 n, vec3 v, vec3 color) {
    Material m = Material(color, roughness, 0.0, vec3(0.0));
    vec3 gloss = brdf_environment(m, n, v);
    vec3 mirrored = environment_at(normalize(mix(reflect(-v, n), n, roughness * roughness)));
    vec3 sum = sky_light * (color * (1.0 - gloss) * environment_irradiance(n) * 0.318309886 + gloss * mirrored);
    for (int i = 0; i < light_count; ++i) {
        vec2 u = vec2(0.0);
        if (light_flat(i)) u = random_pair(pixel, 8u + uint(i));
        LightSample light = light_shading(i, position, u);
        sum += brdf_value(2, m, n, v, light.direction) * light.irradiance;
    }
    return sum;
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    vec3 sum = vec3(0.0);
    float through = 1.0;
    bool inside = field_clip(ray);
    float stride = max(step * field_spacing(), (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    float border = t;
    bool first = true;
    // Outside of the box there is nothing, so that surfaces are closed where they leave it.
    float before = 0.0;
    Slice slice = Slice(1e30, vec4(0.0));
    if (inside) slice = slice_next(ray, slice_start(ray));
    float here = 0.0;
    int brick = 0;
    for (int turn = 0; turn < (inside ? 8192 : 0); ++turn) {
        // To where something is met: what comes after this is long, and processors without a GPU do it for all of a few neighbours as
        // soon as one of them has to.
        vec4 crossed = vec4(0.0);
        bool ended = false;
        for (; brick < 32768; ++brick) {
            // Where bricks have none of the values in them, all of it is on the side of the place before: the first one tells.
            if (!first && t >= border && t < ray.t_max) {
                vec2 range = field_range(ray, t, border);
                bvec4 held = bvec4(ivec4(lessThanEqual(vec4(range.x), values)) * ivec4(greaterThanEqual(vec4(range.y), values)) *
                                  ivec4(greaterThan(opacities, vec4(0.0))));
                // Not past the end: that closes what is open.
                if (!any(held)) t = min(t + ceil(max(border - t, 0.0) / stride) * stride, ray.t_max + 0.5 * stride);
            }
            for (int n = 0; n < (first || t < border || t >= ray.t_max ? 8192 : 0); ++n) {
                before = here;
                here = t < ray.t_max ? field_value(ray.origin + t * ray.direction) : 0.0;
                crossed = vec4(lessThan(vec4(before) - values, vec4(0.0))) - vec4(lessThan(vec4(here) - values, vec4(0.0)));
                crossed = abs(crossed) * vec4(greaterThan(opacities, vec4(0.0)));
                first = false;
                ended = t >= ray.t_max;
                t += stride;
                if (t >= min(border, ray.t_max) || dot(crossed, vec4(1.0)) > 0.0 || slice.t <= t - stride) break;
            }
            if (ended || dot(crossed, vec4(1.0)) > 0.0 || slice.t <= t - stride) break;
        }
        float reach = ended ? 1e29 : t - stride;
        // From the nearest to the farthest: in the order of their values, upwards or downwards, and slices in between.
        for (int n = 0; n < (dot(crossed, vec4(1.0)) > 0.0 || slice.t <= reach ? 8 : 0); ++n) {
            int k = -1;
            for (int j = 0; j < 4; ++j) {
                if (crossed[j] > 0.0 && (k < 0 || (here > before ? values[j] < values[k] : values[j] > values[k]))) k = j;
            }
            float a = max(t - 2.0 * stride, ray.t_min);
            float b = min(t - stride, ray.t_max);
            for (int j = 0; j < 6; ++j) {
                float c = 0.5 * (a + b);
                if (k < 0) break;
                bool beyond = (field_value(ray.origin + c * ray.direction) < values[k]) == (here < values[k]);
                a = beyond ? a : c;
                b = beyond ? c : b;
            }
            float at = 0.5 * (a + b);
            if (k < 0 || slice.t <= at) {
                sum += through * slice.color.a * slice.color.rgb;
                if (through == 1.0 && slice.color.a > 0.0) {
                    geometry = vec4(-ray.direction, slice.t);
                    albedo = vec4(slice.color.rgb, 1.0);
                }
                through *= 1.0 - slice.color.a;
                slice = slice_next(ray, slice.t);
                continue;
            }
            crossed[k] = 0.0;
            vec3 position = ray.origin + at * ray.direction;
            vec3 gradient = field_gradient(position);
            float steepness = length(gradient);
            vec3 normal = steepness > 0.0 ? gradient / steepness : -ray.direction;
            normal = dot(normal, ray.direction) > 0.0 ? -normal : normal;
            // A thin layer is seen through a longer way where it is seen at an angle.
            float cosine = max(-dot(normal, ray.direction), 0.05);
            float cover = opacities[k] >= 1.0 ? 1.0 : 1.0 - pow(1.0 - opacities[k], 1.0 / cosine);
            vec3 color = field_tint(values[k]);
            sum += through * cover * lit(pixel, position, normal, -ray.direction, color);
            if (through == 1.0) {
                geometry = vec4(normal, at);
                albedo = vec4(color, 1.0);
            }
            through *= 1.0 - cover;
            if (dot(crossed, vec4(1.0)) == 0.0 && slice.t > reach) break;
        }
        if (ended || through <= 4e-3 || brick >= 32768) break;
    }
    vec3 behind = environment_transparent ? vec3(0.0) : environment_at(ray.direction);
    radiance = vec4(sum + through * behind, environment_transparent ? 1.0 - through : 1.0);
}
