/// Sandstone in layers, with sand in the hollows.
vec4 material(Ground g) {
    float layer = 0.5 + 0.5 * sin(9.0 * g.height + 2.0 * g.grain);
    vec3 stone = mix(vec3(0.42, 0.16, 0.07), vec3(0.66, 0.38, 0.19), layer);
    stone *= 0.75 + 0.5 * g.grain;
    float sand = smoothstep(0.1, 0.3, subject_snow + 0.25 - 0.75 * g.slope - 0.35 * g.rise);
    return vec4(mix(stone, vec3(0.72, 0.52, 0.31), sand), 0.9);
}
