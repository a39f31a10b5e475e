/// Limit sets of Kleinian groups in three dimensions: Maskit's groups with a second translation. The endless slab that they fill is seen
/// in an inversion, as a ball.
/// Jos Leys (2017), "A fast algorithm for limit sets of Kleinian groups with the Maskit parametrisation"; distance by Knighty (2016).
#include "fractal/orbit.glsl"

uniform float trace_real;      //! 1.89 [1.7, 2] step 0.0005 | Real part of the group's trace
uniform float trace_imaginary; //! 0.05 [-0.3, 0.3] step 0.0005 | Imaginary part of the group's trace
uniform vec2 box;              //! (1, 1) [0.3, 2] step 0.005 | Half the translations along x and z
uniform vec3 centre;           //! (0, 1, 1) [-2, 2] step 0.01 | Centre of the inversion
uniform float radius;          //! 1 [0.2, 3] step 0.01 | Radius of the inversion
uniform float extent;          //! 3 [0.5, 100] log | Radius of the ball that is cut out
uniform int iterations;        //! 40 [1, 100] | Most iterations of the map
uniform float bailout;         //! 1e9 [1e7, 1e12] log | Not used: nothing escapes

// The estimate follows the derivative at the point alone; inversions grow towards their centres. Measured: up to 1.11 times the distance
// for the default group, 1.5 for others.
const float step_factor = 0.65;

// The map needs no constant: `c` keeps the point itself for the cut, and `cw` its distance from the inversion's centre.
void start(inout Orbit orbit) {
    orbit.c = orbit.z;
    vec3 from = orbit.z - centre;
    float d2 = max(dot(from, from), 1e-12);
    orbit.cw = sqrt(d2);
    orbit.z = from * (radius * radius / d2) + centre;
}

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    float a = trace_real;
    float b = trace_imaginary;
    // Into the cell of the translations, which is sheared.
    float shear = b / a;
    z.x += shear * z.y;
    z.xz -= 2.0 * box * floor(0.5 * z.xz / box + 0.5);
    z.x -= shear * z.y;
    // Above the line that separates the two halves, half a turn about (-b, a) / 2.
    float side = z.x + 0.5 * b;
    float line = 0.5 * a + (b < 0.0 ? -1.0 : 1.0) * (2.0 * a - 1.95) / 4.0 * sign(side) * (1.0 - exp(-(7.2 - (1.95 - a) * 15.0) * abs(side)));
    if (z.y >= line) z = vec3(-b, a, 0.0) - z;
    // The inverse of the generator.
    float k = 1.0 / max(dot(z, z), 1e-12);
    orbit.z = vec3(-b + k * z.x, a - k * z.y, -k * z.z);
    orbit.derivative *= k;
}

float estimate(Orbit orbit) {
    float y = min(orbit.z.y, trace_real - orbit.z.y);
    float d = min(y, 0.3) / max(orbit.derivative, 2.0);
    // Back through the inversion.
    d = d * orbit.cw * orbit.cw / (radius * radius + orbit.cw * abs(d));
    return max(d, length(orbit.c) - extent);
}

float bound() { return 1.001 * extent; }
