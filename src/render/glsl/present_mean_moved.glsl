#include "render/glsl/presented_mean.glsl"
#include "render/glsl/history.glsl"

// The same for a camera that moves: what is not there yet comes from the picture before, so that nothing flickers. Every pixel keeps the
// point that it shows, so that nothing drifts either, however many pictures it has lived through ("Render Cache", Walter, Drettakis & Parker 1999).

uniform float history_share; // weight of the old picture where there is a new value as well

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo, out vec4 point) {
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    ivec2 from;
    bool fresh = present_nearest(pixel, from);
    bool own = fresh && from == pixel;
    if (fresh) present_new(from, radiance, geometry, albedo);
    Ray ray = camera_ray(vec2(pixel) + 0.5);
    point = geometry.w > 0.0 ? vec4(ray.origin + geometry.w * ray.direction, 1.0) : vec4(ray.direction, 0.0);
    if (!history_there || (own && history_share <= 0.0)) return;
    // What the nearest new pixel shows, and what this pixel showed: two guesses of where to look. Any point of a surface that is seen here hides
    // the background, and of two the nearer one the other.
    vec4 old = texelFetch(history_point, pixel, 0);
    if (old.w > 0.0) old.xyz = old.xyz * history_scale + history_offset;
    ivec2 texel = pixel;
    vec4 found = old;
    bool there = false;
    for (int i = 0; i < 2; ++i) {
        vec4 guess = i == 0 ? old : point;
        if (i == 1 && !fresh) break;
        ivec2 at;
        vec4 seen;
        if (!history_find(pixel, guess, at, seen)) continue;
        bool nearer = seen.w > found.w || (seen.w == found.w && dot(seen.xyz, seen.xyz) < dot(found.xyz, found.xyz));
        if (there && !nearer) continue;
        there = true;
        texel = at;
        found = seen;
    }
    if (!there || (fresh && point.w > found.w && !own)) {
        // What nobody has seen yet shows what is nearby, never nothing.
        if (fresh) return;
        texel = pixel;
        found = vec4(old.w > 0.0 ? ray.origin + length(old.xyz) * ray.direction : ray.direction, old.w);
    }
    vec4 before = texelFetch(history_radiance, texel, 0);
    if (own) {
        // Noise of single samples is averaged with what was known of the same place.
        bool same = found.w == point.w &&
                    (found.w == 0.0 || length(found.xyz - point.xyz) < 4.0 * (camera_extent / float(camera_size.y)) *
                                                                      (camera_orthographic ? 1.0 : geometry.w));
        if (same) radiance = mix(radiance, before, history_share);
        return;
    }
    radiance = before;
    geometry = texelFetch(history_geometry, texel, 0);
    if (geometry.w > 0.0) geometry.w = length(found.xyz - ray.origin);
    albedo = texelFetch(history_albedo, texel, 0);
    point = found;
}
