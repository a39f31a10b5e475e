/// Light that a lens scatters around bright things: a wide, energy-conserving blur of the picture, mixed in.
/// The kernel is 1 / (1 + (r/s)^2)^2, the shape measured for the eye and lenses (Spencer et al. 1995), as a sum of Gaussians: a pyramid
/// of halved pictures (Burt & Adelson 1983), each weighed by its part of the kernel.
#pragma apeiron invalidates present
#pragma apeiron passes 11
#include "post/effect.glsl"

uniform float strength; //! 0.12 [0, 1] step 0.01 | Part of the light that is scattered
uniform float radius;   //! 0.06 [0.002, 0.5] log | Width of the glow, relative to the picture's height

// All passes but the last one make a level each.
const int most_levels = 10;

int levels() {
    int count = 0;
    for (int l = 1; l <= most_levels; ++l) count += (1 << l) <= min(effect_size.x, effect_size.y) ? 1 : 0;
    return count;
}

ivec2 level_size(int l) { return (effect_size + (1 << l) - 1) >> l; }

// The levels share one picture: the first on the left, all others above each other on its right.
ivec2 level_place(int l) {
    ivec2 place = ivec2(l == 1 ? 0 : level_size(1).x, 0);
    for (int k = 2; k < l; ++k) place.y += level_size(k).y;
    return place;
}

vec3 level_at(int l, ivec2 texel) {
    texel = clamp(texel, ivec2(0), level_size(l) - 1);
    if (l == 0) return texelFetch(effect_input, texel, 0).rgb;
    return texelFetch(effect_color, level_place(l) + texel, 0).rgb;
}

// Half the size: weights 1 3 3 1 in either direction.
vec3 halved(int l, ivec2 texel) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 k = ivec2(i & 3, i >> 2);
        ivec2 weight = 1 + 2 * ((k ^ (k >> 1)) & 1);
        sum += float(weight.x * weight.y) * level_at(l, 2 * texel - 1 + k);
    }
    return sum / 64.0;
}

// A level at a pixel of the picture, interpolated by quadratic B-splines.
vec3 level_smooth(int l, ivec2 pixel) {
    vec2 place = (vec2(pixel) + 0.5) / float(1 << l) - 0.5;
    vec2 nearest = floor(place + 0.5);
    vec2 f = place - nearest;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 9; ++i) {
        ivec2 k = ivec2(i - 3 * (i / 3), i / 3) - 1;
        vec2 side = vec2(0.5) + vec2(k) * f;
        vec2 weight = mix(vec2(0.75) - f * f, 0.5 * side * side, vec2(abs(k)));
        sum += weight.x * weight.y * level_at(l, ivec2(nearest) + k);
    }
    return sum;
}

// The kernel with s = 1 is the integral over u of exp(-u), times Gaussians of variance 1 / (2 u). Level l is one of variance 4^l / 2,
// so that the part of those from 4^(l - 1) to 4^l falls to it.
vec3 scattered(ivec2 pixel) {
    float size = radius * float(effect_size.y);
    int count = levels();
    vec3 sum = vec3(0.0);
    float before = 0.0;
    for (int l = 0; l <= count; ++l) {
        float up_to = l == count ? 1.0 : exp(-0.5 * size * size / exp2(2.0 * float(l)));
        sum += (up_to - before) * (l == 0 ? level_at(0, pixel) : level_smooth(l, pixel));
        before = up_to;
    }
    return sum;
}

void kernel_main(ivec2 pixel, out vec4 color) {
    int level = effect_pass + 1;
    if (level > most_levels) {
        vec4 here = texelFetch(effect_input, pixel, 0);
        color = vec4(mix(here.rgb, scattered(pixel), strength), here.a);
        return;
    }
    color = effect_at(pixel);
    ivec2 texel = pixel - level_place(level);
    bool inside = level <= levels() && all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, level_size(level)));
    // (A loop of at most one turn: rasterisers on the CPU skip an empty loop, but not an `if`.)
    for (int i = inside ? 0 : 1; i < 1; ++i) color.rgb = halved(level - 1, texel);
}
