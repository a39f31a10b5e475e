#include "render/glsl/camera.glsl"
#include "terrain/glsl/clipmap.glsl"

// The `surface` interface of terrain: what the camera sees was drawn (tile_fragment.glsl); all other rays march over
// the clipmap.

uniform int shadow_steps; //! 56 [8, 400] log | Most steps along a shadow ray
uniform float occlusion_reach; //! 0.1 [0.005, 1] log | How far ambient occlusion looks, relative to the distance from the camera
uniform float snow; //! 0.5 [0, 1] step 0.01 | How much of the ground the ground's second material covers: snow, sand, grass
uniform float color_scale; //! 1 [0.05, 20] log | How fast the ground's colours change with height
uniform int debug; //! none {none, levels, borders, wireframe} | Tiles' levels in colour, with their borders, with all lines of the mesh

uniform sampler2D terrain_seen_position;
uniform sampler2D terrain_seen_slope;
uniform bool terrain_drawn; // false: camera rays march as well
uniform float terrain_zero; // height of the address's corner from the camera [world]

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
    // A loop of at most one turn: rasterisers on the CPU compute both sides of an `if`.
    for (int i = 0; i < (terrain_seen ? 0 : 1); ++i) {
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
    for (int i = 0; i < (terrain_seen ? 0 : 1); ++i) {
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

// The narrowest passage over the ground, in units of the light's radius (after Quilez 2010), with steps and points that
// grow with the distance: penumbras do, too.
float surface_visibility(Hit hit, vec3 normal, vec3 direction, float t_max, float spread) {
    vec3 p = surface_leave(hit, normal);
    float spacing = terrain_clip_spacing(terrain_clip_level(p.xy, hit.footprint));
    float width = max(spread, 0.004);
    float t = spacing;
    float open = 1.0;
    for (int i = 0; i < shadow_steps && t < t_max; ++i) {
        vec3 q = p + t * direction;
        int k = terrain_clip_level(q.xy, max(0.03 * t, spacing));
        float d = q.z - terrain_ground(q.xy, k);
        open = min(open, d / (t * width + 0.15 * spacing));
        if (open < -1.0 || terrain_clip_beyond(q.xy)) break;
        t += max(max(0.45 * d, 0.05 * t), 0.7 * spacing);
    }
    float part = clamp(0.5 + 0.5 * open, 0.0, 1.0);
    return part * part * (3.0 - 2.0 * part);
}

March surface_march(Hit hit, vec3 normal) {
    return March(surface_leave(hit, normal), vec3(0.0, 0.0, 1.0), 0.0, 1e30,
                 terrain_clip_spacing(terrain_clip_level(hit.position.xy, hit.footprint)), 0.0, 0.0, 0);
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
    float d = q.z - terrain_ground(q.xy, terrain_clip_level(q.xy, max(0.03 * march.t, march.threshold)));
    if (d < 0.0) return march_blocked;
    march.t += max(max(0.45 * d, 0.05 * march.t), 0.7 * march.threshold);
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

// What a ground (grounds/NAME.glsl) knows of a place.
struct Ground {
    float height; // over the corner of the address's cell [world]
    float rise;   // over the smooth ground at large, -1..1: ridges and hollows
    float slope;  // sine of the steepness: 0 level, 1 a wall
    float octave; // of the finest detail, counted from the address's level
    float grain;  // a smooth random number of the place, 0..1
};

vec4 ground_material(Ground ground); // linear albedo, roughness

float terrain_rise(vec3 p, int k) {
    float s = terrain_clip_spacing(k);
    return (p.z - terrain_ground(p.xy, k)) / (2.0 * s);
}

Material surface_material(Hit hit, vec3 normal) {
    int k = terrain_clip_level(hit.position.xy, hit.footprint);
    float near = terrain_rise(hit.position, min(k + 3, terrain_clip_count - 1));
    float far = terrain_rise(hit.position, min(k + 6, terrain_clip_count - 1));
    Ground ground;
    ground.height = (hit.position.z - terrain_zero) * color_scale;
    ground.rise = clamp(far, -1.0, 1.0);
    ground.grain = clamp(0.5 + 0.8 * near, 0.0, 1.0);
    // Of the ground at large, with some of the detail: cover does not lie on single stones.
    int broad = min(k + 2, terrain_clip_count - 1);
    float s = terrain_clip_spacing(broad);
    float h = terrain_ground(hit.position.xy, broad);
    vec2 tilt = vec2(terrain_ground(hit.position.xy + vec2(s, 0.0), broad), terrain_ground(hit.position.xy + vec2(0.0, s), broad)) - h;
    tilt = mix(tilt / s, -normal.xy / max(normal.z, 0.05), 0.35);
    ground.slope = sqrt(1.0 - 1.0 / (1.0 + dot(tilt, tilt)));
    ground.octave = terrain_slope.z;
    vec4 m = ground_material(ground);
    if (debug > 0) {
        float hue = fract(0.381966 * terrain_slope.z);
        m.rgb = 0.1 + 0.7 * clamp(abs(fract(hue + vec3(0.0, 0.6667, 0.3333)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
        if (terrain_slope.w > 0.0) m.rgb *= 0.12;
    }
    return Material(m.rgb, m.a, 0.0, vec3(0.0));
}
