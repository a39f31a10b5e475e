#include "fractal/orbit.glsl"
#include "render/glsl/distance_surface.glsl"

// A formula as a surface: the loop around its map, orbit traps and colours.

uniform vec3 subject_origin; // the camera's position in the fractal's own space

uniform bool julia;          //! false invalidates program | Use one constant everywhere (a Julia set) instead of the point itself
uniform vec3 julia_c;        //! (0.3, 0.5, -0.2) [-2, 2] step 0.01 | The constant of a Julia set
uniform int coloring;        //! trap {solid, trap, iterations} invalidates program | What decides the colour: nothing, how near the orbit came to the origin and the planes, or how long it stayed
uniform vec3 color_a;        //! (0.85, 0.62, 0.36) [0, 1] color | Base colour
uniform vec3 color_b;        //! (0.25, 0.33, 0.45) [0, 1] color | Colour of orbits that stay away from the origin
uniform vec3 color_c;        //! (0.75, 0.2, 0.08) [0, 1] color | Colour of orbits that touch a coordinate plane
uniform float color_scale;   //! 1 [0.05, 20] log | How fast colours change with the trap
uniform float roughness;     //! 0.45 [0, 1] step 0.01 | Roughness of the surface: 0 a mirror, 1 chalk
uniform float metalness;     //! 0 [0, 1] step 0.01 | 0 a dielectric, 1 a metal
uniform float emission;      //! 0 [0, 100] log | Radiance that the surface emits, times its colour

Orbit fractal_start(vec3 p) {
    return Orbit(p, julia ? julia_c : p, 1.0, julia ? 0.0 : 1.0, dot(p, p), 0);
}

float fractal_distance(vec3 p) {
    Orbit orbit = fractal_start(p);
    for (int i = 0; i < formula_iterations; ++i) {
        if (orbit.r2 > formula_bailout * formula_bailout) break;
        formula_iterate(orbit);
        orbit.r2 = dot(orbit.z, orbit.z);
        orbit.i = i + 1;
    }
    return formula_estimate(orbit) * formula_step_factor;
}

float distance_estimate(vec3 p) { return fractal_distance(subject_origin + p); }

vec4 distance_bound() { return vec4(-subject_origin, formula_bound()); }

Material surface_material(Hit hit, vec3 normal) {
    vec3 albedo = color_a;
    if (coloring != 0) {
        Orbit orbit = fractal_start(subject_origin + hit.position);
        vec2 trap = vec2(1e10);
        for (int i = 0; i < formula_iterations; ++i) {
            if (orbit.r2 > formula_bailout * formula_bailout) break;
            formula_iterate(orbit);
            orbit.r2 = dot(orbit.z, orbit.z);
            orbit.i = i + 1;
            vec3 planes = abs(orbit.z);
            trap = min(trap, vec2(orbit.r2, min(planes.x, min(planes.y, planes.z))));
        }
        if (coloring == 1) {
            float away = 1.0 - exp(-color_scale * trap.x);
            float near = exp(-4.0 * color_scale * trap.y);
            albedo = mix(mix(color_a, color_b, away), color_c, near * near);
        } else {
            float t = 0.5 - 0.5 * cos(color_scale * float(orbit.i));
            albedo = mix(color_a, color_b, t);
        }
    }
    return Material(albedo, roughness, metalness, emission * albedo);
}
