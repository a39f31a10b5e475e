/// The Mandelbulb: z -> z^n + c on triplex numbers in polar form.
/// White & Nylander (2009); distance estimate 0.5 r ln(r) / |dr| after Hubbard & Douady, by Quilez (2009).
/// Integer powers are computed as products of complex numbers, without trigonometry.
#include "fractal/orbit.glsl"

uniform float power;     //! 8 [2, 16] step 0.1 | Exponent n of the triplex power
uniform int iterations;  //! 10 [1, 60] | Most iterations of the map
uniform float bailout;   //! 2 [1.2, 10] log | Escape radius
uniform float theta;     //! 0 [-180, 180] unit deg | Phase added to the polar angle
uniform float phi;       //! 0 [-180, 180] unit deg | Phase added to the azimuth
uniform int polar;       //! zenith {zenith, elevation} invalidates program | Where the polar angle is measured from: the axis (White & Nylander) or the equator (Mandelbulber)

vec2 square(vec2 a) { return vec2(a.x * a.x - a.y * a.y, 2.0 * a.x * a.y); }
vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

vec2 integer_power(vec2 a, int n) {
    vec2 a2 = square(a);
    if (n == 2) return a2;
    if (n == 3) return times(a2, a);
    vec2 a4 = square(a2);
    if (n == 4) return a4;
    if (n == 5) return times(a4, a);
    if (n == 6) return times(a4, a2);
    if (n == 7) return times(a4, times(a2, a));
    vec2 a8 = square(a4);
    if (n == 8) return a8;
    if (n == 9) return times(a8, a);
    if (n == 10) return times(a8, a2);
    if (n == 11) return times(a8, times(a2, a));
    if (n == 12) return times(a8, a4);
    if (n == 13) return times(a8, times(a4, a));
    if (n == 14) return times(a8, times(a4, a2));
    if (n == 15) return times(a8, times(a4, times(a2, a)));
    return square(a8);
}

// A phase is a turn of the complex number.
vec2 turned(vec2 a, float degrees) {
    return degrees == 0.0 ? a : times(a, vec2(cos(radians(degrees)), sin(radians(degrees))));
}

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    float rho2 = dot(z.xy, z.xy);
    float rho = sqrt(rho2);
    // On the axis the azimuth is 0 by definition.
    vec2 around = rho2 > 1e-30 ? z.xy / rho : vec2(1.0, 0.0);
    vec2 tilt = polar == 0 ? vec2(z.z, rho) : vec2(rho, z.z); // r (cos, sin) of the polar angle
    float r = sqrt(orbit.r2);
    if (power == floor(power)) {
        int n = int(power);
        around = turned(integer_power(around, n), phi);
        tilt = turned(integer_power(tilt, n), theta);
        float rn1 = n == 8 ? orbit.r2 * orbit.r2 * orbit.r2 * r : pow(r, power - 1.0);
        orbit.derivative = power * rn1 * orbit.derivative + orbit.dc;
    } else {
        float rn = pow(max(r, 1e-15), power);
        float a = power * atan(tilt.y, tilt.x) + radians(theta);
        float b = power * atan(around.y, around.x) + radians(phi);
        tilt = rn * vec2(cos(a), sin(a));
        around = vec2(cos(b), sin(b));
        orbit.derivative = power * (rn / max(r, 1e-15)) * orbit.derivative + orbit.dc;
    }
    orbit.z = (polar == 0 ? vec3(tilt.y * around, tilt.x) : vec3(tilt.x * around, tilt.y)) + orbit.c;
}

float estimate(Orbit orbit) {
    float r = sqrt(max(orbit.r2, 1e-30));
    return max(0.5 * log(r) * r / orbit.derivative, 0.0);
}

float bound() { return power < 3.0 ? 1.6 : 1.25; }
