#include "render/glsl/camera.glsl"

// The prepass: one cone around each square of prepass_tile x prepass_tile pixels finds where all of their rays may start.

uniform int prepass_tile; // [px]

// The cone around all rays of a square of pixels: filters reach 1.5 px beyond it.
Ray prepass_cone(vec2 corner, float side) {
    Ray cone = camera_ray(corner + 0.5 * side);
    for (int i = 0; i < 4; ++i) {
        Ray rim = camera_ray(corner + vec2(i & 1, i >> 1) * (side + 3.0) - 1.5);
        // Between points at the same distance from the origins: that grows at most like the directions' difference.
        cone.width = max(i == 0 ? 0.0 : cone.width, 2.0 * length(rim.origin - cone.origin));
        cone.spread = max(i == 0 ? 0.0 : cone.spread, 2.0 * length(rim.direction - cone.direction));
    }
    // Rays from all over the lens meet the middle one in the plane of focus, part from it again behind, and are longer or shorter by up to
    // the lens's radius.
    if (camera_lens > 0.0) {
        cone.width += 4.0 * camera_lens;
        cone.spread += 2.0 * camera_lens / camera_focus;
    }
    return cone;
}

void kernel_main(ivec2 tile, out vec4 start) {
    start = vec4(surface_clear(prepass_cone(vec2(tile * prepass_tile), float(prepass_tile))));
}
