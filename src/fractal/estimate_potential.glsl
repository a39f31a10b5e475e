#include "fractal/fractal.glsl"

// What estimates from the orbit's last radius and its gradient have in common: |grad r| is the derivative, whatever the
// maps are. r belongs to Hubbard & Douady's potential (1982), which has the same gradient's direction at every step.

// Length without squares that overflow.
float fractal_length(vec3 v) {
    float most = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return most > 0.0 ? most * length(v / most) : 0.0;
}

float fractal_distance_by(Orbit orbit, vec3 gradient, vec3 p) {
    orbit.derivative = max(fractal_length(gradient), 1e-30);
    float d = fractal_estimate(orbit);
    // Far outside the potential says too much: a set of about that size is not nearer than this.
    float most = max(0.5 * length(p), 1.0);
    return d <= most ? d : most;
}
