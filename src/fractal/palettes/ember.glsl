/// Charred wood that glows: soot, dark red, orange, straw.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.008, 0.006, 0.005), vec3(0.102, 0.007, 0.005), vec3(0.479, 0.04, 0.005),
                         vec3(0.863, 0.254, 0.018), vec3(0.939, 0.738, 0.361));
}
