#include "render/glsl/surface.glsl"
#include "render/glsl/slice.glsl"

// The `field` interface: a scalar in space that renderers sample along rays, and what it looks like. Positions and lengths are in
// world units, relative to the camera.

// Cuts the ray to where the field is; false when it misses.
bool field_clip(inout Ray ray);

// A sphere around everything: centre, radius.
vec4 field_bounds();

// Side of the finest detail [world units]: what steps are measured in.
float field_spacing();

// Whether there may be something to be seen from t on up to `t_end`.
bool field_segment(Ray ray, float t, out float t_end);

// The lowest and the highest value that there may be from t on up to `t_end`.
vec2 field_range(Ray ray, float t, out float t_end);

// The field where it is strongest of all channels, 0..1 over the range that is shown.
float field_value(vec3 position);

// What a value looks like by itself: linear colour.
vec3 field_tint(float value);

// Linear colour, and extinction [1/world unit].
vec4 field_color(vec3 position);

// Points from low values to high ones [1/world unit].
vec3 field_gradient(vec3 position);

// Light that the field gives off by itself, where it has that colour: radiance of a thick layer.
vec3 field_emission(vec3 position, vec4 color);
