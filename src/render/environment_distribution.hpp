#pragma once

#include "gpu/kernel_cache.hpp"
#include "render/environment_picture.hpp"
#include "render/subject.hpp"
#include "render/view.hpp"

namespace apeiron::render {

/// The light of a scene's environment as a distribution of directions to sample, for renderers that say
/// `#pragma apeiron samples environment` (see glsl/environment_distribution.glsl). Needs its context current.
class EnvironmentDistribution {
  public:
    EnvironmentDistribution(const gpu::Context& context, gpu::KernelCache& cache, const BuildOptions& options,
                            const scene::Scene& scene);

    /// The environment, or a light that it depends on, has changed.
    void update(const scene::Scene& scene, const View& view, const EnvironmentPicture& picture);

    /// Whether there are directions from which much more light comes than from others: 4 times as much as from all on
    /// average.
    bool peaked() const { return peak_ > 4.0F; }

    void bind(gpu::Kernel& kernel) const;

  private:
    gpu::Texture power_;
    gpu::Targets powerTargets_;
    gpu::Texture table_;
    float peak_ = 1.0F; ///< of the probability, relative to a uniform distribution's
    std::shared_ptr<gpu::Kernel> kernel_;
};

/// The table of glsl/environment_distribution.glsl for the mean radiance of each cell (the first channel counts).
/// Negative values and what is no number count as black; an environment without light is uniform.
std::vector<float> environmentTable(const Image<float>& power);

} // namespace apeiron::render
