#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/field.glsl"

// Emission and absorption along a ray: what eam and lao share.

struct FieldLook {
    float step;       // distance of the places that are looked at, in voxels
    float shading;    // part of the light that depends on the gradient
    float specular;   // strength of the highlights
    float shininess;  // their exponent
    float sky_light;  // strength of the environment's light
    int rays;         // that look how open a place is; 0: it counts as open
    float reach;      // how far they look, in voxels
    bool shadows;     // the lights' rays look as well
    float group;      // neighbouring places that are seen as much as this together are lit as one of them; 1: all of the ray
};

// What a short way lets through, in a few steps that grow with the distance.
float field_open(vec3 position, vec3 direction, float reach, float jitter) {
    const int steps = 6;
    float through = 0.0;
    float before = 0.0;
    for (int i = 0; i < steps; ++i) {
        float end = float((i + 1) * (i + 1)) / float(steps * steps);
        float t = reach * mix(before, end, jitter);
        through += field_color(position + t * direction).a * (reach * (end - before));
        before = end;
    }
    return exp(-through);
}

vec3 field_random_direction(vec2 u) {
    float z = 2.0 * u.x - 1.0;
    float r = sqrt(max(1.0 - z * z, 0.0));
    return vec3(r * cos(6.283185307 * u.y), r * sin(6.283185307 * u.y), z);
}

// The light that a place of the field reflects towards the viewer.
vec3 field_lit(FieldLook look, ivec2 pixel, uint place, vec3 position, vec3 color, vec3 view) {
    vec3 gradient = field_gradient(position);
    float steepness = length(gradient);
    // Without a gradient there is no side: such places are lit from everywhere alike.
    float formed = look.shading * smoothstep(0.0, 0.02, steepness * field_spacing());
    vec3 n = steepness > 0.0 ? -gradient / steepness : view;
    float reach = look.reach * field_spacing();
    vec3 start = position + (0.75 * field_spacing()) * n;
    float open = 1.0;
    for (int k = 0; k < look.rays; ++k) {
        vec2 u = fract(random_pair(pixel, 17u + uint(k)) + float(place) * vec2(0.754877666, 0.569840291));
        vec3 direction = normalize(formed * n * 1.001 + field_random_direction(u));
        float part = field_open(start, direction, reach, fract(u.x * 97.0)) / float(look.rays);
        open = k == 0 ? part : open + part;
    }
    vec3 sum = look.sky_light * open * mix(environment_irradiance(view), environment_irradiance(n), formed) * color;
    for (int i = 0; i < light_count; ++i) {
        // Points of a rectangle: each place along the ray has another one (a lattice: Roberts 2018, "The Unreasonable Effectiveness of
        // Quasirandom Sequences").
        vec2 u = vec2(0.0);
        if (light_flat(i))
            u = fract(random_pair(pixel, 64u + uint(i)) + float(place) * vec2(0.754877666, 0.569840291));
        LightSample light = light_shading(i, position, u);
        float cosine = mix(0.5, max(dot(n, light.direction), 0.0), formed);
        float highlight = pow(max(dot(n, normalize(light.direction + view)), 0.0), look.shininess) * look.specular * formed;
        float lit = 1.0;
        if (look.shadows && cosine > 0.0)
            lit = field_open(start, light.direction, 2.0 * reach, random_pair(pixel, 16u).y);
        sum += lit * light.irradiance * (color * cosine + highlight * float(dot(n, light.direction) > 0.0));
    }
    return sum * 0.318309886;
}

void field_march(FieldLook look, ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    vec3 sum = vec3(0.0);
    vec3 colors = vec3(0.0);
    float through = 1.0;
    float depth = 0.0;
    bool inside = field_clip(ray);
    // Steps as wide as voxels; where these are smaller than the pixel, as the pixel: samples begin anywhere in it.
    float footprint = ray.width + ray.spread * max(ray.t_min, 0.0);
    float stride = max(look.step * max(field_spacing(), footprint), (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    float t_end = t;
    float sliced = 0.0; // how much of the picture is slices ...
    float t_sliced = 0.0;
    Slice slice = Slice(1e30, vec4(0.0));
    if (inside) slice = slice_next(ray, slice_start(ray));
    // Places in a row are lit as one of them, drawn by how much of it is seen: where as much is seen as a number says, which samples
    // choose evenly; where so much never is, by reservoir sampling (Chao 1982). Either way the chances are the same.
    float looked = 0.0; // how much of the picture they are
    float t_one = 0.0;
    vec4 one = vec4(0.0);
    vec2 choice = random_pair(pixel, 15u);
    uint place = 0u;
    bool ended = false;
    int brick = 0;
    for (int group = 0; group < (inside ? 8192 : 0); ++group) {
        // To where a group is complete: what comes after this is long, and processors without a GPU do it for all of a few neighbours
        // as soon as one of them has to.
        bool full = false;
        for (; brick < 32768; ++brick) {
            bool something = false;
            float limit = min(slice.t, ray.t_max);
            if (t < limit && t >= t_end) {
                something = field_segment(ray, t, t_end);
                // To the next place that is looked at, however much was stepped over.
                t += something ? 0.0 : ceil(max(t_end - t, 0.0) / stride) * stride;
            }
            something = t < min(limit, t_end);
            for (int n = 0; n < (something ? 8192 : 0); ++n) {
                vec4 seen = field_color(ray.origin + t * ray.direction);
                float part = through * (1.0 - exp(-seen.a * stride));
                full = looked > 0.0 && look.group < 1.0 && looked + part > look.group;
                if (!full) {
                    bool settled = choice.x * look.group < looked;
                    looked += part;
                    float chance = part / max(looked, 1e-20);
                    bool drawn = choice.y < chance;
                    bool chosen = !settled && (drawn || choice.x * look.group < looked);
                    // What is left of the random number is as good as a new one.
                    choice.y = min(drawn ? choice.y / max(chance, 1e-20) : (choice.y - chance) / max(1.0 - chance, 1e-20), 0.9999999);
                    one = chosen ? seen : one;
                    t_one = chosen ? t : t_one;
                    colors += part * seen.rgb;
                    depth += part * t;
                    through -= part;
                    t += stride;
                }
                if (t >= min(limit, t_end) || full || through <= 2e-3) break;
            }
            // A slice comes before the place that is looked at next.
            if (!full && through > 2e-3 && slice.t < 1e30 && (slice.t <= t || t >= ray.t_max)) {
                float part = through * slice.color.a;
                sum += part * slice.color.rgb;
                colors += part * slice.color.rgb;
                depth += part * slice.t;
                t_sliced = part > 0.0 && sliced == 0.0 ? slice.t : t_sliced;
                sliced += part;
                through -= part;
                slice = slice_next(ray, slice.t);
            }
            ended = through <= 2e-3 || (t >= ray.t_max && slice.t >= 1e30);
            if (full || ended) break;
        }
        ended = ended || brick >= 32768;
        if (looked > 0.0 && (full || ended)) {
            vec3 position = ray.origin + t_one * ray.direction;
            sum += looked * (field_lit(look, pixel, place, position, one.rgb, -ray.direction) + field_emission(position, one));
            looked = 0.0;
            ++place;
        }
        if (ended) break;
    }
    float cover = 1.0 - through;
    vec3 behind = environment_transparent ? vec3(0.0) : environment_at(ray.direction);
    radiance = vec4(sum + through * behind, environment_transparent ? cover : 1.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    if (cover > 0.01) {
        // Most of it is a slice: that is what is seen there.
        geometry = vec4(-ray.direction, sliced > 0.5 * cover ? t_sliced : depth / cover);
        albedo = vec4(colors / cover, 1.0);
    }
}
