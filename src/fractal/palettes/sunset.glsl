/// Dusk: indigo, violet, rose, orange, pale yellow.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.012, 0.01, 0.058), vec3(0.107, 0.023, 0.156), vec3(0.527, 0.061, 0.15),
                         vec3(0.888, 0.254, 0.098), vec3(0.965, 0.761, 0.381));
}
