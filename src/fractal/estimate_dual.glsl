#include "fractal/estimate_potential.glsl"

// The distance by dual numbers: the orbit carries its gradient along, the whole Jacobian J, and r has the gradient J^T z / r.

vec3 fractal_gradient(DualOrbit orbit) { return orbit.r2.g * (0.5 * inversesqrt(max(orbit.r2.v, 1e-30))); }

float fractal_distance(vec3 p) {
    DualOrbit orbit = fractal_orbit(Dual3(p, mat3(1.0)));
    return fractal_distance_by(dual_value(orbit), fractal_gradient(orbit), p);
}

vec3 distance_gradient(vec3 p) { return fractal_gradient(fractal_orbit(Dual3(subject_origin + p, mat3(1.0)))); }
