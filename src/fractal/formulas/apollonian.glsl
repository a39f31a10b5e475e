/// The Apollonian packing: space is wrapped into a cube and inverted, again and again; what is left are spheres that touch. It has no end in space.
/// Quilez (2013), "Apollonian", after Apollonius' and Soddy's circles; distance to the last plane, scaled back.
#include "fractal/orbit.glsl"

uniform float size;     //! 1.1 [0.9, 1.6] step 0.005 | Squared radius of the inversion
uniform float thickness; //! 0 [0, 0.2] step 0.001 | Thickness of the shells
uniform float extent;   //! 3 [0.5, 100] log | Radius of the ball that is cut out
uniform int iterations; //! 8 [1, 30] | Iterations of the map
uniform float bailout;  //! 1e9 [1e7, 1e12] log | Not used: nothing escapes

// The cut needs the point itself, which the map does not.
void start(inout Orbit orbit) { orbit.c = orbit.z; }

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z - 2.0 * floor(0.5 * orbit.z + 0.5);
    float k = size / max(dot(z, z), 1e-6);
    orbit.z = k * z;
    orbit.derivative *= k;
}

float estimate(Orbit orbit) {
    return max((0.25 * abs(orbit.z.y) - thickness) / orbit.derivative, length(orbit.c) - extent);
}

float bound() { return 1.001 * extent; }
