/// Multiple scattering: paths of light through a medium with any number of collisions. Unbiased but for the length of paths; more
/// samples bring less noise. Borders may scatter as surfaces do (Kroes, Post & Botha 2012, "Exposure Render").
/// Lights are not seen by the camera itself, but for `visible` rectangles; the environment is.
#pragma apeiron needs medium
#pragma apeiron samples environment
#pragma apeiron integrate mean
#include "render/glsl/medium_path.glsl"

uniform int bounces;    //! 64 [1, 10000] log | Most collisions of a path: 1 is single scattering
uniform int roulette;   //! 4 [0, 10000] log | Collisions after which dim paths may end by Russian roulette
uniform int sampling;   //! mis {mis, light, scattering} invalidates program | How light is found: by sampling both the lights and the way light scatters, or one alone (more noise, the same mean)
uniform int brdf;       //! lambert {lambert, phong, ggx} invalidates program | Reflection model of borders
uniform float limit;    //! 0 [0, 1000] log | Most radiance that one sample's indirect light may have, which removes fireflies and some light; 0: no limit

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    medium_paths(MediumPaths(bounces, roulette, sampling, brdf, limit), pixel, radiance, geometry, albedo);
}
