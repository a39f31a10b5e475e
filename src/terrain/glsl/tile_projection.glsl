// From the camera's surroundings to the picture, for all that is drawn of a terrain.

uniform mat3 tile_basis;  // camera to world
uniform vec2 tile_film;   // 1 / (width / 2), 1 / (height / 2) of the picture at distance 1
uniform vec2 tile_shift;  // of the picture [clip space]
uniform vec3 tile_lens;   // point of the lens, camera space [world]; 1 / focal distance
uniform vec3 tile_depth;  // 0, nearest, 0: reversed; 1, and two coefficients otherwise

// Of a point from the camera [world].
vec4 tile_project(vec3 p) {
    vec3 v = p * tile_basis;
    float d = -v.z;
    // All rays of a sample leave one point of the lens and meet those of the others in the plane of focus.
    vec2 film = v.xy - tile_lens.xy * (1.0 - d * tile_lens.z);
    float z = tile_depth.x == 0.0 ? tile_depth.y : d * tile_depth.y + tile_depth.z;
    return vec4(film * tile_film * vec2(1.0, -1.0) - tile_shift * d, z, d);
}
