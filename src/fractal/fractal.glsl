#include "fractal/orbit.glsl"
#include "render/glsl/distance_surface.glsl"

// A sequence of maps as a surface: the loop around their steps. What the surface is made of is in material.glsl.
//
//     void fractal_iterate(inout Orbit orbit)   the step whose turn it is, with what its slot does before
//     int fractal_cycle()                       steps until the first slot's turn comes again
//     float fractal_bound()                     radius of a sphere around the origin that holds everything
//     float fractal_distance(vec3 p)            the distance to the surface
//
// are put together by fractal.cpp.

uniform vec3 subject_origin; // the camera's position in the fractal's own space

uniform bool julia;          //! false invalidates program | Use one constant everywhere (a Julia set) instead of the point itself
uniform vec3 julia_c;        //! (0.3, 0.5, -0.2) [-2, 2] step 0.01 | The constant of a Julia set
uniform int distance;        //! auto {auto, log, linear} invalidates program | How the distance follows from the last orbit: as the (first) formula says; r ln(r) / 2 |dr|, for maps that grow as powers; r / |dr|, for maps that grow by factors

uniform int derivative;      //! auto {auto, dual, differences} invalidates program | Where the distance has its derivative from: the formula, or dual numbers where it gives only its map; dual numbers (exact, of any formula and hybrid, slower); finite differences

void fractal_iterate(inout Orbit orbit);
int fractal_cycle();
float fractal_bound();
float fractal_distance(vec3 p);

Orbit fractal_start(vec3 p) {
    Orbit orbit = Orbit(p, 0.0, julia ? julia_c : p, 0.0, 1.0, julia ? 0.0 : 1.0, 0.0, 0);
    formula_start(orbit);
    orbit.r2 = dot(orbit.z, orbit.z) + orbit.w * orbit.w;
    return orbit;
}

bool fractal_escaped(Orbit orbit) { return orbit.r2 > formula_bailout * formula_bailout; }

void fractal_step(inout Orbit orbit) {
    fractal_iterate(orbit);
    orbit.r2 = dot(orbit.z, orbit.z) + orbit.w * orbit.w;
    ++orbit.i;
}

Orbit fractal_orbit(vec3 p) {
    Orbit orbit = fractal_start(p);
    for (int i = 0; i < formula_iterations; ++i) {
        if (fractal_escaped(orbit)) break;
        fractal_step(orbit);
    }
    return orbit;
}

// Hubbard & Douady's potential (1982) bounds the distance by 0.5 r ln(r) / |dr|; Hart, Sandin & Kauffman (1989).
float fractal_logarithmic(Orbit orbit) {
    float r = sqrt(max(orbit.r2, 1e-30));
    return max(0.5 * r * log(r) / orbit.derivative, 0.0);
}

float fractal_linear(Orbit orbit) { return sqrt(orbit.r2) / orbit.derivative; }

float fractal_estimate(Orbit orbit) {
    if (distance == 1) return fractal_logarithmic(orbit);
    if (distance == 2) return fractal_linear(orbit);
    return formula_estimate(orbit) * formula_step_factor;
}

float distance_estimate(vec3 p) { return fractal_distance(subject_origin + p); }

vec4 distance_bound() { return vec4(-subject_origin, fractal_bound()); }
