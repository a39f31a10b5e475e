/// Rock of grey and brown, scree in its folds, and snow where it is high and not steep.
vec4 material(Ground g) {
    vec3 rock = mix(vec3(0.085, 0.078, 0.075), vec3(0.26, 0.225, 0.19), smoothstep(0.2, 0.9, g.grain));
    rock = mix(rock, vec3(0.19, 0.13, 0.085), 0.5 * smoothstep(0.1, -0.7, g.rise));
    float meadow = smoothstep(0.62, 0.4, g.slope) * smoothstep(0.15, -0.35, g.rise);
    rock = mix(rock, vec3(0.085, 0.095, 0.04), 0.7 * meadow);
    float line = 1.4 * (subject_snow - 0.5);
    float snow = smoothstep(0.0, 0.2, 0.45 * g.rise + line + 0.2 * (g.grain - 0.5) + 0.42 - 0.8 * g.slope);
    return vec4(mix(rock, vec3(0.86, 0.89, 0.94), snow), mix(0.85, 0.55, snow));
}
