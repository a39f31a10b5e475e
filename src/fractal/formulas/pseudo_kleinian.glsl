/// The pseudo-Kleinian: box folds and inversions without scaling, that end in a plane and an axis. It has no end in space.
/// Theli-at (2011, fractalforums.com); distance of the last plane and axis by Knighty (2011).
#include "fractal/orbit.glsl"

uniform vec3 cell;      //! (0.92, 0.91, 0.92) [0.5, 1.5] step 0.005 | Where the box fold reflects
uniform float size;     //! 1 [0.5, 1.5] step 0.005 | Squared radius of the inversion
uniform vec3 shift;     //! (0, 0, 0) [-1, 1] step 0.005 | Added at the end of every iteration
uniform vec3 offset;    //! (0, 0, 0) [-1, 1] step 0.005 | Where the last plane and axis are
uniform float thickness; //! 0.01 [0, 0.2] step 0.001 | Thickness of the last plane and axis
uniform float extent;   //! 12 [1, 100] log | Radius of the ball that is cut out
uniform int iterations; //! 8 [1, 30] | Iterations of the map
uniform float bailout;  //! 1e6 [1e4, 1e9] log | Not used: nothing escapes

// Inversions grow towards their centres. Measured: up to 1.21 times the distance near the default values.
const float step_factor = 0.8;

// The cut needs the point itself, which the map does not.
void start(inout Orbit orbit) { orbit.c = orbit.z; }

void iterate(inout Orbit orbit) {
    vec3 z = clamp(orbit.z, -cell, cell) * 2.0 - orbit.z;
    float k = max(size / max(dot(z, z), 1e-12), 1.0);
    orbit.z = k * z + shift;
    orbit.derivative *= k;
}

float estimate(Orbit orbit) {
    vec3 z = orbit.z - offset;
    float r2 = dot(z, z) + thickness;
    // The last surfaces are no guide to what the inversions draw near: beyond about a third of a cell they would overshoot.
    float last = 0.5 * (abs(length(z.xy) * z.z) - thickness) / sqrt(max(r2, 1e-20));
    float d = min(last, 0.3) / orbit.derivative;
    return max(d, length(orbit.c) - extent);
}

float bound() { return 1.001 * extent; }
