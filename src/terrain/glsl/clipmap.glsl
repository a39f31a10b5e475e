// Heights around the camera, for rays: nested squares of 256 x 256 points (terrain/clipmap.hpp, which also says how many:
// terrain_clip_most).

uniform sampler2D terrain_clip;
uniform int terrain_clip_count;
uniform vec4 terrain_clip_place[terrain_clip_most]; // first point from the camera [world], height of the reference from the camera, 1 / spacing
uniform float terrain_clip_unit[terrain_clip_most]; // one unit of height [world]
uniform int terrain_clip_slot;       // where the first square lies in the texture; the next ones are in the slots before
uniform float terrain_clip_finest;   // spacing that the finest detail is for: no less than that of the first square [world]

// The square, by its number but between the numbers, that has the point and whose spacing is `size`, or greater where
// only greater ones have it. Continuous, also while the camera moves.
float terrain_clip_scale(vec2 p, float size) {
    float spacing = max(max(abs(p.x), abs(p.y)) / 110.0, max(size, terrain_clip_finest));
    return clamp(log2(spacing * terrain_clip_place[0].w), 0.0, float(terrain_clip_count - 1));
}

// The finest square that surely has the point, and whose spacing is at least `size`.
int terrain_clip_level(vec2 p, float size) { return int(ceil(terrain_clip_scale(p, size))); }

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
    int slot = terrain_clip_slot - k;
    slot += slot < 0 ? terrain_clip_most : 0;
    vec4 h = texelFetch(terrain_clip, i + 256 * ivec2(slot & 3, slot >> 2), 0);
    return place.z + terrain_clip_unit[k] * mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
}

// The same between squares: as one that follows `scale` without a step, of the next two coarser ones.
float terrain_ground_at(vec2 p, float scale) {
    int k = min(int(ceil(scale)), terrain_clip_count - 1);
    int next = min(k + 1, terrain_clip_count - 1);
    return mix(terrain_ground(p, k), terrain_ground(p, next), 1.0 + scale - ceil(scale));
}
