#include "render/glsl/environment.glsl"

// Projects the environment on spherical harmonics: pixel i is coefficient i, over 1,024 Fibonacci directions.
void kernel_main(ivec2 pixel, out vec4 coefficient) {
    const int count = 1024;
    vec3 sum = vec3(0.0);
    for (int k = 0; k < count; ++k) {
        float z = 1.0 - (2.0 * float(k) + 1.0) / float(count);
        float r = sqrt(max(1.0 - z * z, 0.0));
        float phi = 2.399963230 * float(k);
        vec3 direction = vec3(r * cos(phi), r * sin(phi), z);
        sum += environment_at(direction) * environment_basis(pixel.x, direction);
    }
    coefficient = vec4(sum * (12.566371 / float(count)), 1.0);
}
