// What the picture knows of the ground at a pixel: where it is, and its slope with all octaves of the tile.

in vec3 vertex_position;
in vec2 vertex_lattice;
in float vertex_morph;
flat in vec4 vertex_tile;
flat in float vertex_level;

uniform sampler2D tile_slopes;
uniform int tile_cells;
uniform int tile_lines; // 1: mark the tile's border, 2: and the mesh's lines
uniform int tile_mesh;  // vertices of the lattice per one of the mesh

layout(location = 0) out vec4 seen_position; // from the camera [world]; w spacing
layout(location = 1) out vec4 seen_slope;    // world slopes along x and y; level; 1: on a line, 2: of a box, 3: a corner's mark

void main() {
    // Interpolated here and not by the sampler: the same bits wherever in the cache the tile lies.
    ivec2 first = ivec2(clamp(vertex_lattice, vec2(0.0), vec2(float(tile_cells) - 0.001)));
    vec2 within = vertex_lattice - vec2(first);
    ivec2 at = ivec2(vertex_tile.xy) + first;
    vec4 s = mix(mix(texelFetch(tile_slopes, at, 0), texelFetch(tile_slopes, at + ivec2(1, 0), 0), within.x),
                 mix(texelFetch(tile_slopes, at + ivec2(0, 1), 0), texelFetch(tile_slopes, at + ivec2(1, 1), 0), within.x), within.y);
    vec2 slope = mix(s.xy, s.zw, vertex_morph) * vertex_tile.z;
    float line = 0.0;
    if (tile_lines > 0) {
        vec2 width = fwidth(vertex_lattice);
        vec2 border = min(vertex_lattice, float(tile_cells) - vertex_lattice);
        if (any(lessThan(border, 1.2 * width))) line = 1.0;
        vec2 mesh = abs(fract(vertex_lattice / float(tile_mesh) + 0.5) - 0.5) * float(tile_mesh);
        if (tile_lines > 1 && any(lessThan(mesh, 0.6 * width))) line = 1.0;
    }
    seen_position = vec4(vertex_position, vertex_tile.w);
    seen_slope = vec4(slope, vertex_level, line);
}
