// What palettes are made of. A palette is a file of `palettes/` with `vec3 color(float t)`: a linear albedo for t in [0, 1].

// Five colours at equal distances, blended in linear light.
vec3 gradient_five(float t, vec3 a, vec3 b, vec3 c, vec3 d, vec3 e) {
    float x = 4.0 * clamp(t, 0.0, 1.0);
    vec3 color = mix(a, b, min(x, 1.0));
    color = mix(color, c, clamp(x - 1.0, 0.0, 1.0));
    color = mix(color, d, clamp(x - 2.0, 0.0, 1.0));
    return mix(color, e, clamp(x - 3.0, 0.0, 1.0));
}

// A cosine on each channel (Quilez 1999, "Palettes"): as periodic as its frequencies are whole.
vec3 gradient_cosine(float t, vec3 middle, vec3 amplitude, vec3 frequency, vec3 phase) {
    return clamp(middle + amplitude * cos(6.283185307 * (frequency * t + phase)), 0.0, 1.0);
}
