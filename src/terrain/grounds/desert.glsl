/// Sandstone in layers, with sand in the hollows.
float bands(float phase) {
    return 0.5 + 0.3 * sin(6.283185307 * phase) + 0.2 * sin(6.283185307 * (3.0 * phase + 0.2));
}

vec4 material(Ground g) {
    float band = mix(bands(g.layer.x), bands(g.layer.y), g.thick);
    vec3 stone = mix(vec3(0.36, 0.12, 0.05), vec3(0.68, 0.4, 0.2), band);
    stone *= 0.7 + 0.55 * g.grain;
    float sand = smoothstep(0.1, 0.3, subject_snow + 0.25 - 0.75 * g.slope - 0.35 * g.rise);
    return vec4(mix(stone, vec3(0.72, 0.52, 0.31), sand), 0.9);
}
