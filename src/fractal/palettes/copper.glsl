/// Weathered metal: umber, copper, polished edge, verdigris.
#include "fractal/gradient.glsl"

vec3 color(float t) {
    return gradient_five(t, vec3(0.023, 0.008, 0.005), vec3(0.254, 0.058, 0.018), vec3(0.745, 0.352, 0.162),
                         vec3(0.144, 0.392, 0.296), vec3(0.025, 0.144, 0.133));
}
