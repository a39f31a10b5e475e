#include "render/glsl/camera.glsl"

// What every renderer's estimate begins with: rays start where the prepass says, and pixels that are good enough are left out.

uniform sampler2D prepass_start; // where the rays of 2^prepass_shift square pixels may start
uniform int prepass_shift;
uniform bool prepass_there;      // the prepass was done
uniform float error_limit;       // standard error of the luminance that is good enough [radiance]; 0: none is
uniform sampler2D accumulator_mean;
uniform sampler2D accumulator_spread;

// The standard error of a pixel's mean luminance, as render::Accumulation::noise() has it: channels rise and fall together, so their
// deviations add.
float generate_error(ivec2 pixel) {
    pixel = clamp(pixel, ivec2(0), camera_size - 1);
    float count = texelFetch(accumulator_mean, pixel, 0).w;
    vec3 spread = texelFetch(accumulator_spread, pixel, 0).rgb;
    return dot(sqrt(max(spread, 0.0)), vec3(0.2126, 0.7152, 0.0722)) * inversesqrt(max(count * (count - 1.0), 1.0));
}

// A pixel is done when all around it are, too: its own few samples may by chance have missed what varies. Where there is no limit
// the loop has no turn. Its bound is not a constant, lest compilers unroll it: rasterisers on the CPU, which compute what no pixel needs,
// would read 18 texels for each sample then instead of two.
bool generate_done(ivec2 pixel) {
    bool done = error_limit > 0.0;
    int neighbours = done ? 9 : 0;
    for (int i = 0; i < neighbours && done; ++i) {
        done = generate_error(pixel + ivec2(i % 3 - 1, i / 3 - 1)) <= error_limit;
    }
    return done;
}

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    if (generate_done(pixel)) {
        radiance = vec4(0.0, 0.0, 0.0, -1.0); // no sample
        geometry = vec4(0.0);
        albedo = vec4(0.0);
        return;
    }
    camera_start = prepass_there ? texelFetch(prepass_start, pixel >> prepass_shift, 0).x : 0.0;
    renderer_kernel_main(pixel, radiance, geometry, albedo);
}
