/// Mother of pearl: pale hues that come and go at different rates (Quilez 1999).
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_cosine(t, vec3(0.60, 0.58, 0.62), vec3(0.25, 0.22, 0.28), vec3(1.0, 2.0, 1.0), vec3(0.0, 0.25, 0.55));
}
