/// Light that a lens scatters around bright things: a wide, energy-conserving blur of the picture, mixed in.
/// The kernel is 1 / (1 + (r/s)^2)^2, the shape measured for the eye and lenses (Spencer et al. 1995), as a sum of B-splines: a pyramid of
/// halved pictures (Burt & Adelson 1983), each weighed by its part of the kernel and added up on the way back (Jimenez 2014).
#pragma apeiron invalidates present
#pragma apeiron pyramid
#include "post/effect.glsl"

uniform float strength; //! 0.12 [0, 1] step 0.01 | Part of the light that is scattered
uniform float radius;   //! 0.06 [0.002, 0.5] log | Width of the glow, relative to the picture's height

// The kernel with s = 1 is the integral over u of exp(-u), times Gaussians of variance 1 / (2 u). Level l has the variance 4^l / 2,
// so that the part of those from 4^(l - 1) to 4^l falls to it; the last one has all the rest.
float part_below(int l) {
    float size = radius * float(effect_size.y);
    return l < 0 ? 0.0 : (l == effect_levels ? 1.0 : exp(-0.5 * size * size / exp2(2.0 * float(l))));
}

float part_of(int l) { return part_below(l) - part_below(l - 1); }

// Half the size: the weights 1 3 3 1 in either direction, which halve a quadratic B-spline.
vec3 halved(ivec2 texel) {
    ivec2 last = textureSize(effect_color, 0) - 1;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 k = ivec2(i & 3, i >> 2);
        ivec2 weight = 1 + 2 * ((k ^ (k >> 1)) & 1);
        sum += float(weight.x * weight.y) * texelFetch(effect_color, clamp(2 * texel - 1 + k, ivec2(0), last), 0).rgb;
    }
    return sum / 64.0;
}

// Twice the size: the spline's subdivision (Chaikin 1974), 1 3 or 3 1.
vec3 doubled(ivec2 texel) {
    ivec2 last = textureSize(effect_color, 0) - 1;
    ivec2 near = clamp(texel >> 1, ivec2(0), last);
    ivec2 far = clamp((texel >> 1) + 2 * (texel & 1) - 1, ivec2(0), last);
    vec3 x = 3.0 * texelFetch(effect_color, near, 0).rgb + texelFetch(effect_color, ivec2(far.x, near.y), 0).rgb;
    vec3 y = 3.0 * texelFetch(effect_color, ivec2(near.x, far.y), 0).rgb + texelFetch(effect_color, far, 0).rgb;
    return (3.0 * x + y) / 16.0;
}

void kernel_main(ivec2 pixel, out vec4 color) {
    vec4 here = texelFetch(effect_same, pixel, 0);
    if (effect_pass < effect_levels) {
        // The last level begins the sum.
        color = vec4(halved(pixel) * (effect_level == effect_levels ? part_of(effect_levels) : 1.0), 1.0);
    } else {
        vec3 sum = part_of(effect_level) * here.rgb;
        if (effect_levels > 0) sum += doubled(pixel);
        color = effect_level > 0 ? vec4(sum, 1.0) : vec4(mix(here.rgb, sum, strength), here.a);
    }
}
