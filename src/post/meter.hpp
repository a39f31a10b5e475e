#pragma once

#include "gpu/kernel_cache.hpp"

namespace apeiron::post {

/// A light meter: finds the factor by which a picture's radiance must be multiplied to be well exposed, on the GPU and
/// without reading anything back. Needs its context current.
class Meter {
  public:
    Meter(const gpu::Context& context, gpu::KernelCache& cache, gpu::Stage stage);

    /// Measures a picture. The factor is then in result().
    /// @param key     the luminance that the average is to have, before the tone mapper
    void run(const gpu::Texture& color, double key) { run(color, key, false); }

    /// Runs the kernels over one texel each, so that the driver has finished compiling them.
    void warmUp(const gpu::Texture& color) { run(color, 1.0, true); }

    /// One texel: the factor.
    const gpu::Texture& result() const { return result_.color; }

    /// The kernels, for tests.
    static gpu::ShaderSource source(const std::string& pass);

  private:
    void run(const gpu::Texture& color, double key, bool one);

    struct Stop {
        Stop(const gpu::Context& context, glm::ivec2 size, const std::string& label);
        gpu::Texture color;
        gpu::Targets targets;
    };
    Stop grid_;
    Stop histogram_;
    Stop result_;
    std::shared_ptr<gpu::Kernel> gridKernel_;
    std::shared_ptr<gpu::Kernel> histogramKernel_;
    std::shared_ptr<gpu::Kernel> resultKernel_;
};

} // namespace apeiron::post
