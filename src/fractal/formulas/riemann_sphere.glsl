/// The Riemann sphere: directions are projected onto the complex plane, which is cut into cells; the radius becomes the height over them.
/// msltoe (2014, fractalforums.com), "Revisiting the Riemann sphere"; distance r / |dr| with the norm of the exact derivative.
#include "fractal/orbit.glsl"

uniform float radius;   //! 1.5 [0.5, 3] step 0.01 | The radius that is height 0
uniform float zoom;     //! 1 [0.3, 3] step 0.01 | Factor of the projection: more cells cover the sphere
uniform float stretch;  //! 4 [1, 8] step 0.01 | Size of the next sphere's cells
uniform vec3 shift;     //! (0, 0, 0) [-2, 2] step 0.01 | Added at the end of every iteration
uniform int iterations; //! 8 [1, 30] | Most iterations of the map
uniform float bailout;  //! 100 [50, 10000] log | Escape radius

// Measured: up to 1.27 times the distance near the default values, as the projection's scale changes from place to place.
const float step_factor = 0.8;

void iterate(inout Orbit orbit) {
    float r = max(sqrt(orbit.r2), 1e-6);
    vec3 n = orbit.z / r;
    // From the pole; its neighbourhood goes to infinity.
    vec2 s = zoom * n.xy / max(1.0 - n.z, 1e-4);
    float rho2 = dot(s, s);
    float height = (r - radius) * (1.0 + rho2);
    // What stays is no higher than about 1 + radius: the distance to that shell before this step. Near the pole, where everything is
    // drawn out, the derivative alone would tell needlessly little.
    orbit.cw = (abs(r - radius) - (1.0 + radius) / (1.0 + rho2)) / orbit.derivative;
    // The derivative is a shear: along the sphere, along the plane into the height, and upwards.
    float along = stretch * 0.5 * (zoom + rho2 / zoom) / r;
    float into = (r - radius) * sqrt(rho2) * (zoom + rho2 / zoom) / r;
    float up = 1.0 + rho2;
    float sum = along * along + into * into + up * up;
    float norm = sqrt(0.5 * (sum + sqrt(max(sum * sum - 4.0 * along * along * up * up, 0.0))));
    orbit.derivative = min(orbit.derivative * norm, 1e30);
    orbit.z = vec3(stretch * (s - floor(s + 0.5)), height) + shift;
}

float estimate(Orbit orbit) { return max(orbit.cw, min(sqrt(orbit.r2), 6.0) / orbit.derivative); }

float bound() { return 2.0 * radius + 3.0; }
