#include "fractal/fractal.glsl"

// What a fractal's surface is made of: its orbits decide the colour.

uniform int coloring;        //! trap {solid, trap, palette} invalidates program | What decides the colour: nothing; how near the orbit came to the origin and the planes, in three colours; or a palette along a measure of your choice
uniform vec3 color_a;        //! (0.85, 0.62, 0.36) [0, 1] color | Base colour
uniform vec3 color_b;        //! (0.25, 0.33, 0.45) [0, 1] color | Colour of orbits that stay away from the origin
uniform vec3 color_c;        //! (0.75, 0.2, 0.08) [0, 1] color | Colour of orbits that touch a coordinate plane
uniform float color_scale;   //! 1 [0.05, 20] log | How fast colours change with the trap
uniform int palette_by;      //! origin {origin, planes, axes, point, sphere, iterations, place} invalidates program | What runs along the palette: the orbit's distance from the origin, the coordinate planes, the axes, a point or a sphere around it, how long the orbit stayed, or the distance of the place itself from the point
uniform int palette_of;      //! nearest {nearest, mean} invalidates program | Which of the orbit's distances counts: the smallest, or their mean
uniform vec3 palette_point;  //! (0, 0, 0) [-10, 10] step 0.01 | The point, and the sphere's centre
uniform float palette_radius; //! 0.5 [0.001, 10] log | Radius of the sphere
uniform float palette_scale; //! 2 [0.01, 100] log | How often the palette is run through per unit of distance, or over all iterations
uniform float palette_offset; //! 0 [-1, 1] step 0.01 | Where in the palette the measure starts
uniform int palette_ends;    //! mirror {clamp, mirror, repeat} invalidates program | What follows the palette's end: its last colour, the way back, or its start
uniform float roughness;     //! 0.45 [0, 1] step 0.01 | Roughness of the surface: 0 a mirror, 1 chalk
uniform float metalness;     //! 0 [0, 1] step 0.01 | 0 a dielectric, 1 a metal
uniform float emission;      //! 0 [0, 100] log | Radiance that the surface emits, times its colour
uniform float roughness_along; //! 0 [-1, 1] step 0.01 | Roughness added towards the palette's end
uniform float metalness_along; //! 0 [-1, 1] step 0.01 | Metalness added towards the palette's end
uniform float emission_along;  //! 0 [0, 64] | Emission keeps to the palette's end: 0 everywhere, the larger the closer

vec3 palette_color(float t); // of the chosen palette

// What the orbit's present point adds to the measure.
float material_distance(Orbit orbit) {
    vec3 a = abs(orbit.z);
    if (palette_by == 1) return min(a.x, min(a.y, a.z));
    if (palette_by == 2) {
        float most = max(a.x, max(a.y, a.z));
        return sqrt(max(dot(a, a) - most * most, 0.0));
    }
    if (palette_by == 3) return length(orbit.z - palette_point);
    if (palette_by == 4) return abs(length(orbit.z - palette_point) - palette_radius);
    return sqrt(orbit.r2);
}

// The measure that runs along the palette. An orbit that stays one step longer must not jump in colour: the last step counts by
// how far it went beyond the bailout, on the logarithm of the radius, and counts fully when it just reached it.
float material_measure(vec3 position) {
    if (palette_by == 6) return palette_scale * length(position - palette_point);
    Orbit orbit = fractal_start(position);
    float before = orbit.r2;
    float last = 1.0; // part of the last step that counts
    vec2 measure = vec2(palette_of == 0 ? 1e10 : 0.0); // without the last step, and with it
    for (int i = 0; i < formula_iterations; ++i) {
        if (fractal_escaped(orbit)) break;
        before = orbit.r2;
        fractal_step(orbit);
        float d = material_distance(orbit);
        measure = vec2(measure.y, palette_of == 0 ? min(measure.y, d) : measure.y + d);
    }
    if (orbit.i == 0) return 0.0;
    if (fractal_escaped(orbit)) {
        vec3 radii = log(max(vec3(before, formula_bailout * formula_bailout, orbit.r2), 1e-30));
        last = clamp((radii.y - radii.x) / max(radii.z - radii.x, 1e-6), 0.0, 1.0);
    }
    float steps = float(orbit.i);
    if (palette_by == 5) return palette_scale * (steps - 1.0 + last) / float(formula_iterations);
    if (palette_of == 1) measure /= vec2(max(steps - 1.0, 1.0), steps);
    if (orbit.i == 1) measure.x = measure.y;
    return palette_scale * mix(measure.x, measure.y, last);
}

float material_wrapped(float x) {
    if (palette_ends == 0) return clamp(x, 0.0, 1.0);
    if (palette_ends == 1) return 1.0 - abs(1.0 - 2.0 * fract(0.5 * x));
    return fract(x);
}

// Three colours: near the origin or away from it, and where the orbit touched a coordinate plane.
vec3 material_trap(vec3 position) {
    Orbit orbit = fractal_start(position);
    vec2 trap = vec2(1e10);
    for (int i = 0; i < formula_iterations; ++i) {
        if (fractal_escaped(orbit)) break;
        fractal_step(orbit);
        vec3 planes = abs(orbit.z);
        trap = min(trap, vec2(orbit.r2, min(planes.x, min(planes.y, planes.z))));
    }
    float away = 1.0 - exp(-color_scale * trap.x);
    float near = exp(-4.0 * color_scale * trap.y);
    return mix(mix(color_a, color_b, away), color_c, near * near);
}

Material surface_material(Hit hit, vec3 normal) {
    vec3 position = subject_origin + hit.position;
    if (coloring == 0) return Material(color_a, roughness, metalness, emission * color_a);
    if (coloring == 1) {
        vec3 albedo = material_trap(position);
        return Material(albedo, roughness, metalness, emission * albedo);
    }
    float t = material_wrapped(palette_offset + material_measure(position));
    vec3 albedo = palette_color(t);
    return Material(albedo, clamp(roughness + roughness_along * t, 0.0, 1.0),
                    clamp(metalness + metalness_along * t, 0.0, 1.0),
                    emission * pow(max(t, 1e-10), emission_along) * albedo);
}
