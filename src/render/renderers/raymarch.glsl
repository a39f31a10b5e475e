/// Direct light on surfaces: sphere-traced or otherwise found, lit by the scene's lights and environment.
/// Each sample is complete by itself, so the first picture is already smooth; more samples bring anti-aliasing, and
/// exact soft shadows and sky light where these are set to `sampled`.
#pragma apeiron needs surface
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/brdf.glsl"

uniform int brdf;              //! ggx {lambert, phong, ggx} invalidates program | Reflection model
uniform int shadow;            //! penumbra {none, hard, penumbra, sampled} invalidates program | Shadows: one hard ray, a smooth estimate from one ray (somewhat larger than the exact shadow), or exact by sampling the light's disc
uniform int ambient_occlusion; //! field {none, field, sampled} invalidates program | Occlusion of the environment's light: none, estimated from the distance field, or exact by one ray a sample
uniform float sky_light;       //! 1 [0, 4] | Strength of the environment's light on surfaces

vec3 lit(ivec2 pixel, Hit hit, Material m, vec3 n, vec3 v) {
    vec3 sum = m.emission;
    for (int i = 0; i < light_count; ++i) {
        LightSample light = light_at(i, hit.position);
        if (shadow == 3) light = light_sample(light, random_pair(pixel, 8u + uint(i)));
        vec3 l = light.direction;
        vec3 f = brdf_value(brdf, m, n, v, l) * light.irradiance;
        if (max(f.r, max(f.g, f.b)) <= 0.0) continue;
        if (shadow == 1) f *= surface_visibility(hit, n, l, light.distance, 0.0);
        if (shadow == 2) f *= surface_visibility(hit, n, l, light.distance, light.spread);
        if (shadow == 3 && surface_blocked(hit, n, l, light.distance)) f = vec3(0.0);
        sum += f;
    }
    if (sky_light <= 0.0) return sum;
    vec3 gloss = brdf == 0 ? vec3(0.0) : brdf_environment(m, n, v);
    // What the surface reflects does not reach what is below it.
    vec3 diffuse = m.albedo * (brdf == 0 ? vec3(1.0) : (1.0 - m.metalness) * (1.0 - gloss));
    vec3 mirror = reflect(-v, n);
    vec3 towards = normalize(mix(mirror, n, m.roughness * m.roughness));
    float open = 1.0;
    if (ambient_occlusion == 2) {
        // One direction in proportion to the cosine: its radiance is the irradiance's unbiased estimate over pi.
        vec2 u = random_pair(pixel, 1u);
        float z = 2.0 * u.x - 1.0;
        float r = sqrt(max(1.0 - z * z, 0.0));
        vec3 l = normalize(n * 1.0001 + vec3(r * cos(6.283185307 * u.y), r * sin(6.283185307 * u.y), z));
        bool blocked = surface_blocked(hit, n, l, 1e30);
        vec3 sky = blocked ? vec3(0.0) : environment_at(l);
        return sum + sky_light * (diffuse * sky + (blocked ? vec3(0.0) : gloss * environment_at(towards)));
    }
    if (ambient_occlusion == 1) open = surface_openness(hit, n);
    return sum + (sky_light * open) *
                     (diffuse * environment_irradiance(n) * 0.318309886 + gloss * environment_at(towards));
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_ray(vec2(pixel) + 0.5 + camera_jitter(pixel));
    Hit hit;
    if (!surface_trace(ray, hit)) {
        float alpha = environment_transparent ? 0.0 : 1.0;
        radiance = vec4(alpha * environment_at(ray.direction), alpha);
        geometry = vec4(0.0);
        albedo = vec4(0.0);
        return;
    }
    vec3 n = surface_normal(hit, ray.direction);
    Material m = surface_material(hit, n);
    radiance = vec4(lit(pixel, hit, m, n, -ray.direction), 1.0);
    geometry = vec4(n, hit.t);
    albedo = vec4(m.albedo, 1.0);
}
