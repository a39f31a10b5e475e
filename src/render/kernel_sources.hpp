#pragma once

#include "render/subject.hpp"

#include <cstddef>

namespace apeiron::render {

// The GLSL of each of a renderer's kernels, from its parts. Separate from the renderer, so that tests can compile and
// validate every one of them for every stage without running a scene.

/// The accumulators that a scene's renderer wants: the `integrate` tag of its module ("mean" without one).
std::string integratorOf(const scene::Scene& scene);

/// Whether a scene's renderer draws directions from the environment: `#pragma apeiron samples environment`.
bool samplesEnvironment(const scene::Scene& scene);

/// What kernels depend on beside the parameters of a scene: its subject's variant() and the kinds of its lights. When
/// this changes, kernels are made anew.
std::string variantOf(const scene::Scene& scene, const Subject& subject);

/// The environment and what there is to know of the lights: glsl/environment.glsl with all that it needs.
void addEnvironment(gpu::ShaderSource& source, const scene::Scene& scene, bool specialise);

/// `generate`: subject + environment + renderer module; 3 outputs.
/// @param peaked the environment's light comes from few directions (EnvironmentDistribution::peaked())
/// @throws Error (BadInput) when the renderer needs an interface that the subject does not give.
gpu::ShaderSource generateSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options,
                                 bool peaked = true);

/// The prepass: where the rays of each tile of pixels may start; 1 output.
gpu::ShaderSource prepassSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options);

/// The environment in spherical harmonics; 1 output.
gpu::ShaderSource harmonicsSource(const scene::Scene& scene, const BuildOptions& options);

/// How much light comes from each cell of the environment's distribution; 1 output.
gpu::ShaderSource environmentPowerSource(const scene::Scene& scene, const BuildOptions& options);

/// `integrate` of that name; 4 outputs.
gpu::ShaderSource integrateSource(const std::string& integrator);

/// What `present` is for: rasterisers on the CPU would compute it all each time.
struct PresentKind {
    bool accumulated = false; ///< shows the accumulators, not the estimate
    bool points = false;      ///< keeps the points that pixels show: a fourth output
    bool history = false;     ///< and takes what is not there from the picture of before the camera moved
    /// 0 to 7, one for each.
    std::size_t index() const { return (accumulated ? 1U : 0U) + (points ? 2U : 0U) + (history ? 4U : 0U); }
};

/// `present` of that name; 3 outputs, or 4.
gpu::ShaderSource presentSource(const std::string& integrator, const PresentKind& kind);

/// The distance from the camera to the surface; 1 output.
gpu::ShaderSource probeSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options);

} // namespace apeiron::render
