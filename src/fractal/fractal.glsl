#include "fractal/orbit.glsl"
#include "render/glsl/distance_surface.glsl"

// A formula as a surface: the loop around its map. What the surface is made of is in material.glsl.

uniform vec3 subject_origin; // the camera's position in the fractal's own space

uniform bool julia;          //! false invalidates program | Use one constant everywhere (a Julia set) instead of the point itself
uniform vec3 julia_c;        //! (0.3, 0.5, -0.2) [-2, 2] step 0.01 | The constant of a Julia set

Orbit fractal_start(vec3 p) {
    Orbit orbit = Orbit(p, 0.0, julia ? julia_c : p, 0.0, 1.0, julia ? 0.0 : 1.0, 0.0, 0);
    formula_start(orbit);
    orbit.r2 = dot(orbit.z, orbit.z) + orbit.w * orbit.w;
    return orbit;
}

bool fractal_escaped(Orbit orbit) { return orbit.r2 > formula_bailout * formula_bailout; }

void fractal_step(inout Orbit orbit) {
    formula_iterate(orbit);
    orbit.r2 = dot(orbit.z, orbit.z) + orbit.w * orbit.w;
    ++orbit.i;
}

float fractal_distance(vec3 p) {
    Orbit orbit = fractal_start(p);
    for (int i = 0; i < formula_iterations; ++i) {
        if (fractal_escaped(orbit)) break;
        fractal_step(orbit);
    }
    return formula_estimate(orbit) * formula_step_factor;
}

float distance_estimate(vec3 p) { return fractal_distance(subject_origin + p); }

vec4 distance_bound() { return vec4(-subject_origin, formula_bound()); }
