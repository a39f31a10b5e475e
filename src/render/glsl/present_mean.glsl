// Turns the accumulators of integrate_mean.glsl into radiance, geometry and albedo. Before the first sample is complete, shows
// its sub-images: each pixel takes the finest one that is there.
#include "render/glsl/accumulator_mean.glsl"

uniform int estimate_done;   // complete sub-images of the first sample; -1: show the accumulators
uniform int estimate_rank[64]; // order of the sub-image at offset y * 8 + x

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    if (estimate_done >= 0) {
        ivec2 offset = estimate_offset(pixel);
        for (int mask = 0; mask < (1 << estimate_shift); mask = 2 * mask + 1) {
            ivec2 coarser = offset & ~mask;
            if (estimate_rank[coarser.y * 8 + coarser.x] >= estimate_done) continue;
            ivec2 texel = estimate_texel(pixel, coarser);
            radiance = texelFetch(estimate_radiance, texel, 0);
            geometry = texelFetch(estimate_geometry, texel, 0);
            albedo = texelFetch(estimate_albedo, texel, 0);
            return;
        }
        radiance = vec4(0.0);
        geometry = vec4(0.0);
        albedo = vec4(0.0);
        return;
    }
    vec4 mean = texelFetch(accumulator_mean, pixel, 0);
    vec4 normal = texelFetch(accumulator_normal, pixel, 0);
    vec4 color = texelFetch(accumulator_albedo, pixel, 0);
    float hits = max(color.w, 1e-20);
    float length2 = dot(normal.xyz, normal.xyz);
    radiance = vec4(mean.rgb, texelFetch(accumulator_spread, pixel, 0).w);
    geometry = vec4(length2 > 0.0 ? normal.xyz * inversesqrt(length2) : vec3(0.0), normal.w / hits);
    albedo = vec4(color.rgb / hits, color.w);
}
