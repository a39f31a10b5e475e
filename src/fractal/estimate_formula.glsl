#include "fractal/fractal.glsl"

// The distance with the derivative that the formulas keep themselves.
float fractal_distance(vec3 p) { return fractal_estimate(fractal_orbit(p)); }
