#include "render/glsl/environment.glsl"
#include "render/glsl/environment_distribution.glsl"

// How paths find light, on surfaces and in media alike: one of the lights (light_count: the environment) is drawn in proportion to
// what it brings, and what rays meet by chance is weighed against that by the power heuristic (Veach & Guibas 1995).
// `sampling` is 0 both, 1 lights alone, 2 scattering alone.

// What a ray that leaves a place must know of it to weigh the light that it meets.
struct LightOrigin {
    vec3 position;
    vec3 normal;      // 0: in a medium, where light is welcome from everywhere
    float pdf;        // of the ray's direction by scattering
    float chances;    // sum over all lights; negative: all of them were asked
    bool environment; // it is among them
};

float light_heuristic(float own, float other) {
    float ratio = other / max(own, 1e-20);
    return 1.0 / (1.0 + ratio * ratio);
}

// How much of the samples a light deserves: about the irradiance, and never 0 where there is some.
float light_chance(int k, LightOrigin from) {
    if (k == light_count) return from.environment ? 3.0 * 3.141592654 * environment_mean() : 0.0;
    LightSample light = light_at(k, from.position);
    if (from.normal == vec3(0.0)) return dot(light.irradiance, vec3(1.0)) * 0.25;
    return dot(light.irradiance, vec3(1.0)) * clamp(dot(from.normal, light.direction) + light.spread, 0.0, 1.0);
}

// The part of the samples that were light k's.
float light_part(int k, LightOrigin from) {
    return from.chances < 0.0 ? 1.0 : light_chance(k, from) / max(from.chances, 1e-30);
}

// A light by its chance, for u in [0, 1), or -1 where there is none; sets `from.chances`.
int light_choose(inout LightOrigin from, float u, out float part) {
    int chosen = -1;
    float chance = 0.0;
    from.chances = 0.0;
    for (int k = 0; k <= light_count; ++k) {
        float weight = light_chance(k, from);
        from.chances += weight;
        if (weight <= 0.0) continue;
        // A reservoir of one (Chao 1982): the number is used up step by step.
        float p = weight / from.chances;
        if (u < p) {
            chosen = k;
            chance = weight;
            u /= p;
        } else {
            u = (u - p) / (1.0 - p);
        }
    }
    part = chance / max(from.chances, 1e-30);
    return chosen;
}

// One direction of light k, or of the environment.
LightSample light_asked(int k, vec3 position, vec2 u, out float pdf, out bool sharp) {
    if (k == light_count) {
        sharp = false;
        vec3 direction = environment_sample(u, pdf);
        return LightSample(direction, 1e30, 0.0, environment_at(direction) / pdf);
    }
    return light_drawn(k, position, u, pdf, sharp);
}

// Weight of what light_asked() gives, whose direction scattering would draw with probability `own`.
float light_asked_weight(int sampling, float part, float pdf, bool sharp, float own) {
    if (sharp || sampling == 1) return 1.0;
    return sampling == 2 ? 0.0 : light_heuristic(part * pdf, own);
}

// Light of lights nearer than `end` that a ray meets by chance.
vec3 light_found(int sampling, LightOrigin from, vec3 direction, float end) {
    vec3 sum = vec3(0.0);
    if (sampling == 1) return sum;
    for (int k = 0; k < light_count; ++k) {
        float distance;
        float pdf;
        vec3 seen = light_met(k, from.position, direction, distance, pdf);
        if (seen == vec3(0.0) || distance >= end) continue;
        sum += seen * (sampling == 2 ? 1.0 : light_heuristic(from.pdf, light_part(k, from) * pdf));
    }
    return sum;
}

// Light of the environment that a ray meets by chance.
vec3 environment_found(int sampling, LightOrigin from, vec3 direction) {
    if (sampling == 1) return vec3(0.0);
    float weight = 1.0;
    if (sampling == 0 && from.environment)
        weight = light_heuristic(from.pdf, light_part(light_count, from) * environment_pdf(direction));
    return weight * environment_at(direction);
}
