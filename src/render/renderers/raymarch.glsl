/// Direct light on surfaces: sphere-traced or otherwise found, lit by the scene's lights and environment.
/// Each sample is complete by itself, so the first picture is already smooth; more samples bring anti-aliasing, and
/// exact soft shadows and sky light where these are set to `sampled`. Light of rectangles is always sampled.
#pragma apeiron needs surface
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/brdf.glsl"

uniform int brdf;              //! ggx {lambert, phong, ggx} invalidates program | Reflection model
uniform int shadow;            //! penumbra {none, hard, penumbra, sampled} invalidates program | Shadows: one hard ray, a smooth estimate from one ray (somewhat larger than the exact shadow), or exact by sampling the light's disc
uniform int ambient_occlusion; //! field {none, field, sampled, steps} invalidates program | Occlusion of the environment's light: none, estimated from the distance field, exact by rays, or for free from the steps that the camera ray took
uniform int occlusion_rays;    //! 1 [1, 64] log | Rays a sample where occlusion is sampled: more are smoother at once, fewer are faster to the same end
uniform float occlusion_strength; //! 1 [0, 8] step 0.05 | Power of the occlusion where it is estimated: 0 none, 1 as it is
uniform float sky_light;       //! 1 [0, 4] | Strength of the environment's light on surfaces
uniform float fog;             //! 0 [0, 100] log | Density of the fog: what is seen through it falls as exp(-density distance^0.75)
uniform int fog_falloff;       //! power {power, logarithm} invalidates program | How the fog grows with distance: as its power 0.75, or as the square of its logarithm, so that each doubling of the distance counts about alike, as it should where a picture reaches over many octaves
uniform int fog_light;         //! environment {environment, color} invalidates program | What the fog shows: the environment behind it, or a colour of its own that hides the environment, too
uniform vec3 fog_color;        //! (0.55, 0.62, 0.70) [0, 100] color | Radiance of fog with a colour of its own
uniform bool glow;             //! false invalidates program | A shining haze around the surface
uniform float glow_strength;   //! 0.1 [0, 100] log | Radiance of a ray that passes through a depth of glow_reach right at the surface
uniform float glow_reach;      //! 0.05 [1e-6, 10] log | Distance from the surface at which the glow has fallen to 1/e
uniform vec3 glow_color;       //! (1, 0.55, 0.2) [0, 1] color | Colour of the glow

vec3 lit(ivec2 pixel, Hit hit, Material m, vec3 n, vec3 v) {
    vec3 sum = m.emission;
    for (int i = 0; i < light_count; ++i) {
        // Rectangles are always sampled.
        bool sampled = shadow == 3 || light_flat(i);
        float pdf;
        bool sharp;
        LightSample light = light_at(i, hit.position);
        if (sampled) light = light_drawn(i, hit.position, random_pair(pixel, 8u + uint(i)), pdf, sharp);
        vec3 l = light.direction;
        vec3 f = brdf_value(brdf, m, n, v, l) * light.irradiance;
        if (max(f.r, max(f.g, f.b)) <= 0.0) continue;
        if (shadow == 2 && !sampled) f *= surface_visibility(hit, n, l, light.distance, light.spread);
        if ((shadow == 1 || (shadow != 0 && sampled)) && surface_blocked(hit, n, l, light.distance)) f = vec3(0.0);
        sum += f;
    }
    if (sky_light <= 0.0) return sum;
    vec3 gloss = brdf == 0 ? vec3(0.0) : brdf_environment(m, n, v);
    // What the surface reflects does not reach what is below it.
    vec3 diffuse = m.albedo * (brdf == 0 ? vec3(1.0) : (1.0 - m.metalness) * (1.0 - gloss));
    vec3 mirror = reflect(-v, n);
    vec3 towards = normalize(mix(mirror, n, m.roughness * m.roughness));
    if (ambient_occlusion == 2) {
        // Directions in proportion to the cosine, so that the mean of their radiance is the irradiance over pi: the normal and a
        // point of the unit sphere. Those are a rank-1 lattice by the golden ratio, shifted by the sample's pair of random
        // numbers (Cranley & Patterson 1976): heights in order, each a golden angle around from the one before.
        vec2 u = random_pair(pixel, 1u);
        vec2 turn = vec2(cos(6.283185307 * u.y), sin(6.283185307 * u.y));
        vec3 sky = vec3(0.0);
        float open_rays = 0.0;
        // All rays in one loop: a pixel goes on to its next ray while its neighbours are still busy with theirs.
        March march = surface_march(hit, n);
        int state = march_on;
        int begun = 0;
        for (bool more = true; more;) {
            // (Nearly always one of eight neighbours has a new ray to begin: nothing is gained by skipping this.)
            if (begun == 0 || state != march_on) {
                float open = state == march_free ? 1.0 : 0.0;
                sky += open * environment_at(march.direction);
                open_rays += open;
                more = begun < occlusion_rays;
                float z = 2.0 * fract(u.x + float(begun) / float(occlusion_rays)) - 1.0;
                vec3 l = n * 1.0001 + vec3(sqrt(max(1.0 - z * z, 0.0)) * turn, z);
                // After the last ray the others of the group go on alone.
                surface_march_to(march, normalize(l), more ? 1e30 : 0.0);
                turn = vec2(-0.737368878 * turn.x + 0.675490294 * turn.y, -0.675490294 * turn.x - 0.737368878 * turn.y);
                ++begun;
            }
            state = surface_march_on(march);
        }
        float rays = float(occlusion_rays);
        return sum + sky_light * (diffuse * sky / rays + gloss * environment_at(towards) * (open_rays / rays));
    }
    float open = 1.0;
    if (ambient_occlusion == 1) open = surface_openness(hit, n);
    // What is hard to reach for a ray is hard to reach for light.
    if (ambient_occlusion == 3) open = exp(-8.0 * hit.effort);
    if (ambient_occlusion != 0 && occlusion_strength != 1.0) open = pow(max(open, 1e-6), occlusion_strength);
    return sum + (sky_light * open) *
                     (diffuse * environment_irradiance(n) * 0.318309886 + gloss * environment_at(towards));
}

// The integral of exp(-distance / reach) along the ray up to `t_end`, in units of the reach: the light of a haze around the
// surface that absorbs nothing. Between two points of the march the distance is taken as linear, for which the integral is exact.
float glow_depth(Ray ray, float t_end) {
    float t = ray.t_min;
    float d = surface_distance(ray.origin + t * ray.direction) / glow_reach;
    float sum = 0.0;
    for (int i = 0; i < 160 && t < t_end; ++i) {
        // Spheres where the surface is far away; short steps where the haze is.
        float next = min(t + glow_reach * max(max(d - 4.0, 0.3 * d), 0.25), t_end);
        float e = max(surface_distance(ray.origin + next * ray.direction), 0.0) / glow_reach;
        float slope = e - d;
        float mean = abs(slope) < 1e-2 ? exp(-0.5 * (d + e)) : (exp(-d) - exp(-e)) / slope;
        sum += mean * (next - t) / glow_reach;
        t = next;
        d = e;
        // Beyond this distance from the camera nothing can come near any more that would be seen.
        if (d > 1e4) break;
    }
    return sum;
}

// What the air between the camera and `depth` does to the light from there.
vec3 air(vec3 radiance, Ray ray, float depth) {
    if (fog > 0.0) {
        vec3 light = fog_light == 0 ? environment_at(ray.direction) : fog_color;
        float octaves = log2(1.0 + depth);
        float thickness = fog_falloff == 0 ? pow(depth, 0.75) : octaves * octaves;
        radiance = mix(light, radiance, exp(-fog * thickness));
    }
    return radiance;
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    // What counts steps or the way through the haze looks at the whole ray, not only at what the prepass leaves of it.
    if (glow || ambient_occlusion == 3) ray.t_min = 0.0;
    Hit hit;
    bool found = surface_trace(ray, hit);
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    if (found) {
        vec3 n = surface_normal(hit, ray.direction);
        Material m = surface_material(hit, n);
        radiance = vec4(air(lit(pixel, hit, m, n, -ray.direction), ray, hit.t), 1.0);
        geometry = vec4(n, hit.t);
        albedo = vec4(m.albedo, 1.0);
    } else if (!environment_transparent) {
        radiance = vec4(air(environment_at(ray.direction), ray, 1e30), 1.0);
    }
    vec3 lamps = light_seen(ray.origin, ray.direction, found ? hit.t : 1e30);
    if (lamps != vec3(0.0)) radiance = vec4(radiance.rgb + lamps, 1.0);
    if (glow) radiance.rgb += glow_color * (glow_strength * glow_depth(ray, found ? hit.t : 1e30));
}
