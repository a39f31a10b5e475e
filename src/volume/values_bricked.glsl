// A large volume's values: bricks of 32 x 32 x 32 voxels of several levels, each with a border of one voxel, in one texture. Within a
// brick they are interpolated as in one piece; where bricks of two levels meet, they differ as the levels do.

uniform sampler3D volume_atlas; // stored values, up to 4 channels
uniform sampler3D volume_pages; // of each brick of the finest level: grid coordinates * w + xyz are the place in the atlas [texels]

vec3 frame_atlas_step; // 1 / the atlas's size
void volume_frame_values() { frame_atlas_step = 1.0 / vec3(textureSize(volume_atlas, 0)); }

vec4 volume_page(vec3 inside) {
    return texelFetch(volume_pages, min(ivec3(inside) >> 5, textureSize(volume_pages, 0) - 1), 0);
}

float volume_reach(vec3 place) { return 1.0 / volume_page(clamp(place, vec3(0.0), frame_size)).w; }

vec4 volume_stored(vec3 place) {
    vec3 inside = clamp(place, vec3(0.0), frame_size);
    vec4 at = volume_page(inside);
    vec3 p = inside * at.w + at.xyz;
    if (!volume_manual) return textureLod(volume_atlas, p * frame_atlas_step, 0.0);
    p -= 0.5;
    vec3 cell = floor(p);
    vec3 f = p - cell;
    ivec3 c = ivec3(cell);
    vec4 low = mix(mix(texelFetch(volume_atlas, c, 0), texelFetch(volume_atlas, c + ivec3(1, 0, 0), 0), f.x),
                   mix(texelFetch(volume_atlas, c + ivec3(0, 1, 0), 0), texelFetch(volume_atlas, c + ivec3(1, 1, 0), 0), f.x), f.y);
    vec4 high = mix(mix(texelFetch(volume_atlas, c + ivec3(0, 0, 1), 0), texelFetch(volume_atlas, c + ivec3(1, 0, 1), 0), f.x),
                    mix(texelFetch(volume_atlas, c + ivec3(0, 1, 1), 0), texelFetch(volume_atlas, c + ivec3(1, 1, 1), 0), f.x), f.y);
    return mix(low, high, f.z);
}
