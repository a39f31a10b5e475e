#include "render/glsl/hash.glsl"

// Heights of a tile's vertices, bit for bit those of terrain/height.hpp: each vertex descends on its own from the
// window of the tile's cell. Integers that wrap around; no textures, so tiles need no order.

// What decides the heights of a tile, set by terrain::setTile() (terrain/tile_kernel.hpp).
uniform int terrain_window[16];     // the cell's heights, Cell::window
uniform ivec2 terrain_cell;         // its place, modulo 2^32
uniform int terrain_levels;         // the vertices' level below the cell's: 2^levels cells along a side
uniform int terrain_outer;          // outer weight of an even point's parents, of 8: 1 B-spline, 0 bilinear
uniform int terrain_hash[8];        // of each level below the cell's, LevelUniforms
uniform int terrain_amplitude[8];
uniform int terrain_step[8];

// A child's height from four columns' (or three and nothing) sums along y: weights (w.x, w.y, w.z, w.w) along x.
int terrain_child(ivec4 sums, ivec4 weights, int reference, int step) {
    int sum = sums.x * weights.x + sums.y * weights.y + sums.z * weights.z + sums.w * weights.w;
    return (reference << step) + ((sum - 64 * reference) >> (6 - step));
}

// Weights of the window's four rows or columns for the child point k (0 to 3) of the child's window, whose first is
// point 1 + bit counted from twice the window's first.
ivec4 terrain_weights(int point) {
    int m = point >> 1;
    ivec4 place = ivec4(0, 1, 2, 3) - m;
    // Odd: 4 at m and m + 1. Even: 8 - 2 outer at m, outer beside it.
    ivec4 odd = ivec4(equal(place, ivec4(0))) * 4 + ivec4(equal(place, ivec4(1))) * 4;
    ivec4 even = ivec4(equal(place, ivec4(0))) * (8 - 2 * terrain_outer) +
                 ivec4(equal(abs(place), ivec4(1))) * terrain_outer;
    return (point & 1) != 0 ? odd : even;
}

// One row of the child's window, at `point` along y, before the noise.
ivec4 terrain_row(ivec4 w0, ivec4 w1, ivec4 w2, ivec4 w3, int point, ivec4 a, ivec4 b, ivec4 c, ivec4 d, int step) {
    ivec4 y = terrain_weights(point);
    ivec4 sums = w0 * y.x + w1 * y.y + w2 * y.z + w3 * y.w;
    // Any reference near will do, the result is the same.
    int r = w1.y;
    return ivec4(terrain_child(sums, a, r, step), terrain_child(sums, b, r, step), terrain_child(sums, c, r, step),
                 terrain_child(sums, d, r, step));
}

ivec4 terrain_noise(uint hash, uint amplitude, uint x, uint y) {
    uint row = random_hash(y ^ hash);
    uvec4 h = uvec4(random_hash(x ^ row), random_hash((x + 1u) ^ row), random_hash((x + 2u) ^ row),
                    random_hash((x + 3u) ^ row));
    return ivec4((((h >> 16) * amplitude) >> 15) - amplitude);
}

// Heights of a vertex, from (-1, -1) to (N + 1, N + 1): x of the mesh itself, y of the mesh with twice the spacing at the
// vertex that this one slides to, `vertex & ~1`. Both in units of the vertices' level.
ivec2 terrain_height(ivec2 vertex) {
    int cells = 1 << terrain_levels;
    // The cell of the last level that is descended to; the window reaches one point beyond it on each side.
    ivec2 last = clamp(vertex, ivec2(0), ivec2(cells - 1));
    ivec4 w0 = ivec4(terrain_window[0], terrain_window[1], terrain_window[2], terrain_window[3]);
    ivec4 w1 = ivec4(terrain_window[4], terrain_window[5], terrain_window[6], terrain_window[7]);
    ivec4 w2 = ivec4(terrain_window[8], terrain_window[9], terrain_window[10], terrain_window[11]);
    ivec4 w3 = ivec4(terrain_window[12], terrain_window[13], terrain_window[14], terrain_window[15]);
    int coarse = 0;
    for (int level = 0; level < 8; ++level) {
        if (level >= terrain_levels) break;
        int rest = terrain_levels - 1 - level;
        int step = terrain_step[level];
        if (rest == 0) {
            ivec2 at = (vertex >> 1) - (last >> 1) + 1;
            ivec4 row = at.y == 0 ? w0 : at.y == 1 ? w1 : at.y == 2 ? w2 : w3;
            coarse = row[at.x] << step;
        }
        ivec2 place = last >> rest;
        ivec2 bit = place & 1;
        ivec4 a = terrain_weights(1 + bit.x);
        ivec4 b = terrain_weights(2 + bit.x);
        ivec4 c = terrain_weights(3 + bit.x);
        ivec4 d = terrain_weights(4 + bit.x);
        // The child's window begins one point before the child.
        uvec2 first = (uvec2(terrain_cell) << (level + 1)) + uvec2(place) - 1u;
        uint hash = uint(terrain_hash[level]);
        uint amplitude = uint(terrain_amplitude[level]);
        ivec4 n0 = terrain_row(w0, w1, w2, w3, 1 + bit.y, a, b, c, d, step) +
                   terrain_noise(hash, amplitude, first.x, first.y);
        ivec4 n1 = terrain_row(w0, w1, w2, w3, 2 + bit.y, a, b, c, d, step) +
                   terrain_noise(hash, amplitude, first.x, first.y + 1u);
        ivec4 n2 = terrain_row(w0, w1, w2, w3, 3 + bit.y, a, b, c, d, step) +
                   terrain_noise(hash, amplitude, first.x, first.y + 2u);
        ivec4 n3 = terrain_row(w0, w1, w2, w3, 4 + bit.y, a, b, c, d, step) +
                   terrain_noise(hash, amplitude, first.x, first.y + 3u);
        w0 = n0;
        w1 = n1;
        w2 = n2;
        w3 = n3;
    }
    ivec2 at = vertex - last + 1;
    ivec4 row = at.y == 0 ? w0 : at.y == 1 ? w1 : at.y == 2 ? w2 : w3;
    return ivec2(row[at.x], coarse);
}
