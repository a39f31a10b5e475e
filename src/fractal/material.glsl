#include "fractal/fractal.glsl"

// What a fractal's surface is made of: its orbits decide the colour.

uniform int coloring;        //! trap {solid, trap, iterations} invalidates program | What decides the colour: nothing, how near the orbit came to the origin and the planes, or how long it stayed
uniform vec3 color_a;        //! (0.85, 0.62, 0.36) [0, 1] color | Base colour
uniform vec3 color_b;        //! (0.25, 0.33, 0.45) [0, 1] color | Colour of orbits that stay away from the origin
uniform vec3 color_c;        //! (0.75, 0.2, 0.08) [0, 1] color | Colour of orbits that touch a coordinate plane
uniform float color_scale;   //! 1 [0.05, 20] log | How fast colours change with the trap
uniform float roughness;     //! 0.45 [0, 1] step 0.01 | Roughness of the surface: 0 a mirror, 1 chalk
uniform float metalness;     //! 0 [0, 1] step 0.01 | 0 a dielectric, 1 a metal
uniform float emission;      //! 0 [0, 100] log | Radiance that the surface emits, times its colour

Material surface_material(Hit hit, vec3 normal) {
    vec3 albedo = color_a;
    if (coloring != 0) {
        Orbit orbit = fractal_start(subject_origin + hit.position);
        vec2 trap = vec2(1e10);
        for (int i = 0; i < formula_iterations; ++i) {
            if (fractal_escaped(orbit)) break;
            fractal_step(orbit);
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
