#include "render/glsl/camera.glsl"
#include "render/glsl/light_choice.glsl"
#include "render/glsl/brdf.glsl"
#include "render/glsl/medium.glsl"
#include "render/glsl/phase.glsl"

// Paths of light through a medium. Free flights by delta tracking (Woodcock et al. 1965) over local majorants, light by one ray for each
// collision whose transmittance is estimated by ratio tracking (Novak, Selle & Jarosz 2014), combined with what paths meet by chance
// (Veach & Guibas 1995). Absorption is a weight, not an end. All of it is one loop: each turn follows whichever ray is
// under way up to its next collision or its end, and then does that: neighbours never wait for each other's kind of ray.

// How paths are made: what renderers' parameters say.
struct MediumPaths {
    int bounces;    // most collisions
    int roulette;   // collisions after which dim paths may end
    int sampling;   // 0 both, 1 lights alone, 2 scattering alone
    int brdf;       // of borders
    float limit;    // most radiance of indirect light in one sample; 0: none
};

uint medium_random = 0u; // state of the numbers that are not worth a sequence of their own

// A permuted congruential generator (O'Neill 2014; Jarzynski & Olano 2020).
float medium_number() {
    medium_random = medium_random * 747796405u + 2891336453u;
    uint word = ((medium_random >> ((medium_random >> 28) + 4u)) ^ medium_random) * 277803737u;
    return random_unit((word >> 22) ^ word);
}

vec3 medium_limited(vec3 light, bool indirect, float limit) {
    float most = max(light.r, max(light.g, light.b));
    return indirect && limit > 0.0 && most > limit ? light * (limit / most) : light;
}

// An environment that is about the same everywhere (not environment_peaked, which the engine adds) is best found by chance: no ray
// for it is needed.
bool medium_asks_environment(int sampling) { return sampling == 1 || (sampling == 0 && environment_peaked); }

void medium_paths(MediumPaths how, ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    MediumRay path;
    vec3 sum = vec3(0.0);
    medium_random = random_hash(uint(pixel.x) ^ random_hash(uint(pixel.y) ^ random_hash(random_sample ^ random_hash(random_seed ^ 0x6d656469u))));
    // The first flight and the first collision have the sequences that converge fastest.
    vec2 first_flight = random_pair(pixel, 16u);
    vec2 first_scatter = random_pair(pixel, 17u);
    vec2 first_light = random_pair(pixel, 18u);
    float g = medium_anisotropy();

    vec3 through = vec3(1.0); // what is left of light that comes along the path when it reaches the camera
    int bounce = 0;           // collisions so far
    LightOrigin from = LightOrigin(vec3(0.0), vec3(0.0), 0.0, 0.0, medium_asks_environment(how.sampling)); // its last collision
    bool asking = false;      // the ray under way goes to a light
    vec3 light = vec3(0.0);   // what that brings if nothing is in the way
    vec3 next = vec3(0.0);    // where the path goes on to then
    float left = 1.0;         // transmittance so far of the way to the light

    float depth = -log(1.0 - first_flight.x); // optical depth up to the next event
    bool inside = medium_enter(ray, path);
    float t = ray.t_min;
    bool alive = true;
    bool lamp = false;        // the camera sees a light
    // Slices are seen by the camera alone; one that hides a part is there for that part of the paths.
    Slice slice = Slice(1e30, vec4(0.0));
    if (inside) slice = slice_next(ray, slice_start(ray));
    for (int i = 0; i < 4 && slice.t < 1e30; ++i) {
        if (slice.color.a >= 1.0 || medium_number() < slice.color.a) break;
        slice = slice_next(ray, slice.t);
    }
    bool sliced = slice.t < 1e30;
    ray.t_max = sliced ? min(slice.t, ray.t_max) : ray.t_max;
    for (int turn = 0; turn < 100000; ++turn) {
        bool gone = !inside;
        bool collided = false;
        vec4 look = vec4(0.0);
        // To the next scattering or the end: rejected collisions are many, and what comes after this is long.
        for (int n = 0; n < (gone ? 0 : 64); ++n) {
            bool event = false;
            float majorant = 0.0;
            for (int k = 0; k < 16; ++k) {
                float border;
                medium_segment(path, t, border, majorant);
                border = min(border, ray.t_max);
                float reach = t + depth / max(majorant, 1e-30);
                event = reach < border;
                depth -= event ? 0.0 : majorant * (border - t);
                t = event ? reach : border;
                gone = !event && t >= ray.t_max;
                if (event || gone) break;
            }
            if (event) {
                look = medium_look(path.origin + t * path.direction);
                float part = clamp(look.a / majorant, 0.0, 1.0);
                depth = -log(1.0 - medium_number());
                float u = bounce == 0 && !asking && first_flight.y >= 0.0 ? first_flight.y : medium_number();
                first_flight.y = -1.0;
                if (asking) {
                    left *= 1.0 - part;
                    // Little light is either brought in fewer, stronger parts or not at all.
                    if (left < 0.25) {
                        left = u < 4.0 * left ? 0.25 : 0.0;
                        gone = left <= 0.0;
                    }
                } else {
                    collided = u < part;
                }
            }
            if (collided || gone) break;
        }
        bool again = false; // a ray begins at `from`, to `next`
        if (gone && asking) {
            sum += medium_limited(light * left, bounce > 1, how.limit);
            asking = false;
            ray.direction = next;
            ray.t_max = 1e30;
            again = true;
        }
        // The path happens to hit lights on its way; suns only where it leaves.
        if (!again && (gone || (collided && light_local)) && light_count > 0) {
            float end = gone && !(sliced && bounce == 0) ? 1e30 : t;
            vec3 met = bounce == 0 ? light_seen(ray.origin, ray.direction, end) : light_found(how.sampling, from, ray.direction, end);
            lamp = bounce == 0 && met != vec3(0.0);
            sum += medium_limited(through * met, bounce > 1, how.limit);
        }
        if (gone && !again) {
            // It leaves and meets the environment, or a slice.
            bool camera = bounce == 0;
            vec3 met = vec3(0.0);
            radiance.a = camera && environment_transparent && !lamp ? 0.0 : 1.0;
            if (!camera) {
                met = environment_found(how.sampling, from, ray.direction);
            } else if (sliced) {
                met = slice.color.rgb;
                radiance.a = 1.0;
                geometry = vec4(-ray.direction, slice.t);
                albedo = vec4(min(met, vec3(1.0)), 1.0);
            } else if (!environment_transparent) {
                met = environment_at(ray.direction);
            }
            sum += medium_limited(through * met, bounce > 1, how.limit);
            alive = false;
        }
        // A path whose last flight ends in the medium brings nothing more.
        alive = alive && !(collided && bounce >= how.bounces);
        if (collided && alive) {
            vec3 place = path.origin + t * path.direction;
            from.position = ray.origin + t * ray.direction;
            Medium m = medium_at(place, look);
            if (bounce == 0) {
                bool border = dot(m.normal, m.normal) > 0.0;
                geometry = vec4(border ? m.normal : -ray.direction, t);
                albedo = vec4(m.albedo, 1.0);
                radiance.a = 1.0;
            }
            sum += medium_limited(through * m.emission, bounce > 1, how.limit);
            through *= m.albedo;
            ++bounce;
            float survival = bounce > how.roulette ? min(max(through.r, max(through.g, through.b)), 1.0) : 1.0;
            bool ends = medium_number() >= survival || max(through.r, max(through.g, through.b)) <= 0.0;
            through /= max(survival, 1e-20);

            vec2 u_scatter = bounce == 1 ? first_scatter : vec2(medium_number(), medium_number());
            vec2 u_light = bounce == 1 ? first_light : vec2(medium_number(), medium_number());
            float u_choice = medium_number();
            // A border scatters as a surface, or as haze.
            bool surface = m.surface > 0.0 && medium_number() < m.surface;
            vec3 view = -ray.direction;
            vec3 normal = dot(m.normal, view) < 0.0 ? -m.normal : m.normal;
            Material material = Material(vec3(1.0), 0.5, 0.0, vec3(0.0));
            float gloss = 0.0;
            if (surface) {
                float behind = 1e-3 - dot(normal, view);
                if (behind > 0.0) view = normalize(view + behind * normal);
                gloss = brdf_gloss(how.brdf, material, normal, view);
            }
            // A light, by its chance.
            float part = 0.0;
            int chosen = -1;
            if (light_count > 0 || from.environment) chosen = light_choose(from, u_choice, part);
            light = vec3(0.0);
            vec3 towards = vec3(0.0);
            float distance = 0.0;
            if (chosen >= 0) {
                float density;
                bool sharp;
                LightSample asked = light_asked(chosen, from.position, u_light, density, sharp);
                towards = asked.direction;
                distance = asked.distance;
                float cosine = dot(ray.direction, towards);
                vec3 value = surface ? brdf_value(how.brdf, material, normal, view, towards) : vec3(phase_value(g, cosine));
                float own = surface ? brdf_pdf(how.brdf, gloss, material, normal, view, towards) : value.x;
                light = through * value * asked.irradiance * (light_asked_weight(how.sampling, part, density, sharp, own) / part);
            }
            // Where the path goes on.
            if (surface) {
                next = brdf_sample(how.brdf, gloss, material, normal, view, u_scatter, medium_number());
                from.pdf = brdf_pdf(how.brdf, gloss, material, normal, view, next);
                vec3 value = brdf_value(how.brdf, material, normal, view, next);
                through *= from.pdf > 0.0 ? value / from.pdf : vec3(0.0);
            } else {
                next = phase_sample(g, ray.direction, u_scatter);
                from.pdf = phase_value(g, dot(ray.direction, next));
            }
            asking = max(light.r, max(light.g, light.b)) > 0.0;
            ray.direction = asking ? towards : next;
            ray.t_max = asking ? distance : 1e30;
            left = 1.0;
            alive = !ends;
            again = true;
        }
        if (again && alive) {
            ray.origin = from.position;
            ray.t_min = 0.0;
            t = 0.0;
            inside = medium_enter(ray, path);
            depth = -log(1.0 - medium_number());
            // Light is still brought to the last collision; the path does not go further.
            alive = asking || (bounce < how.bounces || how.sampling != 1);
        }
        if (!alive) break;
    }
    bool finite = !any(isnan(sum)) && !any(isinf(sum));
    radiance.rgb = finite ? sum : vec3(0.0);
}
