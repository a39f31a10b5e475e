#include "fractal/estimate_potential.glsl"

// The distance by finite differences of the orbit's last radius, after as many steps (Makin 2009; Buddhi 2010).

vec3 fractal_gradient(Orbit orbit, vec3 p) {
    // Floats near p are 1e-7 |p| apart: smaller steps would measure rounding, larger ones miss detail.
    float h = 2e-5 * max(length(p), 0.1);
    vec3 gradient = vec3(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        vec3 near = p + h * vec3(axis == 0, axis == 1, axis == 2);
        Orbit other = fractal_start(near);
        for (int i = 0; i < formula_iterations; ++i) {
            if (i >= orbit.i) break;
            fractal_step(other);
        }
        // The logarithm is the potential, which is smoother than the radius.
        gradient[axis] = 0.5 * log(max(other.r2, 1e-30) / max(orbit.r2, 1e-30)) / (near[axis] - p[axis]);
    }
    return sqrt(orbit.r2) * gradient;
}

float fractal_distance(vec3 p) {
    Orbit orbit = fractal_orbit(p);
    return fractal_distance_by(orbit, fractal_gradient(orbit, p), p);
}

vec3 distance_gradient(vec3 p) {
    vec3 q = subject_origin + p;
    return fractal_gradient(fractal_orbit(q), q);
}
