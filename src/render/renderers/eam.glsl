/// Emission and absorption: the volume glows in its colours and hides what is behind, shaded by its gradient; without shadows, so that
/// each sample is complete by itself. How bright it is does not depend on the step.
/// Max (1995, "Optical Models for Direct Volume Rendering"); Levoy (1988, "Display of Surfaces from Volume Data").
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/camera.glsl"
#include "render/glsl/environment.glsl"
#include "render/glsl/field.glsl"

uniform float step;      //! 0.5 [0.05, 4] log | Distance of the places that are looked at, in voxels
uniform float shading;   //! 1 [0, 1] step 0.05 | Part of the light that depends on the gradient: 0 shows the colours as they are
uniform float specular;  //! 0.3 [0, 2] step 0.05 | Strength of the highlights
uniform float shininess; //! 30 [1, 500] log | Exponent of the highlights (Blinn 1977)
uniform float sky_light; //! 1 [0, 4] | Strength of the environment's light

// The light that a place of the volume sends towards the viewer.
vec3 shaded(vec3 position, vec3 color, vec3 view) {
    vec3 gradient = field_gradient(position);
    float steepness = length(gradient);
    // Without a gradient there is no side: such places are lit from everywhere alike.
    float formed = shading * smoothstep(0.0, 0.02, steepness * field_spacing());
    vec3 n = steepness > 0.0 ? -gradient / steepness : view;
    vec3 sum = sky_light * mix(environment_irradiance(view), environment_irradiance(n), formed) * color;
    for (int i = 0; i < light_count; ++i) {
        LightSample light = light_at(i, position);
        float cosine = mix(0.5, max(dot(n, light.direction), 0.0), formed);
        float highlight = pow(max(dot(n, normalize(light.direction + view)), 0.0), shininess) * specular * formed;
        sum += light.irradiance * (color * cosine + highlight * float(dot(n, light.direction) > 0.0));
    }
    return sum * 0.318309886;
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    Ray ray = camera_sample(pixel);
    vec3 sum = vec3(0.0);
    vec3 colors = vec3(0.0);
    float through = 1.0;
    float depth = 0.0;
    bool inside = field_clip(ray);
    float stride = max(step * field_spacing(), (ray.t_max - ray.t_min) / 8000.0);
    float t = ray.t_min + stride * random_pair(pixel, 16u).x;
    float t_end = t;
    for (int i = 0; i < 8192 && inside && t < ray.t_max && through > 2e-3; ++i) {
        bool something = true;
        for (int k = 0; k < 8 && t >= t_end; ++k) {
            something = field_segment(ray, t, t_end);
            // To the next place that is looked at, however much was stepped over.
            if (!something) t += ceil(max(t_end - t, 0.0) / stride) * stride;
        }
        if (!something || t >= ray.t_max) continue;
        vec3 position = ray.origin + t * ray.direction;
        vec4 seen = field_color(position);
        float part = through * (1.0 - exp(-seen.a * stride));
        for (int k = 0; k < int(part > 1e-4); ++k) {
            sum += part * (shaded(position, seen.rgb, -ray.direction) + field_emission(position, seen));
            colors += part * seen.rgb;
            depth += part * t;
            through -= part;
        }
        t += stride;
    }
    float cover = 1.0 - through;
    vec3 behind = environment_transparent ? vec3(0.0) : environment_at(ray.direction);
    radiance = vec4(sum + through * behind, environment_transparent ? cover : 1.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    if (cover > 0.01) {
        geometry = vec4(-ray.direction, depth / cover);
        albedo = vec4(colors / cover, 1.0);
    }
}
