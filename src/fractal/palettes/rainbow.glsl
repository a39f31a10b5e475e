/// All hues in turn, soft and without an end: three cosines, a third of a period apart (Quilez 1999).
#include "fractal/gradient.glsl"

vec3 color(float t) { return gradient_cosine(t, vec3(0.42), vec3(0.38), vec3(1.0), vec3(0.0, 0.333, 0.667)); }
