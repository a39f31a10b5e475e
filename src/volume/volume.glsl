#include "render/glsl/field.glsl"
#include "render/glsl/medium.glsl"

// A measured volume as `field` and `medium`: values interpolated between voxels, then looked up in the transfer function. Its own
// coordinates are those of the grid: voxel (i, j, k) is the box from (i, j, k) to (i, j, k) + 1, its centre in the middle.
//
// The engine adds: const int volume_channels; const bool volume_manual, volume_steep (gradients have a part in the transfer function),
// volume_glows (there is light of the volume's own); const float volume_brick; and how values are read.

uniform float density;    //! 100 [0, 1e6] log | Extinction where the transfer function's opacity is 1, per longest side of the volume
uniform float anisotropy; //! 0 [-0.99, 0.99] | Mean cosine of scattering: below 0 back, 0 to all sides, above 0 forwards (Henyey & Greenstein)
uniform float emission;   //! 0 [0, 1000] log | Radiance that a thick layer gives off by itself, in its colour
uniform float surfaces;   //! 0 [0, 100] log | How soon borders scatter as surfaces do instead of as haze (by their gradient); 0: never

uniform sampler3D volume_bricks;   // largest opacity in each brick; -n: nothing in the n bricks around it, itself included
uniform sampler3D volume_ranges;   // lowest and highest value in each brick, as places in the transfer function
uniform sampler2D volume_transfer; // colour and opacity: value along x, one block of rows for each channel
uniform mat3 volume_to_grid;       // from world to grid
uniform vec3 volume_camera;        // grid coordinates of the camera
uniform vec3 volume_size;          // [voxels]
uniform vec4 volume_scale;         // a stored value times this ...
uniform vec4 volume_offset;        // ... plus this is its place in the transfer function, 0..1 (of each channel)
uniform vec4 volume_gradient;      // a gradient's length [places per world unit] times this is its place in the transfer function, 0..1
uniform vec3 volume_brick_count;    // in volume_bricks and volume_ranges
uniform vec2 volume_transfer_size; // [texels]
uniform int volume_rows;           // of the transfer function for each channel
uniform sampler2D volume_glow;     // radiance that a thick layer gives off by itself, as the transfer function is
uniform float volume_unit;         // 1 / longest side [1/world unit]
uniform float volume_spacing;      // least distance of neighbouring voxels [world unit]

// What marches ask for again and again, from uniforms: llvmpipe reads these for each pixel by itself, every time.
vec3 frame_size;        // volume_size
vec3 frame_brick_count; // volume_brick_count ...
vec3 frame_brick_step;  // ... and 1 / that
vec2 frame_table_last;  // of the transfer function's texels: column, and row of one channel
vec2 frame_table_step;  // 1 / its size
vec4 frame_scale;       // volume_scale
vec4 frame_offset;      // volume_offset
float frame_spacing;    // volume_spacing
float frame_density;    // extinction where the opacity is 1 [1/world unit]

// Sets those of the file with the values.
void volume_frame_values();

// Before anything is marched or looked up.
void volume_frame() {
    frame_size = volume_size;
    frame_brick_count = volume_brick_count;
    frame_brick_step = 1.0 / volume_brick_count;
    frame_table_last = vec2(volume_transfer_size.x - 1.0, float(volume_rows - 1));
    frame_table_step = 1.0 / volume_transfer_size;
    frame_scale = volume_scale;
    frame_offset = volume_offset;
    frame_spacing = volume_spacing;
    frame_density = density * volume_unit;
    volume_frame_values();
}

vec3 volume_place(vec3 position) { return volume_to_grid * position + volume_camera; }

// Stored values between voxels: in values_sampled.glsl or values_corners.glsl.
vec4 volume_stored(vec3 place);

// Distance of the values between which they are interpolated there: 1, and more where a coarser level is shown.
float volume_reach(vec3 place);

// Places in the transfer function, 0..1.
vec4 volume_values(vec3 place) { return volume_stored(place) * frame_scale + frame_offset; }

float volume_largest(vec4 values) {
    float most = values.x;
    if (volume_channels > 1) most = max(most, values.y);
    if (volume_channels > 2) most = max(most, values.z);
    if (volume_channels > 3) most = max(most, values.w);
    return most;
}

// Differences of two neighbours, one voxel of what is shown away: per grid unit, in the places of the transfer function.
vec3 volume_slope(vec3 place, int channel) {
    vec3 slope;
    float reach = volume_reach(place);
    for (int i = 0; i < 3; ++i) {
        vec3 aside = reach * vec3(i == 0, i == 1, i == 2);
        vec4 d = volume_stored(place + aside) - volume_stored(place - aside);
        slope[i] = 0.5 / reach * d[channel] * frame_scale[channel];
    }
    return slope;
}

// The gradient in world space of the sum of all channels.
vec3 volume_world_gradient(vec3 place) {
    vec3 slope;
    float reach = volume_reach(place);
    for (int i = 0; i < 3; ++i) {
        vec3 aside = reach * vec3(i == 0, i == 1, i == 2);
        vec4 d = (volume_stored(place + aside) - volume_stored(place - aside)) * frame_scale;
        float sum = d.x;
        if (volume_channels > 1) sum += d.y;
        if (volume_channels > 2) sum += d.z;
        if (volume_channels > 3) sum += d.w;
        slope[i] = 0.5 / reach * sum;
    }
    return slope * volume_to_grid;
}

// The texel of the transfer function that is nearest to a value and a gradient, both 0..1 over its domain.
// (Looked up by place, not by texelFetch(), as all that is asked for often: Mesa's llvmpipe works out a level for each of the latter.)
vec2 volume_entry(int channel, float value, float gradient) {
    vec2 texel = clamp(vec2(value, gradient), 0.0, 1.0) * frame_table_last;
    texel.y = volume_steep ? floor(texel.y + 0.5) : 0.0;
    texel.y += float(channel) * (frame_table_last.y + 1.0);
    return (texel + 0.5) * frame_table_step;
}

vec4 volume_lookup(int channel, float value, float gradient) {
    return textureLod(volume_transfer, volume_entry(channel, value, gradient), 0.0);
}

// The gradient's place in the transfer function, where that has a use for it.
float volume_steepness(vec3 place, int channel) {
    if (!volume_steep) return 0.0;
    return length(volume_slope(place, channel) * volume_to_grid) * volume_gradient[channel];
}

// Colour, and opacity: those of all channels add, and their colours mix by them.
vec4 volume_appearance(vec3 place) {
    vec4 values = volume_values(place);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < volume_channels; ++i) {
        vec4 seen = volume_lookup(i, values[i], volume_steepness(place, i));
        if (volume_channels == 1) return seen;
        sum += vec4(seen.rgb * seen.a, seen.a);
    }
    return vec4(sum.rgb / max(sum.a, 1e-20), sum.a);
}

// Light of the volume's own: the glow of all channels, weighted by their opacities, and the part of the colour that is set.
vec3 volume_emission(vec3 place, vec4 seen) {
    vec3 sum = vec3(0.0);
    if (volume_glows && seen.a > 0.0) {
        vec4 values = volume_values(place);
        for (int i = 0; i < volume_channels; ++i) {
            vec2 entry = volume_entry(i, values[i], volume_steepness(place, i));
            float part = volume_channels == 1 ? 1.0 : textureLod(volume_transfer, entry, 0.0).a / seen.a;
            sum += part * textureLod(volume_glow, entry, 0.0).rgb;
        }
    }
    return sum + emission * seen.rgb;
}

MediumRay volume_path(Ray ray) {
    volume_frame();
    vec3 d = volume_to_grid * ray.direction;
    // Directions along an axis: a tiny one instead of 0, whose inverse is a number.
    float least = 1e-9 * max(abs(d.x), max(abs(d.y), abs(d.z)));
    d = mix(d, vec3(least), lessThan(abs(d), vec3(least)));
    return MediumRay(volume_place(ray.origin), d, 1.0 / d);
}

// Cuts the ray to the grid's box; false when it misses.
bool volume_enter(inout Ray ray, out MediumRay path) {
    path = volume_path(ray);
    vec3 a = -path.origin * path.inverse;
    vec3 b = (volume_size - path.origin) * path.inverse;
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    ray.t_min = max(ray.t_min, max(near.x, max(near.y, near.z)));
    ray.t_max = min(ray.t_max, min(far.x, min(far.y, far.z)));
    volume_clip(ray.origin, ray.direction, ray.t_min, ray.t_max);
    return ray.t_min < ray.t_max;
}

bool medium_enter(inout Ray ray, out MediumRay path) { return volume_enter(ray, path); }

bool field_clip(inout Ray ray) {
    MediumRay path;
    return volume_enter(ray, path);
}

// Bricks are stepped through one by one, or several empty ones at once, from wherever t is (Amanatides & Woo 1987, without their state:
// the next border follows from the place). `volume_nudge` takes a place on a border to its far side.
const float volume_nudge = 2e-3;

vec3 volume_brick_at(MediumRay path, float t) {
    vec3 place = (path.origin + t * path.direction + volume_nudge * sign(path.inverse)) * (1.0 / volume_brick);
    return clamp(floor(place), vec3(0.0), frame_brick_count - 1.0);
}

// Where the path leaves the bricks of which the outermost are `reach` away from this one.
float volume_brick_end(MediumRay path, float t, vec3 brick, float reach) {
    vec3 border = (brick + 0.5 + sign(path.inverse) * (0.5 + reach)) * volume_brick;
    vec3 ends = (border - path.origin) * path.inverse;
    // Always on: where rounding leaves no way to the border, by a part of a voxel, or from far away by what a number can tell.
    return max(min(ends.x, min(ends.y, ends.z)), t + max(0.25 * volume_nudge * frame_spacing, 3e-7 * abs(t)));
}

void volume_segment(sampler3D bricks, MediumRay path, float t, out float t_end, out float most) {
    vec3 brick = volume_brick_at(path, t);
    most = textureLod(bricks, (brick + 0.5) * frame_brick_step, 0.0).x;
    t_end = volume_brick_end(path, t, brick, max(-most, 1.0) - 1.0);
}

void medium_segment(MediumRay path, float t, out float t_end, out float majorant) {
    float most;
    volume_segment(volume_bricks, path, t, t_end, most);
    majorant = max(most, 0.0) * frame_density;
}

vec4 medium_look(vec3 place) {
    vec4 seen = volume_appearance(place);
    return vec4(seen.rgb, seen.a * frame_density);
}

Medium medium_at(vec3 place, vec4 look) {
    vec4 seen = vec4(look.rgb, look.a / max(frame_density, 1e-30));
    Medium m = Medium(look.a, look.rgb, volume_emission(place, seen), vec3(0.0), 0.0);
    if (surfaces > 0.0) {
        vec3 gradient = volume_world_gradient(place);
        float slope = length(gradient);
        if (slope <= 0.0) return m;
        m.normal = -gradient / slope;
        // Kroes, Post & Botha (2012), eq. 4: the more opaque and the steeper, the more of a surface it is.
        m.surface = seen.a * (1.0 - exp(-surfaces * slope / volume_unit * 0.02));
    }
    return m;
}

float medium_anisotropy() { return anisotropy; }

vec4 field_bounds() {
    mat3 to_world = inverse(volume_to_grid);
    vec3 middle = to_world * (0.5 * volume_size - volume_camera);
    vec3 half_diagonal = abs(to_world[0]) * volume_size.x + abs(to_world[1]) * volume_size.y + abs(to_world[2]) * volume_size.z;
    return vec4(middle, 0.5 * length(half_diagonal));
}

float field_spacing() { return volume_spacing; }

bool field_segment(Ray ray, float t, out float t_end) {
    float most;
    volume_segment(volume_bricks, volume_path(ray), t, t_end, most);
    return most > 0.0;
}

vec2 field_range(Ray ray, float t, out float t_end) {
    MediumRay path = volume_path(ray);
    vec3 brick = volume_brick_at(path, t);
    t_end = volume_brick_end(path, t, brick, 0.0);
    return textureLod(volume_ranges, (brick + 0.5) * frame_brick_step, 0.0).xy;
}

float field_value(vec3 position) { return clamp(volume_largest(volume_values(volume_place(position))), 0.0, 1.0); }

vec3 field_tint(float value) { return volume_lookup(0, value, 1.0).rgb; }

vec4 field_color(vec3 position) {
    vec4 seen = volume_appearance(volume_place(position));
    return vec4(seen.rgb, seen.a * frame_density);
}

vec3 field_emission(vec3 position, vec4 color) {
    return volume_emission(volume_place(position), vec4(color.rgb, color.a / max(frame_density, 1e-30)));
}

// Outside there is nothing: where things are cut off by the box, that is their surface.
vec3 field_gradient(vec3 position) {
    vec3 place = volume_place(position);
    vec3 slope = volume_world_gradient(place);
    vec3 below = vec3(lessThan(place, vec3(0.75)));
    vec3 above = vec3(greaterThan(place, volume_size - 0.75));
    if (any(greaterThan(below + above, vec3(0.0))))
        slope += (0.5 * max(volume_largest(volume_values(place)), 0.0) * (below - above)) * volume_to_grid;
    return slope;
}
