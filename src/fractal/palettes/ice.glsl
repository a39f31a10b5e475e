/// Glacier: deep water, blue, cyan, snow.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.002, 0.009, 0.025), vec3(0.006, 0.065, 0.156), vec3(0.05, 0.296, 0.456),
                         vec3(0.392, 0.687, 0.745), vec3(0.905, 0.939, 0.956));
}
