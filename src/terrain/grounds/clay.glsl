/// One bright material: shows nothing but the shape.
vec4 material(Ground g) { return vec4(vec3(0.55, 0.5, 0.45), 0.8); }
