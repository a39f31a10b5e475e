// What the picture sees of the background's cube, as tile_fragment.glsl says it of tiles.

in vec2 face_place;

uniform sampler2D background_seen; // face_fragment.glsl
uniform int background_side;
uniform mat3 background_face;
uniform float background_kind; // 0: a face at the side, 1: the one below, -1: the one above
uniform vec3 background_way;   // of the camera since [world]
uniform float background_scale; // world units now per unit then

layout(location = 0) out vec4 seen_position;
layout(location = 1) out vec4 seen_slope;

void main() {
    float side = float(background_side);
    vec2 place = (vec2(face_place.x, -face_place.y) * 0.5 + 0.5) * side;
    ivec2 texel = clamp(ivec2(floor(place)), ivec2(0), ivec2(background_side - 1));
    vec4 seen = texelFetch(background_seen, texel, 0);
    if (seen.x == 0.0) {
        // Where near ground begins, it is half a pixel beside where it was. What is right above closes the seam; over
        // the skyline that is sky.
        vec2 rise = background_kind == 0.0 ? vec2(0.0, -1.5) : 1.5 * background_kind * normalize(place - 0.5 * side + 1e-3);
        texel = clamp(ivec2(floor(place + rise)), ivec2(0), ivec2(background_side - 1));
        seen = texelFetch(background_seen, texel, 0);
    }
    if (seen.x == 0.0) discard;
    vec2 middle = ((vec2(texel) + 0.5) / side * 2.0 - 1.0) * vec2(1.0, -1.0);
    vec3 p = background_face * normalize(vec3(middle, -1.0)) * seen.x;
    seen_position = vec4(p * background_scale - background_way, 1.0);
    seen_slope = vec4(seen.yz, seen.w, 0.0);
}
