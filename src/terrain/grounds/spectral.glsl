/// No landscape: colours by height and steepness, in layers within layers.
vec3 hues(float phase) { return 0.5 + 0.45 * cos(6.283185307 * (vec3(0.0, 0.12, 0.25) + phase)); }

vec4 material(Ground g) {
    vec3 color = mix(hues(g.layer.x + 0.3 * g.grain), hues(g.layer.y + 0.3 * g.grain), g.thick);
    color = mix(color, vec3(0.02, 0.03, 0.09), smoothstep(0.45, 0.9, g.slope) * (1.0 - subject_snow));
    return vec4(color * color, 0.5);
}
