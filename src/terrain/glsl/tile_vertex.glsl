#include "terrain/glsl/tile_projection.glsl"

// A vertex of a tile: the operations of terrain::morphed(), so that borders of tiles agree in every bit.

in ivec2 grid;        // of the mesh
in ivec4 tile_place;  // first vertex from the origin [vertices]; first texel in the cache
in ivec4 tile_height; // height of the origin [units of the level]; level from the place's; 0; 0
in vec4 tile_scale;   // spacing [world], unit of height [world], morph's scale and offset

uniform isampler2D tile_heights;
uniform int tile_stride;      // vertices of the lattice per one of the mesh
uniform vec3 tile_camera;     // from the origin [world]
uniform float tile_clearance; // [world]
uniform vec3 tile_moved;     // the camera since the tiles were chosen [world]

out vec3 vertex_position; // from the camera [world]
out vec2 vertex_lattice;  // within the tile [vertices]
out float vertex_morph;
flat out vec4 vertex_tile; // first texel, factor of slopes, spacing
flat out float vertex_level;

void main() {
    ivec2 odd = grid & 1;
    ivec2 lattice = grid * tile_stride;
    vec2 at = vec2(tile_place.xy + lattice);
    float spacing = tile_scale.x;
    float away = max(max(abs(at.x * spacing - tile_camera.x), abs(at.y * spacing - tile_camera.y)), tile_clearance);
    float m = clamp(away * tile_scale.z - tile_scale.w, 0.0, 1.0);
    int fine = texelFetch(tile_heights, tile_place.zw + lattice, 0).x;
    // The vertex that it slides to: of the mesh of twice the spacing.
    int coarse = texelFetch(tile_heights, tile_place.zw + lattice - odd * tile_stride, 0).y;
    vec3 p;
    p.xy = (at - m * vec2(odd * tile_stride)) * spacing;
    p.z = (1.0 - m) * (float(fine - tile_height.x) * tile_scale.y) + m * (float(coarse - tile_height.x) * tile_scale.y);
    p -= tile_camera;
    p -= tile_moved;
    vertex_position = p;
    vertex_lattice = vec2(lattice) - m * vec2(odd * tile_stride);
    vertex_morph = m;
    vertex_tile = vec4(vec2(tile_place.zw), 4096.0 * tile_scale.y / spacing, spacing);
    vertex_level = float(tile_height.y);
    gl_Position = tile_project(p);
}
