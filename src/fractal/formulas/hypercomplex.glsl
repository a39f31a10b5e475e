/// Hypercomplex Julia and Mandelbrot sets: z -> z^2 + c on Davenport's commutative four-dimensional numbers.
/// Davenport (1996), "Commutative hypercomplex mathematics"; the derivative's norm by its split into two complex numbers (Rochon 2000).
#include "fractal/fourth.glsl"

uniform vec4 constant; //! (-0.5, 0.5, 0.15, 0.2) [-2, 2] step 0.01 | The constant c of Julia sets
uniform int kind;      //! julia {julia, mandelbrot} invalidates program | One constant everywhere, or the point itself
uniform float slice;   //! 0 [-1.5, 1.5] step 0.01 | The fourth coordinate of everything that is seen
uniform int iterations; //! 14 [1, 100] | Most iterations of the map
uniform float bailout; //! 4 [3, 100] log | Escape radius

void start(inout Orbit orbit) { fourth_start(orbit, kind == 0, constant, slice); }

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    float w = orbit.w;
    // z is the complex numbers a and b at once: multiplying by it stretches by no more than the longer of them.
    vec2 a = vec2(z.x - w, z.y + z.z);
    vec2 b = vec2(z.x + w, z.y - z.z);
    orbit.derivative = 2.0 * sqrt(max(dot(a, a), dot(b, b))) * orbit.derivative + orbit.dc;
    orbit.z = vec3(z.x * z.x - z.y * z.y - z.z * z.z + w * w, 2.0 * (z.x * z.y - z.z * w), 2.0 * (z.x * z.z - z.y * w)) + orbit.c;
    orbit.w = 2.0 * (z.x * w + z.y * z.z) + orbit.cw;
}

// Both complex numbers must stay within (1 + sqrt(1 + 4 |c|)) / 2, and |z| is no longer than the longer one.
float bound() { return kind == 0 ? 0.5 + 0.5 * sqrt(1.0 + 5.7 * length(constant)) + 0.01 : 2.01; }

float estimate(Orbit orbit) {
    float r = sqrt(max(orbit.r2, 1e-30));
    // Far outside, r ln(r) would grow beyond the distance.
    if (orbit.i == 0) return r - bound();
    return max(0.5 * log(r) * r / max(orbit.derivative, 1e-30), 0.0);
}
