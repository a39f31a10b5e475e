// What is there of a picture in the accumulators of integrate_mean.glsl or, before the first sample is complete, in its estimate.
//
// The engine adds: const bool present_accumulated: it is the accumulators' turn. (Rasterisers on the CPU would read both.)
#include "render/glsl/accumulator_mean.glsl"
#include "render/glsl/camera.glsl"

uniform int estimate_done;         // complete sub-images of the first sample
uniform int estimate_nearest[64];  // steps to the nearest complete one (see interleave.hpp)
uniform ivec2 estimate_current;    // offset of the sub-image in progress
uniform ivec2 estimate_band;       // its part that is there: first texel and number of texels, cyclically, in the order of render::TileCursor

// Whether the estimate of a pixel in the sub-image in progress is there.
bool present_in_band(ivec2 pixel) {
    ivec2 cell = estimate_cell(pixel);
    if (pixel - estimate_factor * cell != estimate_current) return false;
    int top = cell.y & ~7;
    int rows = min(8, estimate_block.y - top);
    int i = top * estimate_block.x + cell.x * rows + cell.y - top - estimate_band.x;
    return (i < 0 ? i + estimate_block.x * estimate_block.y : i) < estimate_band.y;
}

// The nearest pixel that has a new value.
bool present_nearest(ivec2 pixel, out ivec2 from) {
    from = pixel;
    bool there = true;
    // Nothing to look for where all are there.
    bool all = present_accumulated || estimate_done == estimate_factor * estimate_factor;
    if (!all && !present_in_band(pixel)) {
        there = estimate_done > 0;
        ivec2 inside = pixel - estimate_factor * estimate_cell(pixel);
        int code = there ? estimate_nearest[inside.y * 8 + inside.x] : 0x88;
        from += ivec2((code & 15) - 8, (code >> 4) - 8);
        // Pixels of the same sub-image lie a cell apart.
        from += estimate_factor * (ivec2(lessThan(from, ivec2(0))) - ivec2(greaterThanEqual(from, camera_size)));
    }
    return there;
}

void present_new(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    if (!present_accumulated) {
        ivec2 texel = estimate_texel(pixel);
        radiance = texelFetch(estimate_radiance, texel, 0);
        geometry = texelFetch(estimate_geometry, texel, 0);
        albedo = texelFetch(estimate_albedo, texel, 0);
    } else {
        vec4 mean = texelFetch(accumulator_mean, pixel, 0);
        vec4 normal = texelFetch(accumulator_normal, pixel, 0);
        vec4 color = texelFetch(accumulator_albedo, pixel, 0);
        float hits = max(color.w, 1e-20);
        float length2 = dot(normal.xyz, normal.xyz);
        radiance = vec4(mean.rgb, texelFetch(accumulator_spread, pixel, 0).w);
        geometry = vec4(length2 > 0.0 ? normal.xyz * inversesqrt(length2) : vec3(0.0), normal.w / hits);
        albedo = vec4(color.rgb / hits, color.w);
    }
}
