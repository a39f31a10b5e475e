#include "render/glsl/random.glsl"
#include "render/glsl/surface.glsl"

uniform mat3 camera_basis;       // columns: right, up, backwards in world space
uniform ivec2 camera_size;       // of the picture [px]
uniform float camera_extent;     // height of the picture at distance 1 (perspective) or anywhere (orthographic)
uniform bool camera_orthographic;
uniform int camera_filter;       // 0 box, 1 tent, 2 gaussian
uniform float camera_lens;       // radius of the lens [world units]; 0: a pinhole
uniform float camera_focus;      // from the lens to the plane that is sharp, along the axis [world units]
uniform int camera_blades;       // corners of the lens; fewer than 3: a disc

uniform vec3 camera_shift;       // where in the pixel this sample lies of all pixels [px], z 1: the subject was drawn that way
uniform vec2 camera_shift_lens;  // and on the lens, of radius 1

float camera_start = 0.0; // nothing is nearer than this along the pixel's rays: the prepass knows

// Where in the picture this sample lies relative to the pixel's centre [px]: the filter, sampled in proportion to its weight.
vec2 camera_jitter(ivec2 pixel) {
    if (camera_shift.z > 0.0) return camera_shift.xy;
    vec2 u = random_pair(pixel, 0u);
    vec2 v = 2.0 * u;
    vec2 jitter = camera_filter == 0 ? u - 0.5 : mix(1.0 - sqrt(2.0 - v), sqrt(v) - 1.0, vec2(lessThan(v, vec2(1.0))));
    if (camera_filter == 2) {
        // Gaussian of sigma 0.45 px by Box & Muller (1958), cut off at 1.5 px.
        float radius = min(0.45 * sqrt(-2.0 * log(max(1.0 - u.x, 1e-6))), 1.5);
        float angle = 6.283185307 * u.y;
        jitter = radius * vec2(cos(angle), sin(angle));
    }
    return jitter;
}

// The ray through a point of the picture [px from the top left] and the middle of the lens.
Ray camera_ray(vec2 point) {
    vec2 size = vec2(camera_size);
    vec2 film = vec2(point.x - 0.5 * size.x, 0.5 * size.y - point.y) * (camera_extent / size.y);
    float pixel_size = camera_extent / size.y;
    if (camera_orthographic) {
        return Ray(camera_basis * vec3(film, 0.0), -camera_basis[2], camera_start, 1e30, pixel_size, 0.0);
    }
    return Ray(vec3(0.0), normalize(camera_basis * vec3(film, -1.0)), camera_start, 1e30, 0.0, pixel_size);
}

// A point of the lens of radius 1, uniform for u in [0,1)²: of a disc (Shirley & Chiu 1997), or of a regular polygon's triangles.
vec2 camera_lens_point(vec2 u) {
    if (camera_blades >= 3) {
        float corner = floor(u.x * float(camera_blades));
        vec2 angle = 6.283185307 * (corner + vec2(0.25, 1.25)) / float(camera_blades);
        return sqrt(u.y) * mix(vec2(cos(angle.x), sin(angle.x)), vec2(cos(angle.y), sin(angle.y)), fract(u.x * float(camera_blades)));
    }
    vec2 v = 2.0 * u - 1.0;
    bool wide = abs(v.x) > abs(v.y);
    float radius = wide ? v.x : v.y;
    if (radius == 0.0) return vec2(0.0);
    float angle = wide ? 0.785398163 * (v.y / v.x) : 1.570796327 - 0.785398163 * (v.x / v.y);
    return radius * vec2(cos(angle), sin(angle));
}

// The ray of this sample of a pixel: its place in the pixel by the filter, its origin on the lens. All rays through one point of
// the picture meet in the plane of focus (the thin lens of Potmesil & Chakravarty 1981; distributed rays of Cook, Porter & Carpenter 1984).
Ray camera_sample(ivec2 pixel) {
    Ray ray = camera_ray(vec2(pixel) + 0.5 + camera_jitter(pixel));
    if (camera_lens > 0.0) {
        vec3 lens = camera_basis * vec3(camera_lens * (camera_shift.z > 0.0 ? camera_shift_lens : camera_lens_point(random_pair(pixel, 2u))), 0.0);
        float along = camera_focus / max(-dot(ray.direction, camera_basis[2]), 1e-6);
        ray.direction = normalize(along * ray.direction - lens);
        ray.origin += lens;
    }
    return ray;
}
