// A volume's values as the device's textures have them, interpolated by the device where it can.

uniform sampler3D volume_data; // stored values, up to 4 channels

void volume_frame_values() {}

vec4 volume_texel(ivec3 at) { return texelFetch(volume_data, clamp(at, ivec3(0), ivec3(volume_size) - 1), 0); }

vec4 volume_stored(vec3 place) {
    if (!volume_manual) return textureLod(volume_data, place / frame_size, 0.0);
    vec3 p = place - 0.5;
    vec3 cell = floor(p);
    vec3 f = p - cell;
    ivec3 c = ivec3(cell);
    vec4 low = mix(mix(volume_texel(c), volume_texel(c + ivec3(1, 0, 0)), f.x),
                   mix(volume_texel(c + ivec3(0, 1, 0)), volume_texel(c + ivec3(1, 1, 0)), f.x), f.y);
    vec4 high = mix(mix(volume_texel(c + ivec3(0, 0, 1)), volume_texel(c + ivec3(1, 0, 1)), f.x),
                    mix(volume_texel(c + ivec3(0, 1, 1)), volume_texel(c + ivec3(1, 1, 1)), f.x), f.y);
    return mix(low, high, f.z);
}

float volume_reach(vec3 place) { return 1.0; }
