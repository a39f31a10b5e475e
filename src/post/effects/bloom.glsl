/// Light that a lens scatters around bright things: a wide, energy-conserving blur of the picture, mixed in.
/// The kernel falls off as 1 / (1 + (r/s)^2)^2, the shape measured for the eye and lenses (Spencer et al. 1995), over a golden-angle spiral.
#pragma apeiron invalidates present
#include "post/effect.glsl"

uniform float strength; //! 0.12 [0, 1] step 0.01 | Part of the light that is scattered
uniform float radius;   //! 0.06 [0.002, 0.5] log | Width of the glow, relative to the picture's height
uniform int taps;       //! 96 [8, 1024] log | Looks around each pixel: more are smoother and slower

void kernel_main(ivec2 pixel, out vec4 color) {
    vec4 here = effect_at(pixel);
    float size = radius * float(effect_size.y);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < taps; ++i) {
        // The radius whose share of the kernel is u; the last part of the tail is left out.
        float u = (float(i) + 0.5) / float(taps) * 0.96;
        float r = size * sqrt(u / (1.0 - u));
        float angle = 2.399963230 * float(i);
        sum += effect_at(pixel + ivec2(floor(r * vec2(cos(angle), sin(angle)) + 0.5))).rgb;
    }
    color = vec4(mix(here.rgb, sum / float(taps), strength), here.a);
}
