#include "render/glsl/surface.glsl"
#include "render/glsl/slice.glsl"

// The `medium` interface: what a renderer asks of a subject that light passes through. Media have coordinates of their own, in which
// rays are straight and t is still a length in world units.

struct MediumRay {
    vec3 origin;    // in the medium's coordinates
    vec3 direction; // of them, per world unit
    vec3 inverse;   // 1 / direction, per component
};

struct Medium {
    float extinction; // [1/world unit]
    vec3 albedo;      // part of the extinction that is scattering
    vec3 emission;    // radiance that a thick layer gives off by itself
    vec3 normal;      // outwards from the densest side: unit, world space; 0 where there is none
    float surface;    // part of the scattering that a surface of that normal does, 0..1; the phase function does the rest
};

// Cuts the ray to where the medium is, and gives it in the medium's coordinates; false when it misses.
bool medium_enter(inout Ray ray, out MediumRay path);

// From t on to `t_end`, no extinction is more than `majorant` [1/world unit]; 0: there is nothing at all.
void medium_segment(MediumRay path, float t, out float t_end, out float majorant);

// What there is at a place, in the medium's coordinates: albedo, and extinction [1/world unit].
vec4 medium_look(vec3 place);

// All of it, for what medium_look() gave there.
Medium medium_at(vec3 place, vec4 look);

// Mean cosine of the angle by which light is scattered (Henyey & Greenstein 1941), -1..1.
float medium_anisotropy();
