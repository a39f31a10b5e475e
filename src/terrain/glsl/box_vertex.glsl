#include "terrain/glsl/tile_projection.glsl"

// A corner of a box that is drawn over the tiles: bounds, or what the processor knows of a tile's corner.

in ivec3 corner;    // 0 or 1 along each axis
in vec4 box_least;  // from the camera [world]; level
in vec4 box_most;   // from the camera [world]; what it shows, as seen_slope.w

out vec3 vertex_position;
flat out vec2 vertex_kind;

void main() {
    vertex_position = mix(box_least.xyz, box_most.xyz, vec3(corner));
    vertex_kind = vec2(box_least.w, box_most.w);
    gl_Position = tile_project(vertex_position);
}
