/// Quaternion Julia sets: q -> q^2 + c, seen in the three-dimensional slice k = const.
/// Norton (1982); Hart, Sandin & Kauffman (1989), "Ray tracing deterministic 3-D fractals", with the distance 0.5 r ln(r) / |dr|.
#include "fractal/fourth.glsl"

uniform vec4 constant; //! (-0.2, 0.6, 0.2, 0.2) [-2, 2] step 0.01 | The constant c: real part, i, j, k
uniform int kind;      //! julia {julia, mandelbrot} invalidates program | One constant everywhere, or the point itself (the Mandelbrot set, turned about its axis)
uniform float slice;   //! 0 [-1.5, 1.5] step 0.01 | The fourth coordinate k of everything that is seen
uniform int iterations; //! 12 [1, 100] | Most iterations of the map
uniform float bailout; //! 4 [3, 100] log | Escape radius

void start(inout Orbit orbit) { fourth_start(orbit, kind == 0, constant, slice); }

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    float w = orbit.w;
    orbit.derivative = 2.0 * sqrt(orbit.r2) * orbit.derivative + orbit.dc;
    orbit.z = vec3(z.x * z.x - z.y * z.y - z.z * z.z - w * w, 2.0 * z.x * z.yz) + orbit.c;
    orbit.w = 2.0 * z.x * w + orbit.cw;
}

// |q| > (1 + sqrt(1 + 4 |c|)) / 2 escapes.
float bound() { return kind == 0 ? 0.5 + 0.5 * sqrt(1.0 + 4.0 * length(constant)) + 0.01 : 2.01; }

float estimate(Orbit orbit) {
    float r = sqrt(max(orbit.r2, 1e-30));
    // Far outside, r ln(r) would grow beyond the distance.
    if (orbit.i == 0) return r - bound();
    return max(0.5 * log(r) * r / max(orbit.derivative, 1e-30), 0.0);
}
