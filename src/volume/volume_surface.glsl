#include "render/glsl/surface.glsl"

// A volume as `surface`: where the value crosses the isovalue. Stands on volume.glsl.

uniform float roughness; //! 0.35 [0, 1] | Roughness of the isosurface
uniform float metalness; //! 0 [0, 1] | Metalness of the isosurface
uniform float iso_step;  //! 0.5 [0.05, 2] log | Distance of the places where crossings are looked for, in voxels

uniform sampler3D volume_iso_bricks; // 1: the isovalue lies in the brick's range; -n: it does not in the n bricks around
uniform float volume_iso;            // the isovalue's place in the transfer function

float volume_above(vec3 place) { return volume_largest(volume_values(place)) - volume_iso; }

// The first crossing in either direction, between places iso_step apart, made exact by false position (Illinois: Dowell & Jarratt 1971).
bool surface_trace(Ray ray, out Hit hit) {
    hit = Hit(ray.t_max, ray.origin, 0.0, 0.0);
    MediumRay path;
    if (!volume_enter(ray, path)) return false;
    float stride = max(iso_step * volume_spacing, (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min;
    float before = volume_above(path.origin + t * path.direction);
    float here = before;
    float border = t;
    bool something = true;
    bool found = false;
    float t_before = t;
    for (int i = 0; i < 8192 && t < ray.t_max && !found; ++i) {
        for (int k = 0; k < 8 && t >= border; ++k) {
            float most;
            volume_segment(volume_iso_bricks, path, t, border, most);
            something = most > 0.0;
            if (!something) t = border;
        }
        // Within stepped-over bricks the value stays on its side.
        t_before = t;
        before = something ? here : before;
        t = min(t + stride, ray.t_max);
        here = volume_above(path.origin + t * path.direction);
        found = here * before < 0.0 || (here == 0.0 && before != 0.0);
        before = found ? before : here;
    }
    if (!found) return false;
    float a = t_before;
    float b = t;
    float fa = before;
    float fb = here;
    for (int i = 0; i < 8; ++i) {
        float c = mix(a, b, clamp(fa / (fa - fb), 0.02, 0.98));
        float fc = volume_above(path.origin + c * path.direction);
        if (fc * fb < 0.0) {
            a = b;
            fa = fb;
        } else {
            fa *= 0.5;
        }
        b = c;
        fb = fc;
        if (abs(a - b) < 1e-4 * volume_spacing || fb == 0.0) break;
    }
    hit.t = b;
    hit.position = ray.origin + b * ray.direction;
    hit.footprint = max(ray.width + ray.spread * b, 0.05 * volume_spacing);
    return true;
}

// Bricks tell of rays, not of cones: they start where the ray does.
float surface_clear(Ray cone) { return cone.t_min; }

vec3 surface_normal(Hit hit, vec3 direction) {
    vec3 gradient = volume_world_gradient(volume_place(hit.position));
    float steepness = length(gradient);
    if (steepness <= 0.0) return -direction;
    vec3 n = gradient / steepness;
    return dot(n, direction) > 0.0 ? -n : n;
}

Material surface_material(Hit hit, vec3 normal) {
    vec3 color = volume_lookup(0, volume_iso, 1.0).rgb;
    if (volume_channels > 1) color = volume_appearance(volume_place(hit.position)).rgb;
    return Material(color, roughness, metalness, volume_emission(volume_place(hit.position), vec4(color, 1.0)));
}

vec3 surface_leave(Hit hit, vec3 normal) { return hit.position + (0.02 * volume_spacing) * normal; }

bool surface_blocked(Hit hit, vec3 normal, vec3 direction, float t_max) {
    if (dot(normal, direction) <= 0.0) return true;
    Hit other;
    return surface_trace(Ray(surface_leave(hit, normal), direction, 0.0, t_max, hit.footprint, 0.0), other);
}

// A march in one step: empty bricks are leapt over within the trace, which nothing would be gained by taking apart.
March surface_march(Hit hit, vec3 normal) {
    return March(surface_leave(hit, normal), normal, 0.0, 0.0, hit.footprint, 0.0, 0.0, 0.0, 1);
}

void surface_march_to(inout March march, vec3 direction, float t_max) {
    march.direction = direction;
    march.t_max = t_max;
}

int surface_march_on(inout March march) {
    if (march.t_max <= 0.0) return march_free;
    Hit other;
    Ray ray = Ray(march.origin, march.direction, 0.0, march.t_max, march.threshold, 0.0);
    return surface_trace(ray, other) ? march_blocked : march_free;
}

float surface_visibility(Hit hit, vec3 normal, vec3 direction, float t_max, float spread) {
    return surface_blocked(hit, normal, direction, t_max) ? 0.0 : 1.0;
}

// Cameras may go into a volume: near it, their scale is a part of its size.
float surface_distance(vec3 position) {
    vec3 place = volume_place(position);
    vec3 outside = max(max(-place, place - volume_size), 0.0);
    return max(length(outside) * volume_spacing, 0.05 / volume_unit);
}

// Part of a few places above the surface, nearer ones first, that are on the open side.
float surface_openness(Hit hit, vec3 normal) {
    float side = sign(volume_above(volume_place(hit.position + (0.5 * volume_spacing) * normal)));
    float open = 0.0;
    float weights = 0.0;
    float weight = 1.0;
    for (int i = 0; i < 5; ++i) {
        float reach = volume_spacing * (1.5 + 2.0 * float(i * i));
        for (int k = 0; k < 3; ++k) {
            vec3 aside = cross(normal, vec3(k == 0, k == 1, k == 2));
            vec3 place = volume_place(hit.position + reach * normalize(normal + 0.8 * aside));
            bool inside = all(greaterThan(place, vec3(0.0))) && all(lessThan(place, volume_size));
            open += weight * (!inside || volume_above(place) * side >= 0.0 ? 1.0 : 0.0);
            weights += weight;
        }
        weight *= 0.75;
    }
    return open / weights;
}
