// An estimate, laid out as interleaved sub-images, and the accumulators of means: what integrate_mean and present_mean share.
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
uniform int estimate_factor;  // of interleaving: sub-images are factor x factor
uniform ivec2 estimate_block; // size of one sub-image
uniform ivec2 estimate_origin; // where the first one lies

// The cell of factor x factor pixels that a pixel belongs to. Integer division is slow everywhere; this one is exact.
ivec2 estimate_cell(ivec2 pixel) { return ivec2((vec2(pixel) + 0.5) / float(estimate_factor)); }

// Where the estimate of a pixel is stored.
ivec2 estimate_texel(ivec2 pixel) {
    ivec2 cell = estimate_cell(pixel);
    return (pixel - estimate_factor * cell) * estimate_block + cell + estimate_origin;
}
