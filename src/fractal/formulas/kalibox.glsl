/// The Kalibox: absolute values and a shift instead of the Mandelbox's box fold, then a clamped inversion and a scaling.
/// Kali (2010, fractalforums.com); distance (r - |s - 1|) / |dr| - |s|^(1 - n) as for Lowe's Mandelbox.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;      //! 2.04 [1.3, 3] step 0.01 | Factor of every iteration
uniform float min_radius; //! 0.59 [0.2, 1] step 0.01 | Inside this radius the ball fold scales by a constant
uniform vec3 shift;       //! (0.04, -1.86, 0.04) [-3, 3] step 0.01 | Added after the absolute values
uniform vec3 rotation;    //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation of every iteration, about x, y and z in turn
uniform vec3 constant;    //! (-0.67, -1.3, -0.46) [-2, 2] step 0.01 | Added at the end of every iteration
uniform float point;      //! 0 [0, 1] step 0.01 | How much of the point itself is added instead: 1 makes a set of Mandelbrot's kind
uniform int iterations;   //! 16 [1, 40] | Most iterations of the map
uniform float bailout;    //! 100 [10, 10000] log | Escape radius

// What has escaped is measured from the origin instead of from the set. Measured: up to 1.03 times the distance.
const float step_factor = 0.95;

void iterate(inout Orbit orbit) {
    vec3 z = abs(orbit.z) + shift;
    float min2 = min_radius * min_radius;
    float k = scale / min2 * clamp(max(min2 / max(dot(z, z), 1e-20), min2), 0.0, 1.0);
    z *= k;
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    orbit.z = z + mix(constant, orbit.c, point);
    orbit.derivative = orbit.derivative * k + point * orbit.dc;
}

float estimate(Orbit orbit) { return sqrt(orbit.r2) / orbit.derivative; }

// Beyond this radius every step outweighs the shift and the constant.
float bound() {
    float own = scale - 1.0 - point;
    float radius = own > 0.05 ? (scale * length(shift) + (1.0 - point) * length(constant)) / own : 40.0;
    return min(max(radius, length(shift) + 1.0), 40.0);
}
