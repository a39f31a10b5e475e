// Heights around the camera, for rays: nested squares of 256 x 256 points (terrain/clipmap.hpp).

uniform sampler2D terrain_clip;
uniform int terrain_clip_count;
uniform vec4 terrain_clip_place[12]; // first point from the camera [world], height of the reference from the camera, 1 / spacing
uniform float terrain_clip_unit[12]; // one unit of height [world]

// The finest square that surely has the point, and whose spacing is at least `size`.
int terrain_clip_level(vec2 p, float size) {
    float spacings = max(max(abs(p.x), abs(p.y)) / 110.0, size) * terrain_clip_place[0].w;
    return clamp(int(ceil(log2(max(spacings, 1.0)))), 0, terrain_clip_count - 1);
}

float terrain_clip_spacing(int k) { return 1.0 / terrain_clip_place[k].w; }

// Whether the point is beyond the last square.
bool terrain_clip_beyond(vec2 p) {
    return max(abs(p.x), abs(p.y)) * terrain_clip_place[terrain_clip_count - 1].w > 110.0;
}

// Height of the ground at a point, from the camera [world].
float terrain_ground(vec2 p, int k) {
    vec4 place = terrain_clip_place[k];
    vec2 u = clamp((p - place.xy) * place.w, vec2(0.0), vec2(254.999));
    ivec2 i = ivec2(u);
    vec2 f = u - vec2(i);
    vec4 h = texelFetch(terrain_clip, i + 256 * ivec2(k & 3, k >> 2), 0);
    return place.z + terrain_clip_unit[k] * mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
}
