#include "render/environment_distribution.hpp"
#include "render/kernel_sources.hpp"
#include "render/renderer.hpp"

#include <array>
#include <functional>
#include <limits>
#include <optional>

namespace apeiron::render {
namespace {

constexpr auto kFloat4 = gpu::PixelFormat::RGBA32F;

/// Estimates are laid out for any interleave factor up to this one.
constexpr int kMaxInterleave = 8;

/// A set of textures written together.
template <std::size_t Count> struct Buffers {
    Buffers(const gpu::Context& context, glm::ivec2 size, const std::array<const char*, Count>& labels) {
        std::vector<const gpu::Texture*> pointers;
        for (std::size_t i = 0; i < Count; ++i) {
            textures[i] = gpu::Texture(context, kFloat4, size, labels[i]);
            pointers.push_back(&textures[i]);
        }
        targets = gpu::Targets(context, pointers);
    }
    Buffers(const Buffers&) = delete;
    Buffers& operator=(const Buffers&) = delete;

    std::array<gpu::Texture, Count> textures;
    gpu::Targets targets;
};

constexpr std::array kEstimate{"estimate_radiance", "estimate_geometry", "estimate_albedo"};
constexpr std::array kAccumulator{"accumulator_mean", "accumulator_spread", "accumulator_normal", "accumulator_albedo"};

class KernelRenderer : public Renderer {
  public:
    KernelRenderer(const gpu::Context& context, gpu::KernelCache& cache, const BuildOptions& options,
                   const scene::Scene& scene, const Subject& subject, glm::ivec2 size)
        : size_(size), estimate_(context, (size + kMaxInterleave - 1) / kMaxInterleave * kMaxInterleave, kEstimate),
          front_(std::make_unique<Buffers<4>>(context, size, kAccumulator)),
          back_(std::make_unique<Buffers<4>>(context, size, kAccumulator)),
          harmonics_(context, kFloat4, {9, 1}, "environment_sh"), harmonicsTargets_(context, {&harmonics_}),
          probeResult_(context, kFloat4, {1, 1}, "probe"), probeTargets_(context, {&probeResult_}) {
        const std::string name = scene.renderer.module("type").name;
        const std::string means = integratorOf(scene);
        generate_ =
            cache.get(name, generateSource(scene, subject, options), options.stage, {kFloat4, kFloat4, kFloat4});
        harmonicsKernel_ = cache.get("environment_sh", harmonicsSource(scene, options), options.stage, {kFloat4});
        if (samplesEnvironment(scene)) distribution_.emplace(context, cache, options, scene);
        integrate_ = cache.get("integrate " + means, integrateSource(means), options.stage,
                               {kFloat4, kFloat4, kFloat4, kFloat4});
        present_ = cache.get("present " + means, presentSource(means), options.stage, {kFloat4, kFloat4, kFloat4});
        if (subject.provides().contains("surface")) {
            // Compiled only when asked for: many sessions never do.
            makeProbe_ = [&cache, source = probeSource(scene, subject, options), stage = options.stage] {
                return cache.get("probe", source, stage, {kFloat4});
            };
        }
    }

    void setScene(const scene::Scene& scene, const View& view, const Subject& subject) override {
        for (gpu::Kernel* kernel : {harmonicsKernel_.get(), generate_.get()}) {
            view.upload(*kernel);
            kernel->setParameters("environment", scene.environment);
        }
        // Camera moves, the most frequent edits, leave the environment as it is.
        if (!environment_ || *environment_ != scene.environment || lights_ != scene.lights) {
            harmonicsKernel_->run(harmonicsTargets_);
            if (distribution_) distribution_->update(scene, view);
            environment_ = scene.environment;
            lights_ = scene.lights;
        }
        generate_->setParameters("renderer", scene.renderer);
        generate_->set("environment_sh", harmonics_);
        if (distribution_) distribution_->bind(*generate_);
        subject.bind(*generate_, scene);
    }

    void warmUp(const Picture& picture) override {
        const gpu::Region one{{0, 0}, {1, 1}};
        generate_->run(estimate_.targets, one, {0, 0});
        for (gpu::Kernel* kernel : {integrate_.get(), present_.get()})
            bindBuffers(*kernel, Interleave(1));
        integrate_->run(back_->targets, one, {0, 0});
        present_->run(picture.targets, one, {0, 0});
        reset();
    }

    void reset() override { empty_ = true; }

    void generate(std::uint32_t sample, const Interleave& interleave, glm::ivec2 offset,
                  const gpu::Region& region) override {
        const glm::ivec2 origin = offset * interleave.block(size_);
        generate_->set("random_sample", sample);
        generate_->run(estimate_.targets, {origin + region.origin, region.size}, size_,
                       {origin, interleave.factor(), offset});
    }

    void integrate(const Interleave& interleave) override {
        bindBuffers(*integrate_, interleave);
        integrate_->set("accumulator_empty", empty_);
        integrate_->run(back_->targets);
        std::swap(front_, back_);
        empty_ = false;
    }

    void present(const Picture& picture, const Interleave& interleave, int complete) override {
        bindBuffers(*present_, interleave);
        present_->set("estimate_done", complete);
        present_->set("estimate_rank[0]", std::span<const int>(interleave.ranks()));
        present_->run(picture.targets);
    }

    Accumulation accumulation() const override {
        if (empty_) {
            const Image<float> nothing(size_.x, size_.y, 4);
            return {nothing, nothing, nothing, nothing};
        }
        const auto& t = front_->textures;
        return {t[0].download(), t[1].download(), t[2].download(), t[3].download()};
    }

    double distanceToSurface(const scene::Scene& scene, const Subject& subject) override {
        if (!makeProbe_) return std::numeric_limits<double>::infinity();
        if (!probe_) probe_ = makeProbe_();
        subject.bind(*probe_, scene);
        probe_->run(probeTargets_);
        return static_cast<double>(probeResult_.texel({0, 0}).x);
    }

  private:
    void bindBuffers(gpu::Kernel& kernel, const Interleave& interleave) {
        for (std::size_t i = 0; i < kEstimate.size(); ++i)
            kernel.set(kEstimate[i], estimate_.textures[i]);
        for (std::size_t i = 0; i < kAccumulator.size(); ++i)
            kernel.set(kAccumulator[i], front_->textures[i]);
        kernel.set("estimate_shift", interleave.shift());
        kernel.set("estimate_block", interleave.block(size_));
    }

    glm::ivec2 size_;
    Buffers<3> estimate_;
    std::unique_ptr<Buffers<4>> front_; ///< the current accumulators
    std::unique_ptr<Buffers<4>> back_;
    bool empty_ = true;
    gpu::Texture harmonics_;
    gpu::Targets harmonicsTargets_;
    std::optional<EnvironmentDistribution> distribution_; ///< for renderers that sample it
    std::optional<parameter::Node> environment_; ///< what the harmonics were made of; skies also depend on lights
    std::vector<parameter::Node> lights_;
    gpu::Texture probeResult_;
    gpu::Targets probeTargets_;
    std::shared_ptr<gpu::Kernel> generate_;
    std::shared_ptr<gpu::Kernel> integrate_;
    std::shared_ptr<gpu::Kernel> present_;
    std::shared_ptr<gpu::Kernel> harmonicsKernel_;
    std::shared_ptr<gpu::Kernel> probe_;
    std::function<std::shared_ptr<gpu::Kernel>()> makeProbe_;
};

} // namespace

std::unique_ptr<Renderer> makeRenderer(const gpu::Context& context, gpu::KernelCache& cache,
                                       const BuildOptions& options, const scene::Scene& scene, const Subject& subject,
                                       glm::ivec2 size) {
    return std::make_unique<KernelRenderer>(context, cache, options, scene, subject, size);
}

} // namespace apeiron::render
