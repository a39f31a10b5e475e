// Folds one estimate into running means and the sum of squared deviations (Welford 1962): stable for millions of samples, and
// mergeable (Chan, Golub & LeVeque 1983).
//
// mean:   rgb mean radiance, w number of samples          spread: rgb sum of squared deviations, w mean alpha
// normal: xyz mean of hits' normals, w mean of hits' depth   albedo: rgb mean of hits' albedo, w part of samples that hit

uniform sampler2D estimate_radiance;
uniform sampler2D estimate_geometry;
uniform sampler2D estimate_albedo;
uniform sampler2D accumulator_mean;
uniform sampler2D accumulator_spread;
uniform sampler2D accumulator_normal;
uniform sampler2D accumulator_albedo;
uniform int estimate_shift;    // log2 of the interleave factor: shifts, as integer division is slow everywhere
uniform ivec2 estimate_block; // size of one sub-image
uniform bool accumulator_empty; // nothing was accumulated yet: whatever the buffers hold

void kernel_main(ivec2 pixel, out vec4 mean, out vec4 spread, out vec4 normal, out vec4 albedo) {
    ivec2 texel = (pixel & ((1 << estimate_shift) - 1)) * estimate_block + (pixel >> estimate_shift);
    vec4 radiance = texelFetch(estimate_radiance, texel, 0);
    vec4 geometry = texelFetch(estimate_geometry, texel, 0);
    vec4 color = texelFetch(estimate_albedo, texel, 0);
    mean = accumulator_empty ? vec4(0.0) : texelFetch(accumulator_mean, pixel, 0);
    spread = accumulator_empty ? vec4(0.0) : texelFetch(accumulator_spread, pixel, 0);
    float count = mean.w + 1.0;
    vec3 before = radiance.rgb - mean.rgb;
    mean = vec4(mean.rgb + before / count, count);
    spread += vec4(before * (radiance.rgb - mean.rgb), (radiance.w - spread.w) / count);
    normal = accumulator_empty ? vec4(0.0) : texelFetch(accumulator_normal, pixel, 0);
    normal += (geometry - normal) / count;
    albedo = accumulator_empty ? vec4(0.0) : texelFetch(accumulator_albedo, pixel, 0);
    albedo += (color - albedo) / count;
}
