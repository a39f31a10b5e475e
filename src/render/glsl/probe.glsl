#include "render/glsl/surface.glsl"

// One pixel: the distance from the camera to the nearest surface.
void kernel_main(ivec2 pixel, out vec4 result) { result = vec4(surface_distance(vec3(0.0))); }
