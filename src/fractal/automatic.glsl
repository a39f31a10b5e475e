#include "fractal/fractal.glsl"

// The distance of a map of which nothing is known but itself.

// Maps of degree n take r to r^n far outside, folds and inversions with a factor take r to about s r. A map and its point
// far away are constants of the kernel, and so is then what follows from them.
bool fractal_grows_as_power() {
    vec2 r2 = vec2(0.0);
    for (int k = 0; k < 2; ++k) {
        vec3 far = (k == 0 ? 50.0 : 55.0) * vec3(0.48, 0.6, 0.64);
        Orbit orbit = Orbit(far, 0.0, vec3(0.0), 0.0, 1.0, 0.0, dot(far, far), 0);
        for (int i = 0; i < fractal_cycle(); ++i)
            fractal_step(orbit);
        r2[k] = orbit.r2;
    }
    // Half way between the degrees 1 and 2; high powers may leave the range of floats.
    return r2.y > 1e37 || r2.y > r2.x * pow(1.1, 3.0);
}

float fractal_automatic(Orbit orbit) {
    return fractal_grows_as_power() ? fractal_logarithmic(orbit) : fractal_linear(orbit);
}
