#include "render/glsl/camera.glsl"

// The picture of before the camera moved: where in it is what a pixel shows now? By reprojection against the motion (Nehab et al. 2007,
// "Accelerating Real-Time Shading with Reverse Reprojection Caching"), the place found by fixed-point iteration (Bowles et al. 2012,
// "Iterative Image Warping").
//
// The engine adds: const bool history_there: there is such a picture.

uniform sampler2D history_radiance;
uniform sampler2D history_geometry;
uniform sampler2D history_albedo;
uniform sampler2D history_point;   // what each pixel shows: xyz from that camera, w 1; or background: direction, w 0
uniform mat3 history_basis;        // its camera, as camera_basis and camera_extent
uniform float history_extent;
uniform vec3 history_offset;       // from the camera now to the one of then
uniform float history_scale;       // units now per unit then

// Picture coordinates [px] of a point relative to a camera, and its depth.
vec3 history_project(vec3 p, mat3 basis, float extent) {
    vec3 v = p * basis;
    vec2 size = vec2(camera_size);
    vec2 film = (camera_orthographic ? v.xy : v.xy / -v.z) * (size.y / extent);
    return vec3(0.5 * size.x + film.x, 0.5 * size.y - film.y, camera_orthographic ? 1.0 : -v.z);
}

// The texel of the old picture that shows what `pixel` sees, and what that is as seen from the camera now; false where it was hidden or outside.
// guess: of what the pixel sees, as a point from the camera now
bool history_find(ivec2 pixel, vec4 guess, out ivec2 texel, out vec4 found) {
    vec2 here = vec2(pixel) + 0.5;
    vec3 at = history_project(guess.xyz - guess.w * history_offset, history_basis, history_extent);
    texel = pixel;
    found = guess;
    // Where the directions of an orthographic view meet the background does not depend on where it is.
    if (camera_orthographic && guess.w == 0.0) at = vec3(here, 1.0);
    for (int i = 0; i < 4; ++i) {
        texel = ivec2(floor(at.xy));
        if (at.z <= 0.0 || any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, camera_size))) return false;
        found = texelFetch(history_point, texel, 0);
        if (found.w > 0.0) found.xyz = found.xyz * history_scale + history_offset;
        vec3 back = history_project(found.xyz, camera_basis, camera_extent);
        if (camera_orthographic && found.w == 0.0) back = vec3(here, 1.0);
        vec2 miss = here - back.xy;
        if (back.z > 0.0 && all(lessThan(abs(miss), vec2(0.75)))) return true;
        at.xy += miss;
    }
    return false;
}
