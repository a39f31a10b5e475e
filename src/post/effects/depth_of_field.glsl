/// Blurs what is out of focus by its circle of confusion, as a lens would, from the finished picture: fast, and movable without
/// a new sample. Each pixel gathers what spreads over it (Potmesil & Chakravarty 1981, turned around), near light over far light.
/// What a lens would see behind an edge is not in the picture: for that, set the camera's aperture instead.
#pragma apeiron invalidates present
#include "post/effect.glsl"

uniform float aperture; //! 0.06 [0, 1] step 0.005 | Diameter of the lens in units of the focal distance
uniform float focus;    //! 0 [0, 1e6] log | Distance of the plane that is sharp; 0: the camera's
uniform int blades;     //! 0 [0, 16] | Blades of the lens' iris; fewer than 3: round
uniform float largest;  //! 0.03 [0.001, 0.2] log | Radius of the largest blur, relative to the picture's height
uniform int taps;       //! 256 [16, 4096] log | Looks around each pixel: more are smoother and slower

// Radius of the circle of confusion [px], negative in front of the plane of focus.
float confusion(ivec2 pixel) {
    ivec2 p = clamp(pixel, ivec2(0), effect_size - 1);
    float plane = focus > 0.0 ? focus : effect_focus;
    float scale = 0.5 * aperture * effect_scale; // [px] at the distance of the plane of focus, or of 1 in parallel projection
    float limit = largest * float(effect_size.y);
    bool hit = texelFetch(effect_albedo, p, 0).w > 0.0;
    if (effect_orthographic) {
        if (!hit) return limit;
        return clamp(scale * (texelFetch(effect_geometry, p, 0).w - plane), -limit, limit);
    }
    if (!hit) return min(scale, limit);
    vec2 slope = (vec2(p) + 0.5 - 0.5 * vec2(effect_size)) / effect_scale;
    float depth = texelFetch(effect_geometry, p, 0).w * inversesqrt(1.0 + dot(slope, slope));
    return clamp(scale * (1.0 - plane / max(depth, 1e-20)), -limit, limit);
}

// Inner radius of the iris in a direction: 1 for a disc, the distance of the polygon's edge otherwise.
float iris(float angle) {
    if (blades < 3) return 1.0;
    float sector = 6.283185307 / float(blades);
    // A corner points up.
    float within = mod(angle - 1.570796327, sector) - 0.5 * sector;
    return cos(0.5 * sector) / cos(within);
}

// Part of a blur's light that falls on each pixel within.
float share(float blur) { return 1.0 / max(3.141592654 * blur * blur, 1.0); }

void kernel_main(ivec2 pixel, out vec4 color) {
    vec4 here = effect_at(pixel);
    float own = confusion(pixel);
    float reach = largest * float(effect_size.y);
    // What lies in front of this pixel's surface, in it, and behind it; each with its weight.
    vec4 front = vec4(0.0);
    vec4 same = here * share(own);
    vec4 behind = vec4(0.0);
    vec3 weight = vec3(0.0, share(own), 0.0);
    for (int i = 0; i < taps && aperture > 0.0; ++i) {
        // Rings at equal distances: small blurs get as many looks as large ones.
        float r = reach * (float(i) + 0.5) / float(taps);
        float angle = 2.399963230 * float(i);
        ivec2 place = pixel + ivec2(floor(r * vec2(cos(angle), sin(angle)) + 0.5));
        float area = 6.283185307 * r * reach / float(taps);
        float blur = confusion(place);
        // Light spreads upside down from in front of the plane of focus.
        float edge = iris(blur < 0.0 ? angle : angle + 3.141592654);
        vec4 light = effect_at(place);
        if (blur > own + 1.0) {
            // Seen through the blurred edge of what is here.
            float w = area * share(own) * clamp(abs(own) * edge - r + 0.5, 0.0, 1.0);
            behind += w * light;
            weight.z += w;
        } else {
            float w = area * share(blur) * clamp(abs(blur) * edge - r + 0.5, 0.0, 1.0);
            if (blur < own - 1.0) {
                front += w * light;
                weight.x += w;
            } else {
                same += w * light;
                weight.y += w;
            }
        }
    }
    color = same / weight.y;
    if (weight.z > 0.0) color = mix(behind / weight.z, color, min(weight.y, 1.0));
    if (weight.x > 0.0) color = mix(color, front / weight.x, min(weight.x, 1.0));
}
