#include "render/glsl/random.glsl"
#include "render/glsl/surface.glsl"

uniform mat3 camera_basis;       // columns: right, up, backwards in world space
uniform ivec2 camera_size;       // of the picture [px]
uniform float camera_extent;     // height of the picture at distance 1 (perspective) or anywhere (orthographic)
uniform bool camera_orthographic;
uniform int camera_filter;       // 0 box, 1 tent, 2 gaussian

float camera_start = 0.0; // nothing is nearer than this along the pixel's rays: the prepass knows

// Where in the picture this sample lies relative to the pixel's centre [px]: the filter, sampled in proportion to its weight.
vec2 camera_jitter(ivec2 pixel) {
    vec2 u = random_pair(pixel, 0u);
    if (camera_filter == 0) return u - 0.5;
    if (camera_filter == 1) {
        vec2 v = 2.0 * u;
        return mix(1.0 - sqrt(2.0 - v), sqrt(v) - 1.0, vec2(lessThan(v, vec2(1.0))));
    }
    // Gaussian of sigma 0.45 px by Box & Muller (1958), cut off at 1.5 px.
    float radius = min(0.45 * sqrt(-2.0 * log(max(1.0 - u.x, 1e-6))), 1.5);
    float angle = 6.283185307 * u.y;
    return radius * vec2(cos(angle), sin(angle));
}

// The camera ray through a point of the picture [px from the top left].
Ray camera_ray(vec2 point) {
    vec2 size = vec2(camera_size);
    vec2 film = vec2(point.x - 0.5 * size.x, 0.5 * size.y - point.y) * (camera_extent / size.y);
    float pixel_size = camera_extent / size.y;
    if (camera_orthographic) {
        return Ray(camera_basis * vec3(film, 0.0), -camera_basis[2], camera_start, 1e30, pixel_size, 0.0);
    }
    return Ray(vec3(0.0), normalize(camera_basis * vec3(film, -1.0)), camera_start, 1e30, 0.0, pixel_size);
}
