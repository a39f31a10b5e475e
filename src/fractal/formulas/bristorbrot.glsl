/// The Bristorbrot: a square of triplets whose parts mix without trigonometry.
/// Doug Bristor (2009, fractalforums.com); distance estimate 0.5 r ln(r) / |dr| with the scalar derivative 2 r.
#include "fractal/orbit.glsl"

uniform int iterations; //! 12 [1, 100] | Most iterations of the map
uniform float bailout; //! 4 [3, 100] log | Escape radius

// The square stretches some directions by more than 2 r. Measured: up to 1.42 times the distance.
const float step_factor = 0.7;

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    orbit.derivative = 2.0 * sqrt(orbit.r2) * orbit.derivative + orbit.dc;
    orbit.z = vec3(z.x * z.x - z.y * z.y - z.z * z.z, z.y * (2.0 * z.x - z.z), z.z * (2.0 * z.x + z.y)) + orbit.c;
}

float bound() { return 2.01; }

float estimate(Orbit orbit) {
    float r = sqrt(max(orbit.r2, 1e-30));
    // Far outside, r ln(r) would grow beyond the distance.
    if (orbit.i == 0) return r - bound();
    return max(0.5 * log(r) * r / max(orbit.derivative, 1e-30), 0.0);
}
