/// Reef: navy, teal, sand, coral, crimson.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.005, 0.021, 0.048), vec3(0.013, 0.175, 0.188), vec3(0.839, 0.716, 0.479),
                         vec3(0.871, 0.216, 0.117), vec3(0.392, 0.012, 0.045));
}
