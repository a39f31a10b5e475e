#include "terrain/glsl/tile_projection.glsl"

// A corner of a face of the background's cube, infinitely far away: behind everything.

in ivec2 corner; // -1 or 1

uniform mat3 background_face; // right, up and backward of the face in the world

out vec2 face_place; // on the face, -1 to 1, y up

void main() {
    vec3 v = background_face * vec3(vec2(corner), -1.0) * tile_basis;
    float d = -v.z;
    vec2 film = v.xy + tile_lens.xy * (d * tile_lens.z);
    face_place = vec2(corner);
    // The depth is farther than that of any tile, but nearer than nothing.
    gl_Position = vec4(film * tile_film * vec2(1.0, -1.0) - tile_shift * d, tile_depth.x == 0.0 ? 1e-30 * d : 0.0, d);
}
