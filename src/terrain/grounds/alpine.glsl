/// Rock in layers of grey and brown, scree in its folds, meadows in valleys, and snow where it is high and not steep.
float bands(float phase) { return 0.5 + 0.5 * sin(6.283185307 * phase + 0.8 * sin(12.56637061 * phase)); }

vec4 material(Ground g) {
    float band = mix(bands(g.layer.x), bands(g.layer.y), g.thick);
    vec3 rock = mix(vec3(0.06, 0.058, 0.062), vec3(0.24, 0.22, 0.205), smoothstep(0.15, 0.9, g.grain));
    rock = mix(rock, vec3(0.17, 0.11, 0.07), 0.6 * smoothstep(0.1, -0.6, g.rise));
    rock *= mix(0.7, 1.2, band);
    float high = clamp(1.3 * g.altitude + 0.7 * g.rise, -1.0, 1.0);
    float meadow = smoothstep(0.7, 0.45, g.slope) * smoothstep(0.2, -0.15, high + 0.3 * (g.grain - 0.5));
    vec3 grass = mix(vec3(0.035, 0.06, 0.016), vec3(0.12, 0.125, 0.04), g.grain);
    rock = mix(rock, grass, 0.9 * meadow);
    float line = 1.6 * (subject_snow - 0.5);
    float snow = smoothstep(0.0, 0.16, 1.1 * high + line + 0.3 * (g.grain - 0.5) + 0.36 - 0.8 * g.slope);
    return vec4(mix(rock, vec3(0.86, 0.89, 0.94), snow), mix(0.85, 0.5, snow));
}
