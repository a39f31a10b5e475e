#pragma once

#include "render/subject.hpp"

namespace apeiron::render {

// The GLSL of each of a renderer's kernels, from its parts. Separate from the renderer, so that tests can compile and
// validate every one of them for every stage without running a scene.

/// The accumulators that a scene's renderer wants: the `integrate` tag of its module ("mean" without one).
std::string integratorOf(const scene::Scene& scene);

/// Whether a scene's renderer draws directions from the environment: `#pragma apeiron samples environment`.
bool samplesEnvironment(const scene::Scene& scene);

/// `generate`: subject + environment + renderer module; 3 outputs.
/// @throws Error (BadInput) when the renderer needs an interface that the subject does not give.
gpu::ShaderSource generateSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options);

/// The prepass: where the rays of each tile of pixels may start; 1 output.
gpu::ShaderSource prepassSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options);

/// The environment in spherical harmonics; 1 output.
gpu::ShaderSource harmonicsSource(const scene::Scene& scene, const BuildOptions& options);

/// How much light comes from each cell of the environment's distribution; 1 output.
gpu::ShaderSource environmentPowerSource(const scene::Scene& scene, const BuildOptions& options);

/// `integrate` of that name; 4 outputs.
gpu::ShaderSource integrateSource(const std::string& integrator);

/// `present` of that name; 3 outputs.
gpu::ShaderSource presentSource(const std::string& integrator);

/// The distance from the camera to the surface; 1 output.
gpu::ShaderSource probeSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options);

} // namespace apeiron::render
