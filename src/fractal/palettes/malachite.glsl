/// Banded green stone: near black, bottle green, copper green, mint, cream.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.002, 0.014, 0.01), vec3(0.004, 0.08, 0.051), vec3(0.023, 0.262, 0.144),
                         vec3(0.262, 0.578, 0.352), vec3(0.855, 0.807, 0.631));
}
