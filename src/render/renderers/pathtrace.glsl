/// Global illumination: paths of light from the camera through any number of reflections. Unbiased but for the length of paths
/// and the size of the smallest feature; more samples bring less noise, as their square root.
/// Lights are not seen by the camera itself, only in reflections, but for `visible` rectangles; the environment is. Light that is
/// thrown from facet to facet of a rough metal is given back by a fit: a white one reflects 98.7 to 101 %. Kajiya (1986, "The Rendering Equation");
/// light is found by sampling the lights, the environment and the reflection model, weighted by the power heuristic (Veach &
/// Guibas 1995, "Optimally Combining Sampling Techniques").
#pragma apeiron needs surface
#pragma apeiron samples environment
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/light_choice.glsl"
#include "render/glsl/brdf.glsl"
#include "render/glsl/haze.glsl"

uniform int brdf;       //! ggx {lambert, phong, ggx} invalidates program | Reflection model
uniform int bounces;    //! 8 [1, 64] log | Most reflections of a path: 1 is direct light alone
uniform int roulette;   //! 3 [1, 64] log | Reflections after which dim paths may end by Russian roulette
uniform int sampling;   //! mis {mis, light, brdf} invalidates program | How light is found: by sampling both the lights and the reflection model, or one alone (more noise, the same mean)
uniform float limit;    //! 0 [0, 1000] log | Most radiance that one sample's indirect light may have, which removes fireflies and some light; 0: no limit
uniform bool regularise; //! false invalidates program | Blur mirrors that are seen by rough surfaces: less noise from caustics, and a little less truth
uniform bool haze;       //! false invalidates program | Air that light is scattered in, around everything
uniform float haze_density; //! 0.1 [0, 1e6] log | Its extinction per world unit (at the height haze_base, where it thins out)
uniform vec3 haze_color; //! (1, 1, 1) [0, 1] color | Its albedo: what is not scattered is absorbed
uniform float haze_anisotropy; //! 0.3 [-0.99, 0.99] | Mean cosine of its scattering: below 0 back, 0 to all sides, above 0 forwards (Henyey & Greenstein)
uniform float haze_height; //! 0 [0, 1e6] log | Height by which it becomes thinner by a factor of e; 0: it is the same everywhere, and hides what is infinitely far away
uniform float haze_base; //! 0 [-1e6, 1e6] | Height (z) at which it has haze_density

// Diameter per length of the cone that stands for a ray from a rough surface: what it meets need not be sharper than that.
const float cone = 0.005;

Haze air() { return Haze(haze_density, haze_base, haze_height); }

// Reflection of a surface, or scattering in the air.
vec3 scatter_value(bool drifting, Material m, vec3 n, vec3 v, vec3 l) {
    if (haze && drifting) return vec3(phase_value(haze_anisotropy, -dot(v, l)));
    return brdf_value(brdf, m, n, v, l);
}

float scatter_pdf(bool drifting, float gloss, Material m, vec3 n, vec3 v, vec3 l) {
    if (haze && drifting) return phase_value(haze_anisotropy, -dot(v, l));
    return brdf_pdf(brdf, gloss, m, n, v, l);
}

vec3 limited(vec3 light, bool indirect) {
    float most = max(light.r, max(light.g, light.b));
    return indirect && limit > 0.0 && most > limit ? light * (limit / most) : light;
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    float width = ray.width;
    LightOrigin from = LightOrigin(vec3(0.0), vec3(0.0), 0.0, -1.0, true);
    vec3 sum = vec3(0.0);
    vec3 through = vec3(1.0); // what is left of light that comes along the ray when it reaches the camera
    float smoothest = 0.0;
    radiance = vec4(0.0, 0.0, 0.0, 1.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    for (int bounce = 0; bounce <= bounces; ++bounce) {
        Hit hit;
        bool found = surface_trace(ray, hit);
        // The air may scatter the light before it meets a surface.
        bool drifting = false;
        if (haze) {
            float flight = haze_flight(air(), ray.origin, ray.direction, -log(1.0 - random_pair(pixel, 16u * uint(bounce + 1) + 2u).y));
            drifting = flight < (found ? hit.t : 1e29);
            if (drifting) {
                hit = Hit(flight, ray.origin + flight * ray.direction, ray.width + ray.spread * flight, 0.0);
                found = true;
            }
        }
        if (bounce > 0) {
            vec3 met = light_found(sampling, from, ray.direction, found ? hit.t : 1e30);
            if (!found) met += environment_found(sampling, from, ray.direction);
            sum += limited(through * met, bounce > 1);
        } else {
            if (!found) {
                radiance.a = environment_transparent ? 0.0 : 1.0;
                sum = radiance.a * environment_at(ray.direction);
            }
            vec3 lamps = light_seen(ray.origin, ray.direction, found ? hit.t : 1e30);
            if (lamps != vec3(0.0)) radiance.a = 1.0;
            sum += lamps;
        }
        if (!found) break;

        vec3 n = vec3(0.0);
        // (The air has no normal.)
        Material m = Material(haze_color, 1.0, 0.0, vec3(0.0));
        if (!drifting) {
            n = surface_normal(hit, ray.direction);
            m = surface_material(hit, n);
        }
        if (haze && drifting) through *= haze_color;
        if (bounce == 0) {
            geometry = vec4(drifting ? -ray.direction : n, hit.t);
            albedo = vec4(m.albedo, 1.0);
        }
        sum += limited(through * m.emission, bounce > 1);
        if (bounce == bounces) break;
        if (regularise) {
            m.roughness = max(m.roughness, smoothest);
            smoothest = max(smoothest, 0.7 * m.roughness);
        }
        // Normals of rough surfaces may point away from the eye, which reflection models do not know.
        vec3 v = -ray.direction;
        float behind = 1e-3 - dot(n, v);
        if (behind > 0.0 && !drifting) v = normalize(v + behind * n);
        float gloss = drifting ? 0.0 : brdf_gloss(brdf, m, n, v);
        uint dimension = 16u * uint(bounce + 1); // the camera has the first 16

        // What the camera sees is lit by all lights; further on, each light has its chance.
        int chosen = -1;
        float part = 1.0;
        from = LightOrigin(hit.position, n, 0.0, -1.0, true);
        if (bounce > 0) chosen = light_choose(from, random_pair(pixel, dimension + 2u).x, part);
        int first = bounce == 0 ? 0 : (chosen < 0 ? 1 : chosen);
        int last = bounce == 0 ? light_count : (chosen < 0 ? 0 : chosen);
        uint pair = dimension + 3u;
        for (int k = first; k <= last; ++k, ++pair) {
            float pdf;
            bool sharp;
            LightSample light = light_asked(k, hit.position, random_pair(pixel, pair), pdf, sharp);
            vec3 l = light.direction;
            float weight = light_asked_weight(sampling, part, pdf, sharp, scatter_pdf(drifting, gloss, m, n, v, l)) / part;
            vec3 arriving = light.irradiance * weight;
            if (haze) arriving *= exp(-haze_depth(air(), hit.position, l, light.distance));
            vec3 scattered = scatter_value(drifting, m, n, v, l) * arriving;
            bool dark = max(scattered.r, max(scattered.g, scattered.b)) <= 0.0;
            if (!dark && !surface_blocked(hit, drifting ? l : n, l, light.distance)) sum += limited(through * scattered, bounce > 0);
            if (k == last) break;
        }

        vec2 choice = random_pair(pixel, dimension + 1u);
        vec3 l;
        if (drifting) {
            l = phase_sample(haze_anisotropy, ray.direction, random_pair(pixel, dimension));
        } else {
            l = brdf_sample(brdf, gloss, m, n, v, random_pair(pixel, dimension), choice.x);
        }
        from.pdf = scatter_pdf(drifting, gloss, m, n, v, l);
        vec3 value = scatter_value(drifting, m, n, v, l);
        if (from.pdf <= 0.0 || max(value.r, max(value.g, value.b)) <= 0.0) break;
        through *= value / from.pdf;
        if (bounce + 1 >= roulette) {
            float survival = min(max(through.r, max(through.g, through.b)), 0.95);
            if (choice.y >= survival) break;
            through /= survival;
        }
        width += ray.spread * hit.t;
        float spread = max(ray.spread, choice.x < gloss ? cone * brdf_alpha(m) : cone);
        // Half of the width, as surface_blocked() has it: both ways to find light then meet the same surface.
        ray = Ray(drifting ? hit.position : surface_leave(hit, n), l, 0.0, 1e30, 0.5 * width, spread);
    }
    bool finite = !any(isnan(sum)) && !any(isinf(sum));
    radiance.rgb = finite ? sum : vec3(0.0);
}
