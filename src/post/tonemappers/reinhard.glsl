/// The global operator of Reinhard, Stark, Shirley & Ferwerda (2002, eq. 4), on luminance, with a white point.
/// Colours that would leave the gamut are drawn towards white, as film does.
#pragma apeiron invalidates present

uniform float white; //! 4 [0.5, 1000] log | Smallest luminance that is shown as white

vec3 tonemap(vec3 color) {
    float luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    if (luminance <= 0.0) return vec3(0.0);
    float shown = luminance * (1.0 + luminance / (white * white)) / (1.0 + luminance);
    vec3 mapped = color * (shown / luminance);
    float most = max(mapped.r, max(mapped.g, mapped.b));
    if (most > 1.0) mapped = mix(vec3(min(shown, 1.0)), mapped, clamp((1.0 - min(shown, 1.0)) / max(most - min(shown, 1.0), 1e-6), 0.0, 1.0));
    return mapped;
}
