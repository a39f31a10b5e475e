/// Smooths what is only noise: a spatial filter that is guided by how uncertain each pixel is, over an edge-stopping À-trous wavelet
/// (Dammertz et al. 2010; Schied et al. 2017, eq. 3 to 5). The more samples there are, the less it does, so that the converged
/// picture stays what it is. Never turn it on for measurements.
#pragma apeiron invalidates present
#pragma apeiron passes 7
#include "post/effect.glsl"

uniform float strength; //! 1 [0, 4] | How far values may differ and still be mixed, in parts of what their uncertainty explains
uniform float normals;  //! 32 [0, 256] log | How little normals may differ: the power of their cosine
uniform float depths;   //! 1 [0.05, 20] log | How far distances may differ, in parts of a slope of 45 degrees per pixel
uniform bool textures;  //! true | Surfaces' colours are left out of the smoothing: turn it off where they are noisy themselves

const vec3 luminance_weights = vec3(0.2126, 0.7152, 0.0722);

float luminance(vec3 c) { return dot(c, luminance_weights); }

ivec2 inside(ivec2 p) { return clamp(p, ivec2(0), effect_size - 1); }

// What the light of a pixel is divided by while it is smoothed.
vec3 texture_of(ivec2 p) {
    vec4 albedo = texelFetch(effect_albedo, p, 0);
    return textures ? mix(vec3(1.0), max(albedo.rgb, 0.02), clamp(albedo.w, 0.0, 1.0)) : vec3(1.0);
}

// How much two pixels show the same surface, 0 to 1; both show background: 1.
float alike(ivec2 p, ivec2 q, vec4 here, float hit, float reach) {
    vec4 there = texelFetch(effect_geometry, q, 0);
    float hit_there = texelFetch(effect_albedo, q, 0).w;
    float both = 1.0 - min(1.0, 4.0 * abs(hit - hit_there));
    if (hit < 0.05 && hit_there < 0.05) return 1.0;
    float pixel_size = (effect_orthographic ? 1.0 : here.w) / effect_scale;
    float apart = abs(there.w - here.w) / (depths * pixel_size * (reach + 1.0) + 1e-20);
    // (Media have no normals: there, distances and values alone decide.)
    float turned = dot(here.xyz, here.xyz) > 0.5 && dot(there.xyz, there.xyz) > 0.5 ? max(dot(here.xyz, there.xyz), 0.0) : 1.0;
    return both * pow(max(turned, 1e-6), normals) * exp(-min(apart, 60.0));
}

// The light without textures, and the variance of its luminance: of the samples where there are several, of the neighbours else.
vec4 begin(ivec2 pixel) {
    vec3 light = texelFetch(effect_input, pixel, 0).rgb / texture_of(pixel);
    vec4 here = texelFetch(effect_geometry, pixel, 0);
    float hit = texelFetch(effect_albedo, pixel, 0).w;
    float sum = 0.0;
    float squares = 0.0;
    float weight = 0.0;
    for (int i = 0; i < 49 && effect_pass == 0; ++i) {
        ivec2 step = ivec2(i - 7 * int((float(i) + 0.5) / 7.0), int((float(i) + 0.5) / 7.0)) - 3;
        ivec2 q = inside(pixel + step);
        float w = alike(pixel, q, here, hit, length(vec2(step)));
        float l = luminance(texelFetch(effect_input, q, 0).rgb / texture_of(q));
        sum += w * l;
        squares += w * l * l;
        weight += w;
    }
    float mean = sum / max(weight, 1e-6);
    float spatial = max(squares / max(weight, 1e-6) - mean * mean, 0.0);
    float count = texelFetch(effect_mean, pixel, 0).w;
    vec3 spread = texelFetch(effect_spread, pixel, 0).rgb / (texture_of(pixel) * texture_of(pixel));
    // Channels of one sample vary together: deviations add, not variances.
    float deviation = dot(luminance_weights, sqrt(max(spread, 0.0)));
    float temporal = deviation * deviation / max(count * (count - 1.0), 1.0);
    // Few samples tell little about their variance; neighbours hold what is texture too, which many samples tell from noise.
    float known = clamp((count - 1.0) / 15.0, 0.0, 1.0);
    return vec4(light, count < 1.5 ? spatial : mix(min(spatial, temporal * 4.0 + 0.25 * spatial), temporal, known));
}

// The variance around a pixel: one alone is too noisy a judge.
float variance_around(ivec2 pixel) {
    float sum = 0.0;
    for (int i = 0; i < 9; ++i) {
        ivec2 step = ivec2(i - 3 * int((float(i) + 0.5) / 3.0), int((float(i) + 0.5) / 3.0)) - 1;
        float w = (step.x == 0 ? 0.5 : 0.25) * (step.y == 0 ? 0.5 : 0.25);
        sum += w * effect_at(pixel + step).w;
    }
    return sum;
}

vec4 smoothed(ivec2 pixel, int reach) {
    vec4 own = effect_at(pixel);
    vec4 here = texelFetch(effect_geometry, pixel, 0);
    float hit = texelFetch(effect_albedo, pixel, 0).w;
    float bright = luminance(own.rgb);
    float tolerance = 4.0 * strength * sqrt(max(variance_around(pixel), 0.0)) + 1e-10;
    vec3 sum = own.rgb * 0.140625; // (3/8)²
    float variance = own.w * 0.140625 * 0.140625;
    float weight = 0.140625;
    for (int i = 0; i < 25 && effect_pass > 0 && effect_pass < 6; ++i) {
        int row = int((float(i) + 0.5) / 5.0);
        ivec2 step = ivec2(i - 5 * row, row) - 2;
        ivec2 q = pixel + reach * step;
        if (step == ivec2(0) || q != inside(q)) continue;
        vec4 there = effect_at(q);
        vec2 spline = vec2(step.x == 0 ? 0.375 : (abs(step.x) == 1 ? 0.25 : 0.0625),
                           step.y == 0 ? 0.375 : (abs(step.y) == 1 ? 0.25 : 0.0625));
        float w = spline.x * spline.y * alike(pixel, q, here, hit, float(reach) * length(vec2(step))) *
                  exp(-min(abs(luminance(there.rgb) - bright) / tolerance, 60.0));
        sum += w * there.rgb;
        variance += w * w * there.w;
        weight += w;
    }
    return vec4(sum / weight, variance / (weight * weight));
}

void kernel_main(ivec2 pixel, out vec4 color) {
    color = vec4(0.0);
    // (Rasterisers on the CPU compute all of it: the loops know what pass it is, too.)
    if (effect_pass == 0) color = begin(pixel);
    if (effect_pass > 0 && effect_pass < 6) color = smoothed(pixel, 1 << (effect_pass - 1));
    if (effect_pass == 6)
        color = vec4(effect_at(pixel).rgb * texture_of(pixel), texelFetch(effect_input, pixel, 0).a);
}
