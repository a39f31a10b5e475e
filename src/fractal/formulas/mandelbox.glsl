/// The Mandelbox: box fold, ball fold, scale and shift.
/// Tom Lowe (2010); distance estimate r / |dr| with the scalar derivative of Rrrola and Buddhi (2010).
#include "fractal/orbit.glsl"

uniform float scale;      //! 2 [-3, 3] step 0.01 | Factor of every iteration; negative values turn it inside out
uniform float fold;       //! 1 [0.5, 2] step 0.01 | Where the box fold reflects
uniform float min_radius; //! 0.5 [0.05, 1] step 0.01 | Inside this radius the ball fold scales by a constant
uniform float fixed_radius; //! 1 [0.2, 2] step 0.01 | Inside this radius the ball fold inverts
uniform int iterations;   //! 14 [1, 40] | Most iterations of the map
uniform float bailout;    //! 200 [150, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = clamp(orbit.z, -fold, fold) * 2.0 - orbit.z;
    float r2 = dot(z, z);
    float fixed2 = fixed_radius * fixed_radius;
    float k = fixed2 / clamp(r2, min_radius * min_radius, fixed2);
    k = max(k, 1.0);
    orbit.z = scale * k * z + orbit.c;
    orbit.derivative = orbit.derivative * abs(scale) * k + orbit.dc;
}

float estimate(Orbit orbit) { return sqrt(orbit.r2) / orbit.derivative; }

// A corner stays bounded up to 2 (s + 1) / (s - 1) for positive scales and 2 for negative ones, times the fold (Chen 2010).
float bound() {
    float half_width = scale > 1.0 ? 2.0 * (scale + 1.0) / (scale - 1.0) : (scale < -1.0 ? 2.0 * (1.0 - scale) / (-scale - 1.0) : 60.0);
    return min(1.7320508 * fold * half_width, 120.0);
}
