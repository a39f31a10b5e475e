/// Sandstone in the evening: shade, terracotta, ochre, sand, sky.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.027, 0.019, 0.03), vec3(0.262, 0.061, 0.03), vec3(0.604, 0.254, 0.072),
                         vec3(0.839, 0.658, 0.352), vec3(0.332, 0.456, 0.527));
}
