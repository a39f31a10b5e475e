#include "render/glsl/environment.glsl"
#include "render/glsl/environment_map.glsl"

// The mean radiance, over 16 directions and the three channels, of one cell of the environment's distribution.
void kernel_main(ivec2 pixel, out vec4 power) {
    float sum = 0.0;
    for (int i = 0; i < 16; ++i) {
        vec2 inside = (vec2(i & 3, i >> 2) + 0.5) * 0.25;
        vec3 radiance = environment_at(environment_direction((vec2(pixel) + inside) / vec2(environment_cells)));
        sum += radiance.r + radiance.g + radiance.b;
    }
    power = vec4(sum / 48.0);
}
