// The equal-area map between directions and the cells of the environment's distribution: Lambert's cylinder, z downwards.

uniform ivec2 environment_cells; // columns and rows

// For a place in [0, 1)².
vec3 environment_direction(vec2 place) {
    float z = 1.0 - 2.0 * place.y;
    float r = sqrt(max(1.0 - z * z, 0.0));
    float phi = 6.283185307 * place.x;
    return vec3(r * cos(phi), r * sin(phi), z);
}

ivec2 environment_cell(vec3 direction) {
    float turn = direction.x == 0.0 && direction.y == 0.0 ? 0.0 : atan(direction.y, direction.x) * 0.159154943;
    vec2 place = vec2(fract(turn), 0.5 - 0.5 * direction.z);
    return clamp(ivec2(place * vec2(environment_cells)), ivec2(0), environment_cells - 1);
}
