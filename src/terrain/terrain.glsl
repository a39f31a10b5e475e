#include "render/glsl/camera.glsl"
#include "terrain/glsl/clipmap.glsl"

// The `surface` interface of terrain: what the camera sees was drawn (tile_fragment.glsl); all other rays march over
// the clipmap.

uniform int shadow_steps; //! 80 [8, 400] log | Most steps along a shadow ray
uniform float occlusion_reach; //! 0.1 [0.005, 1] log | How far ambient occlusion looks, relative to the distance from the camera
uniform float snow; //! 0.5 [0, 1] step 0.01 | How much of the ground the ground's second material covers: snow, sand, grass
uniform float color_scale; //! 1 [0.05, 20] log | How fast the ground's colours change with height, where the ground has layers
uniform int debug; //! none {none, levels, borders, wireframe, boxes, corners} | Tiles' levels in colour; with their borders, all lines of the mesh, the boxes that bound their heights, or marks where the processor has the heights of their corners

uniform sampler2D terrain_seen_position;
uniform sampler2D terrain_seen_slope;
uniform bool terrain_drawn; // false: camera rays march as well
uniform float terrain_relief;      // one cell of height [world]
uniform float terrain_layers[24]; // the camera's height in layers of 2^(i - 10) cells of height, 0..1

vec4 terrain_slope; // of what the last ray met: as seen_slope
bool terrain_seen;  // it was drawn

// Marches to where the ray goes under the ground; by steps in proportion to the height above it, and then by halving.
bool terrain_march(Ray ray, out float t) {
    t = ray.t_min + 1e-6;
    float before = t;
    float spacing = terrain_clip_spacing(0);
    for (int i = 0; i < 160; ++i) {
        vec3 p = ray.origin + t * ray.direction;
        int k = terrain_clip_level(p.xy, max(ray.width + ray.spread * t, 0.02 * (t - ray.t_min)));
        spacing = terrain_clip_spacing(k);
        float d = p.z - terrain_ground(p.xy, k);
        if (d < 0.0) {
            for (int j = 0; j < 6; ++j) {
                float middle = 0.5 * (before + t);
                vec3 q = ray.origin + middle * ray.direction;
                if (q.z < terrain_ground(q.xy, k))
                    t = middle;
                else
                    before = middle;
            }
            return true;
        }
        before = t;
        t += max(0.5 * d, 0.5 * spacing);
        if (t > ray.t_max || terrain_clip_beyond(p.xy)) return false;
    }
    return false;
}

bool surface_trace(Ray ray, out Hit hit) {
    hit = Hit(ray.t_max, ray.origin, 0.0, 0.0);
    terrain_seen = terrain_drawn && ray.width == 0.0 && ray.spread > 0.0;
    bool found = false;
    if (terrain_seen) {
        // Camera rays: the pixel from the direction, through the lens.
        vec3 v = ray.direction * camera_basis;
        vec2 lens = (ray.origin * camera_basis).xy;
        vec2 film = v.xy / -v.z + lens / camera_focus;
        vec2 size = vec2(camera_size);
        vec2 point =
            vec2(0.5 * size.x, 0.5 * size.y) + vec2(film.x, -film.y) * (size.y / camera_extent) - camera_shift.xy;
        ivec2 pixel = clamp(ivec2(floor(point)), ivec2(0), camera_size - 1);
        vec4 seen = texelFetch(terrain_seen_position, pixel, 0);
        terrain_slope = texelFetch(terrain_seen_slope, pixel, 0);
        if (seen.w > 0.0) {
            found = true;
            hit.position = seen.xyz;
            hit.t = length(seen.xyz - ray.origin);
        }
    }
    if (!terrain_seen) {
        float t;
        found = terrain_march(ray, t);
        hit.t = t;
        hit.position = ray.origin + t * ray.direction;
        terrain_slope = vec4(0.0);
    }
    hit.footprint = ray.width + ray.spread * hit.t;
    return found;
}

float surface_clear(Ray cone) {
    return cone.t_min;
}

vec3 surface_normal(Hit hit, vec3 direction) {
    vec2 slope = terrain_slope.xy;
    if (!terrain_seen) {
        int k = terrain_clip_level(hit.position.xy, hit.footprint);
        float s = terrain_clip_spacing(k);
        slope.x = terrain_ground(hit.position.xy + vec2(s, 0.0), k) - terrain_ground(hit.position.xy - vec2(s, 0.0), k);
        slope.y = terrain_ground(hit.position.xy + vec2(0.0, s), k) - terrain_ground(hit.position.xy - vec2(0.0, s), k);
        slope *= 0.5 / s;
    }
    return normalize(vec3(-slope, 1.0));
}

// Above the ground as the clipmap has it, which lacks the finest octaves of what is seen.
vec3 surface_leave(Hit hit, vec3 normal) {
    int k = terrain_clip_level(hit.position.xy, hit.footprint);
    vec3 p = hit.position;
    p.z = max(p.z, terrain_ground(p.xy, k)) + 0.2 * terrain_clip_spacing(k);
    return p;
}

// By how much of the way behind it a ray's step is longer at least, so that shadow_steps steps reach the last square.
float terrain_growth(float spacing) {
    float reach = 110.0 * terrain_clip_spacing(terrain_clip_count - 1);
    return max(exp(1.3 * log(max(reach / spacing, 2.0)) / float(shadow_steps)) - 1.0, 0.03);
}

// The narrowest passage over the ground, in units of the light's radius (after Quilez 2010), with steps and points that
// grow with the distance: penumbras do, too.
float surface_visibility(Hit hit, vec3 normal, vec3 direction, float t_max, float spread) {
    vec3 p = surface_leave(hit, normal);
    float spacing = terrain_clip_spacing(terrain_clip_level(p.xy, hit.footprint));
    float width = max(spread, 0.004);
    // Steps of other lengths in each pixel and sample: what they miss would else be seen as ripples. By the footprint's
    // place rather than its bits, so that devices that round differently take the same steps.
    ivec2 place = ivec2(floor(hit.position.xy / hit.footprint));
    float stride = 0.85 + 0.3 * random_unit(random_hash(uint(place.x) ^ random_hash(uint(place.y) ^ random_hash(random_sample))));
    float t = stride * spacing;
    float open = 1.0;
    float growth = terrain_growth(spacing);
    for (int i = 0; i < shadow_steps && t < t_max; ++i) {
        vec3 q = p + t * direction;
        float d = q.z - terrain_ground(q.xy, terrain_clip_level(q.xy, max(0.3 * growth * t, spacing)));
        open = min(open, d / (t * width + 0.15 * spacing));
        if (open < -1.0 || terrain_clip_beyond(q.xy)) break;
        t += stride * max(max(0.4 * d, growth * t), 0.7 * spacing);
    }
    float part = clamp(0.5 + 0.5 * open, 0.0, 1.0);
    return part * part * (3.0 - 2.0 * part);
}

March surface_march(Hit hit, vec3 normal) {
    float spacing = terrain_clip_spacing(terrain_clip_level(hit.position.xy, hit.footprint));
    return March(surface_leave(hit, normal), vec3(0.0, 0.0, 1.0), 0.0, 1e30, spacing, 0.0, 0.0, terrain_growth(spacing), 0);
}

void surface_march_to(inout March march, vec3 direction, float t_max) {
    march.direction = direction;
    march.t = 0.5 * march.threshold;
    march.t_max = t_max;
    march.steps = shadow_steps;
}

int surface_march_on(inout March march) {
    vec3 q = march.origin + march.t * march.direction;
    if (march.steps <= 0 || march.t >= march.t_max || terrain_clip_beyond(q.xy)) return march_free;
    float d = q.z - terrain_ground(q.xy, terrain_clip_level(q.xy, max(0.3 * march.stride * march.t, march.threshold)));
    if (d < 0.0) return march_blocked;
    march.t += max(max(0.4 * d, march.stride * march.t), 0.7 * march.threshold);
    --march.steps;
    return march_on;
}

bool surface_blocked(Hit hit, vec3 normal, vec3 direction, float t_max) {
    March march = surface_march(hit, normal);
    surface_march_to(march, direction, t_max);
    int state = march_on;
    for (int i = 0; i <= shadow_steps && state == march_on; ++i)
        state = surface_march_on(march);
    return state == march_blocked;
}

float surface_distance(vec3 position) {
    return 0.4 * (position.z - terrain_ground(position.xy, terrain_clip_level(position.xy, 0.0)));
}

// How high the ground rises above the tangent plane in six directions, at four distances (Bavoil, Sainz & Dimitrov
// 2008, "Image-space horizon-based ambient occlusion", over the heights themselves).
float surface_openness(Hit hit, vec3 normal) {
    vec3 p = surface_leave(hit, normal);
    float spacing = terrain_clip_spacing(terrain_clip_level(p.xy, hit.footprint));
    float reach = max(occlusion_reach * hit.t, 4.0 * spacing);
    float open = 0.0;
    for (int i = 0; i < 6; ++i) {
        float angle = 1.047197551 * (float(i) + 0.5);
        vec2 way = vec2(cos(angle), sin(angle));
        float tangent = -dot(normal.xy, way) / max(normal.z, 0.05);
        float base = tangent * inversesqrt(1.0 + tangent * tangent);
        float highest = base;
        for (int j = 0; j < 4; ++j) {
            float r = reach * exp2(-1.3 * float(j));
            vec2 q = p.xy + r * way;
            float rise = (terrain_ground(q, terrain_clip_level(q, 0.25 * r)) - p.z) / r;
            highest = max(highest, rise * inversesqrt(1.0 + rise * rise));
        }
        open += 1.0 - min(highest - base, 1.0);
    }
    open /= 6.0;
    return open * open;
}

// What a ground (grounds/NAME.glsl) knows of a place. All of it is relative to how large things are in the picture, so
// that it looks alike at any depth, and changes without a step however the camera moves.
struct Ground {
    float rise;     // over the smooth ground around, -1..1: ridges and hollows
    float altitude; // over the ground at large, -1..1: mountains and valleys
    float slope;    // sine of the steepness: 0 level, 1 a wall
    float grain;    // a smooth random number of the place, 0..1
    vec2 layer;     // the height in layers of two thicknesses, the second twice the first: 0..1 in each
    float thick;    // how much the second one counts, 0..1: ground_layers()
};

// A function of a layer's phase for both thicknesses: mix(f(g.layer.x), f(g.layer.y), g.thick).
vec4 ground_material(Ground ground); // linear albedo, roughness

// Height over the ground of squares `scale`, in units of twice their spacing; 0 where there are none.
float terrain_rise(vec3 p, float scale) {
    int k = int(ceil(scale));
    float last = float(terrain_clip_count - 1);
    vec2 known = step(vec2(k, k + 1), vec2(last));
    ivec2 squares = min(ivec2(k, k + 1), ivec2(terrain_clip_count - 1));
    float a = (p.z - terrain_ground(p.xy, squares.x)) / (2.0 * terrain_clip_spacing(squares.x));
    float b = (p.z - terrain_ground(p.xy, squares.y)) / (2.0 * terrain_clip_spacing(squares.y));
    return mix(known.x * a, known.y * b, 1.0 + scale - ceil(scale));
}

// Of the ground at large, with some of the detail: cover does not lie on single stones.
float terrain_steepness(Hit hit, vec3 normal, float scale) {
    float broad = min(scale, float(terrain_clip_count - 1));
    float s = terrain_clip_spacing(0) * exp2(broad);
    vec2 p = hit.position.xy;
    float h = terrain_ground_at(p, broad);
    vec2 tilt = vec2(terrain_ground_at(p + vec2(s, 0.0), broad), terrain_ground_at(p + vec2(0.0, s), broad)) - h;
    tilt = mix(tilt / s, -normal.xy / max(normal.z, 0.05), 0.35);
    return sqrt(1.0 - 1.0 / (1.0 + dot(tilt, tilt)));
}

Material surface_material(Hit hit, vec3 normal) {
    float scale = terrain_clip_scale(hit.position.xy, hit.footprint);
    Ground ground;
    ground.rise = clamp(terrain_rise(hit.position, scale + 6.0), -1.0, 1.0);
    ground.altitude = clamp(terrain_rise(hit.position, scale + 9.0), -1.0, 1.0);
    ground.grain = clamp(0.5 + 0.8 * terrain_rise(hit.position, scale + 3.0), 0.0, 1.0);
    ground.slope = terrain_steepness(hit, normal, scale + 2.0);
    // Layers as thick as a part of the distance: as thin near as far, on the screen.
    float thickness = clamp(10.0 + log2(0.35 * max(length(hit.position), 1e-6) / (color_scale * terrain_relief)), 0.0, 22.0);
    int layer = int(floor(thickness));
    vec2 heights = hit.position.z / terrain_relief * exp2(vec2(10 - layer, 9 - layer));
    ground.layer = fract(vec2(terrain_layers[layer], terrain_layers[layer + 1]) + heights);
    ground.thick = fract(thickness);
    vec4 m = ground_material(ground);
    if (debug > 0) {
        float hue = fract(0.381966 * terrain_slope.z);
        m.rgb = 0.1 + 0.7 * clamp(abs(fract(hue + vec3(0.0, 0.6667, 0.3333)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
        if (terrain_slope.w == 1.0) m.rgb *= 0.12;
        if (terrain_slope.w > 1.0)
            return Material(vec3(0.0), 1.0, 0.0, terrain_slope.w == 2.0 ? vec3(2.0, 1.4, 0.1) : vec3(2.0, 0.05, 0.3));
    }
    return Material(m.rgb, m.a, 0.0, vec3(0.0));
}
