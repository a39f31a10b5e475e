#include "render/glsl/presented_mean.glsl"

// Turns what is there into radiance, geometry and albedo.
void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    radiance = vec4(0.0);
    geometry = vec4(0.0);
    albedo = vec4(0.0);
    ivec2 from;
    if (present_nearest(pixel, from)) present_new(from, radiance, geometry, albedo);
}
