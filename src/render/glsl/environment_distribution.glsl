#include "render/glsl/environment_map.glsl"

// Directions in proportion to the environment's light: a piecewise constant distribution, inverted row by row (Pharr, Jakob &
// Humphreys 2023, "Physically Based Rendering", 4th ed., A.5.6). Every direction has some density.

// x: part of the row's light up to and with this cell, y: probability per solid angle [1/sr],
// z: part of all light up to and with this row, w: mean radiance of the whole environment
uniform sampler2D environment_distribution;

float environment_mean() { return texelFetch(environment_distribution, ivec2(0), 0).w; }

float environment_pdf(vec3 direction) { return texelFetch(environment_distribution, environment_cell(direction), 0).y; }

// The first cell along a row, or the first row, whose part is more than u; u becomes the place within it.
int environment_find(bool row, int y, inout float u) {
    int low = 0;
    int high = (row ? environment_cells.y : environment_cells.x) - 1;
    float below = 0.0;
    float above = 1.0;
    for (int i = 0; i < 12 && low < high; ++i) {
        int middle = (low + high) >> 1;
        vec4 texel = texelFetch(environment_distribution, row ? ivec2(0, middle) : ivec2(middle, y), 0);
        float part = row ? texel.z : texel.x;
        if (u < part) {
            high = middle;
            above = part;
        } else {
            low = middle + 1;
            below = part;
        }
    }
    u = clamp((u - below) / max(above - below, 1e-20), 0.0, 0.999999);
    return low;
}

// A direction for u in [0, 1)², and its probability per solid angle.
vec3 environment_sample(vec2 u, out float pdf) {
    int y = environment_find(true, 0, u.y);
    int x = environment_find(false, y, u.x);
    pdf = texelFetch(environment_distribution, ivec2(x, y), 0).y;
    return environment_direction((vec2(x, y) + u) / vec2(environment_cells));
}
