// The ground's slope at a fragment of a tile, with all octaves of the tile.

in vec3 vertex_position;
in vec2 vertex_lattice;
in float vertex_morph;
flat in vec4 vertex_tile;
flat in float vertex_level;

uniform sampler2D tile_slopes;
uniform int tile_cells;

// In the world, along x and y.
vec2 tile_slope() {
    // Interpolated here and not by the sampler: the same bits wherever in the cache the tile lies.
    ivec2 first = ivec2(clamp(vertex_lattice, vec2(0.0), vec2(float(tile_cells) - 0.001)));
    vec2 within = vertex_lattice - vec2(first);
    ivec2 at = ivec2(vertex_tile.xy) + first;
    vec4 s = mix(mix(texelFetch(tile_slopes, at, 0), texelFetch(tile_slopes, at + ivec2(1, 0), 0), within.x),
                 mix(texelFetch(tile_slopes, at + ivec2(0, 1), 0), texelFetch(tile_slopes, at + ivec2(1, 1), 0), within.x), within.y);
    return mix(s.xy, s.zw, vertex_morph) * vertex_tile.z;
}
