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
uniform int estimate_shift;   // log2 of the interleave factor: shifts, as integer division is slow everywhere
uniform ivec2 estimate_block; // size of one sub-image

// The sub-image that a pixel belongs to.
ivec2 estimate_offset(ivec2 pixel) { return pixel & ((1 << estimate_shift) - 1); }

// Where the estimate of a pixel, or of its neighbour in sub-image `offset`, is stored.
ivec2 estimate_texel(ivec2 pixel, ivec2 offset) { return offset * estimate_block + (pixel >> estimate_shift); }
