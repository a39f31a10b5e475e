#include "terrain/glsl/tile_slope.glsl"

// What the picture knows of the ground at a pixel: where it is, and its slope.

uniform int tile_lines; // 1: mark the tile's border, 2: and the mesh's lines
uniform int tile_mesh;  // vertices of the lattice per one of the mesh

layout(location = 0) out vec4 seen_position; // from the camera [world]; w spacing
layout(location = 1) out vec4 seen_slope;    // world slopes along x and y; level; 1: on a line, 2: of a box, 3: a corner's mark

void main() {
    float line = 0.0;
    if (tile_lines > 0) {
        vec2 width = fwidth(vertex_lattice);
        vec2 border = min(vertex_lattice, float(tile_cells) - vertex_lattice);
        if (any(lessThan(border, 1.2 * width))) line = 1.0;
        vec2 mesh = abs(fract(vertex_lattice / float(tile_mesh) + 0.5) - 0.5) * float(tile_mesh);
        if (tile_lines > 1 && any(lessThan(mesh, 0.6 * width))) line = 1.0;
    }
    seen_position = vec4(vertex_position, vertex_tile.w);
    seen_slope = vec4(tile_slope(), vertex_level, line);
}
