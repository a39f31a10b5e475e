/// Single scattering: light that comes from lights and the environment by one collision in the medium, with exact shadows.
/// Unbiased; more samples bring less noise.
#pragma apeiron needs medium
#pragma apeiron samples environment
#pragma apeiron integrate mean
#include "render/glsl/medium_path.glsl"

uniform int sampling;   //! mis {mis, light, scattering} invalidates program | How light is found: by sampling both the lights and the way light scatters, or one alone (more noise, the same mean)
uniform int brdf;       //! lambert {lambert, phong, ggx} invalidates program | Reflection model of borders

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    medium_paths(MediumPaths(1, 1, sampling, brdf, 0.0), pixel, radiance, geometry, albedo);
}
