// A volume's values on devices that are software: each texel holds all eight voxels between which values are interpolated, so that one
// place in memory is read instead of eight; and interpolation is exact, where such devices interpolate bytes to bytes.
//
// The engine adds: const bool volume_halves, whether values are half floats; else they are normalised bytes.

uniform usampler3D volume_corners; // nearest; texel (i, j, k): voxels (i - 1, j - 1, k - 1) to (i, j, k), x first; those beyond the border as on it

vec4 volume_bytes(uint four) { return vec4(uvec4(four, four >> 8, four >> 16, four >> 24) & 255u); }

uniform vec3 volume_corners_step;  // 1 / its size

vec3 frame_corners_step;
void volume_frame_values() { frame_corners_step = volume_corners_step; }

// Where it is in the texture, 0..1.
vec3 volume_texel(vec3 c) {
    vec3 pair = floor(0.5 * c);
    vec3 odd = c - 2.0 * pair;
    return (pair * vec3(8.0, 1.0, 1.0) + (vec3(dot(odd, vec3(1.0, 2.0, 4.0)), 0.0, 0.0) + 0.5)) * frame_corners_step;
}

vec4 volume_stored(vec3 place) {
    vec3 p = clamp(place + 0.5, vec3(0.0), frame_size + 0.5);
    vec3 cell = floor(p);
    vec3 f = p - cell;
    uvec4 corners = textureLod(volume_corners, volume_texel(cell), 0.0);
    vec4 low;
    vec4 high;
    if (volume_halves) {
        low = vec4(unpackHalf2x16(corners.x), unpackHalf2x16(corners.y));
        high = vec4(unpackHalf2x16(corners.z), unpackHalf2x16(corners.w));
    } else {
        low = volume_bytes(corners.x) * (1.0 / 255.0);
        high = volume_bytes(corners.y) * (1.0 / 255.0);
    }
    vec4 plane = mix(low, high, f.z);
    vec2 line = mix(plane.xy, plane.zw, f.y);
    return vec4(mix(line.x, line.y, f.x), 0.0, 0.0, 1.0);
}

float volume_reach(vec3 place) { return 1.0; }
