// Scattering by haze: the phase function of Henyey & Greenstein (1941). `g` is the mean cosine, directions are those of travel.

// Per solid angle, for the cosine between the directions before and after; this is also the probability of phase_sample().
float phase_value(float g, float cosine) {
    float base = max(1.0 + g * g - 2.0 * g * cosine, 1e-8);
    return 0.0795774715 * (1.0 - g * g) / (base * sqrt(base));
}

// The direction after scattering, for u in [0, 1)².
vec3 phase_sample(float g, vec3 before, vec2 u) {
    float s = 1.0 - 2.0 * u.x;
    float cosine = s;
    if (abs(g) > 1e-3) {
        float part = (1.0 - g * g) / (1.0 + g * s);
        cosine = clamp((1.0 + g * g - part * part) / (2.0 * g), -1.0, 1.0);
    }
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    float angle = 6.283185307 * u.y;
    // A basis about the direction (Duff et al. 2017).
    float side = before.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + before.z);
    float b = before.x * before.y * a;
    vec3 x = vec3(1.0 + side * before.x * before.x * a, side * b, -side * before.x);
    vec3 y = vec3(b, side + before.y * before.y * a, -before.y);
    return normalize(sine * cos(angle) * x + sine * sin(angle) * y + cosine * before);
}
