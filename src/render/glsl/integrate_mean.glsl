// Folds one estimate into running means and the sum of squared deviations (Welford 1962): stable for millions of samples, and
// mergeable (Chan, Golub & LeVeque 1983).
#include "render/glsl/accumulator_mean.glsl"

uniform bool accumulator_empty; // nothing was accumulated yet: whatever the buffers hold

void kernel_main(ivec2 pixel, out vec4 mean, out vec4 spread, out vec4 normal, out vec4 albedo) {
    ivec2 texel = estimate_texel(pixel);
    vec4 radiance = texelFetch(estimate_radiance, texel, 0);
    vec4 geometry = texelFetch(estimate_geometry, texel, 0);
    vec4 color = texelFetch(estimate_albedo, texel, 0);
    mean = vec4(0.0);
    spread = vec4(0.0);
    normal = vec4(0.0);
    albedo = vec4(0.0);
    if (!accumulator_empty) {
        mean = texelFetch(accumulator_mean, pixel, 0);
        spread = texelFetch(accumulator_spread, pixel, 0);
        normal = texelFetch(accumulator_normal, pixel, 0);
        albedo = texelFetch(accumulator_albedo, pixel, 0);
    }
    if (radiance.w < 0.0) return; // this pixel needed no other sample
    float count = mean.w + 1.0;
    vec3 before = radiance.rgb - mean.rgb;
    mean = vec4(mean.rgb + before / count, count);
    spread += vec4(before * (radiance.rgb - mean.rgb), (radiance.w - spread.w) / count);
    normal += (geometry - normal) / count;
    albedo += (color - albedo) / count;
}
