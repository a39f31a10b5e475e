/// No landscape: colours by height and steepness, each octave turned against the one before.
vec4 material(Ground g) {
    float t = 0.35 * g.height + 0.3 * g.grain + 0.04 * g.octave;
    vec3 color = 0.5 + 0.45 * cos(6.283185307 * (vec3(0.0, 0.12, 0.25) + t));
    color = mix(color, vec3(0.02, 0.03, 0.09), smoothstep(0.45, 0.9, g.slope) * (1.0 - subject_snow));
    return vec4(color * color, 0.5);
}
