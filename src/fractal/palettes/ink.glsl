/// Paper and ink: from black to warm white.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.004, 0.004, 0.005), vec3(0.04, 0.04, 0.045), vec3(0.188, 0.181, 0.195),
                         vec3(0.479, 0.456, 0.423), vec3(0.905, 0.863, 0.791));
}
