#pragma once

#include "gpu/kernel_cache.hpp"
#include "post/meter.hpp"
#include "render/picture.hpp"
#include "scene/scene.hpp"

namespace apeiron::post {

/// How the finished picture is quantised and composed.
struct Display {
    double dither = 0.0;        ///< one step of the output, e.g. 1/255; 0: none
    bool flip = false;          ///< the target's first row is the bottom one (windows, canvases)
    bool opaque = false;        ///< blend over `background` and write alpha 1
    glm::vec3 background{0.0F}; ///< linear, 0..1
};

/// The kernel of an effect node: one output, the picture after it.
gpu::ShaderSource effectSource(const parameter::Node& effect);

/// The kernel that ends the chain, with the tone mapper of the scene's `post` node: one output.
gpu::ShaderSource displaySource(const parameter::Node& post);

/// The post chain of a scene: its effects in order, HDR to HDR, then exposure by hand or by the light meter, one tone
/// mapper and sRGB. Needs its context current.
class Chain {
  public:
    /// Compiles the kernels of the scene's effects and tone mapper.
    /// @throws Error as gpu::Kernel.
    Chain(const gpu::Context& context, gpu::KernelCache& cache, gpu::Stage stage, const scene::Scene& scene,
          glm::ivec2 size);

    /// Runs the kernels over nothing, so that the driver has finished compiling them (see render::Renderer::warmUp).
    void warmUp(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets);

    /// Runs the effects and writes display values in [0, 1] into the first of the targets.
    /// @param scene  with the same programs as at construction; its values are read now
    void run(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets,
             const Display& display);

  private:
    void run(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets,
             const Display& display, const gpu::Region& region, glm::ivec2 size);

    /// A picture between two effects, or two passes of one.
    struct Stop {
        Stop(const gpu::Context& context, glm::ivec2 size);
        gpu::Texture color;
        gpu::Targets targets;
    };
    struct Effect {
        std::shared_ptr<gpu::Kernel> kernel; ///< null for a disabled one
        int passes = 1;
        bool pyramid = false; ///< its passes go through levels_ and back
    };
    /// Runs one effect over `color` and returns its result, one of stops_.
    const gpu::Texture& run(const Effect& effect, const gpu::Texture& color, const gpu::Region& region,
                            glm::ivec2 size);
    /// One of stops_ that is neither of the two.
    Stop& freeStop(const gpu::Texture& one, const gpu::Texture& other);

    std::vector<Effect> effects_;
    std::unique_ptr<Meter> meter_; ///< null where the exposure is set by hand
    gpu::Texture noMeter_;         ///< what the display's kernel sees then
    gpu::Texture noSamples_;       ///< what effects see while no sample is complete
    std::shared_ptr<gpu::Kernel> display_;
    std::shared_ptr<gpu::Kernel> screen_; ///< the same as fragments: what a window's framebuffer needs
    std::vector<std::unique_ptr<Stop>> stops_;
    /// Halved pictures for effects that ask for them, the largest first: on the way there, and on the way back.
    std::vector<std::unique_ptr<Stop>> halved_, returned_;
    glm::ivec2 size_;
};

} // namespace apeiron::post
