#include "render/glsl/surface.glsl"

// Planes through a volume that show its values as they are, without light. A part of the interfaces `field` and `medium`: renderers put them
// at their depth, so that what is in front hides them and they hide what is behind.

struct Slice {
    float t;    // along the ray [world units]; 1e30: there is none
    vec4 color; // radiance, and how much of what is behind it hides
};

// The nearest slice that the ray meets beyond t. The ray is one that field_clip() or medium_enter() has cut.
Slice slice_next(Ray ray, float t);

// Before all that a ray meets.
float slice_start(Ray ray) { return -1e30; }
