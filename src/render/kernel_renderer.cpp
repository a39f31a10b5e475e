#include "render/environment_distribution.hpp"
#include "render/kernel_sources.hpp"
#include "render/renderer.hpp"
#include "render/shared_points.hpp"

#include <array>
#include <functional>
#include <optional>

namespace apeiron::render {
namespace {

constexpr auto kFloat4 = gpu::PixelFormat::RGBA32F;

/// Estimates are padded so that sub-images of any factor f fit: f * ceil(size / f) < size + f.
constexpr int kPadding = Interleave::kMost - 1;

/// Where the first sub-image lies, if there are several: Mesa's llvmpipe shares work out to threads by tiles of 64 x
/// 64, and a sub-image may be just as small. In the middle of a tile it has a part of four.
constexpr int kStraddle = 32;

/// The prepass has one texel for a square of 2^shift pixels.
constexpr int kPrepassShift = 3;

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
        : context_(context), cache_(cache), options_(options), environmentPicture_(context, scene), size_(size),
          prepassSize_((size + (1 << kPrepassShift) - 1) / (1 << kPrepassShift)),
          estimate_(context, glm::min(size + kPadding + kStraddle, glm::ivec2(context.capabilities().maxTextureSize)),
                    kEstimate),
          front_(std::make_unique<Buffers<4>>(context, size, kAccumulator)),
          back_(std::make_unique<Buffers<4>>(context, size, kAccumulator)),
          starts_(context, gpu::PixelFormat::R32F, prepassSize_, "prepass_start"), startsTargets_(context, {&starts_}),
          nothing_(std::make_unique<Picture>(context, glm::ivec2(1, 1), true)),
          harmonics_(context, kFloat4, {9, 1}, "environment_sh"), harmonicsTargets_(context, {&harmonics_}),
          probeResult_(context, kFloat4, {1, 1}, "probe"), probeTargets_(context, {&probeResult_}) {
        const std::string means = integratorOf(scene);
        harmonicsKernel_ = cache.get("environment_sh", harmonicsSource(scene, options), options.stage, {kFloat4});
        if (samplesEnvironment(scene)) distribution_.emplace(context, cache, options, scene);
        updateEnvironment(scene, View(scene, size));
        makeGenerate(scene, subject);
        integrate_ = cache.get("integrate " + means, integrateSource(means), options.stage,
                               {kFloat4, kFloat4, kFloat4, kFloat4});
        makePresent_ = [&cache, means, stage = options.stage](const PresentKind& kind) {
            return cache.get("present " + means, presentSource(means, kind), stage,
                             std::vector<gpu::PixelFormat>(kind.points ? 4 : 3, kFloat4));
        };
        prepass_ =
            cache.get("prepass", prepassSource(scene, subject, options), options.stage, {gpu::PixelFormat::R32F});
        if (subject.provides().contains("surface")) {
            // Compiled only when asked for: many sessions never do.
            makeProbe_ = [&cache, source = probeSource(scene, subject, options), stage = options.stage] {
                return cache.get("probe", source, stage, {kFloat4});
            };
        }
    }

    void setScene(const scene::Scene& scene, const View& view, const Subject& subject) override {
        view_ = view;
        subject_ = &subject;
        drawn_.reset();
        sharedPoints_ = SharedPoints(scene);
        if (subject.draws()) subject.prepare(context_, cache_, options_.stage, scene, size_);
        updateEnvironment(scene, view);
        const bool anew = peaked_ != peaked();
        if (anew) makeGenerate(scene, subject);
        for (gpu::Kernel* kernel : {prepass_.get(), generate_.get()})
            view.upload(*kernel);
        generate_->setParameters("environment", scene.environment);
        environmentPicture_.bind(*generate_);
        generate_->setParameters("renderer", scene.renderer);
        generate_->set("environment_sh", harmonics_);
        if (distribution_) distribution_->bind(*generate_);
        subject.bind(*generate_, scene);
        subject.bind(*prepass_, scene);
        prepass_->set("prepass_tile", 1 << kPrepassShift);
        generate_->set("prepass_start", starts_);
        generate_->set("prepass_shift", kPrepassShift);
        if (anew) warmGenerate();
    }

    void warmUp(const Picture& picture) override {
        const gpu::Region one{{0, 0}, {1, 1}};
        prepass_->run(startsTargets_, one, {0, 0});
        warmGenerate();
        bindBuffers(*integrate_, Interleave(1));
        integrate_->run(back_->targets, one, {0, 0});
        const History history{*nothing_, *view_};
        for (const int blocks : {-1, 0}) {
            preparePresent(picture, Interleave(1), {blocks}, nullptr).run(picture.targets, one, {0, 0});
            // (The first move of a camera should not wait for it.)
            if (picture.point)
                preparePresent(picture, Interleave(1), {blocks}, &history).run(picture.targets, one, {0, 0});
        }
        reset();
    }

    void reset() override {
        empty_ = true;
        errorLimit_ = 0.0F;
        prepassLeft_ = prepassSize_.x * prepassSize_.y;
    }

    bool holds(const Interleave& interleave) const override {
        return estimateHolds(interleave.factor() * interleave.block(size_));
    }

    glm::ivec2 prepassSize() const override { return prepassSize_; }

    void prepass(const gpu::Region& region) override {
        prepass_->run(startsTargets_, region, prepassSize_);
        prepassLeft_ -= region.size.x * region.size.y;
    }

    void setErrorLimit(float limit) override { errorLimit_ = limit; }

    void generate(std::uint32_t sample, const Interleave& interleave, glm::ivec2 offset,
                  const gpu::Region& region) override {
        if (drawDue(sample)) draw(sample);
        const glm::ivec2 origin = offset * interleave.block(size_) + straddle(interleave);
        generate_->set("random_sample", sample);
        generate_->set("error_limit", errorLimit_);
        generate_->set("prepass_there", prepassLeft_ <= 0);
        bindAccumulators(*generate_);
        generate_->run(estimate_.targets, {origin + region.origin, region.size}, size_,
                       {origin, interleave.factor(), offset});
    }

    bool drawDue(std::uint32_t sample) const override {
        return subject_ != nullptr && subject_->draws() && drawn_ != sample;
    }

    void draw(std::uint32_t sample) override {
        const glm::vec2 shift = sharedPoints_.shift(sample);
        const glm::vec2 lens = sharedPoints_.lens(sample);
        subject_->draw(shift, lens);
        generate_->set("camera_shift", glm::vec3(shift, 1.0F));
        generate_->set("camera_shift_lens", lens);
        drawn_ = sample;
    }

    void integrate(const Interleave& interleave) override {
        bindBuffers(*integrate_, interleave);
        integrate_->set("accumulator_empty", empty_);
        integrate_->run(back_->targets);
        std::swap(front_, back_);
        empty_ = false;
    }

    void present(Picture& picture, const Interleave& interleave, const Progress& progress,
                 const History* history) override {
        if (interleave.factor() == 1 && progress.blocks == 1 && !picture.point) {
            // The estimate is the picture, texel by texel: copying it takes a tenth of what a kernel does.
            picture.radiance.copy(estimate_.textures[0]);
            picture.geometry.copy(estimate_.textures[1]);
            picture.albedo.copy(estimate_.textures[2]);
        } else {
            preparePresent(picture, interleave, progress, history).run(picture.targets);
        }
        // They are swapped with every sample: what is kept must be these.
        picture.mean = empty_ ? nullptr : &front_->textures[0];
        picture.spread = empty_ ? nullptr : &front_->textures[1];
    }

    Accumulation accumulation() const override {
        if (empty_) {
            const Image<float> nothing(size_.x, size_.y, 4);
            return {nothing, nothing, nothing, nothing};
        }
        const auto& t = front_->textures;
        return {t[0].download(), t[1].download(), t[2].download(), t[3].download()};
    }

    Surroundings lookAround(const scene::Scene& scene, const Subject& subject, glm::vec3 way) override {
        if (const auto known = subject.lookAround(scene, way)) return *known;
        if (!makeProbe_) return {};
        if (!probe_) probe_ = makeProbe_();
        subject.bind(*probe_, scene);
        probe_->set("probe_way", way);
        probe_->run(probeTargets_);
        const glm::vec4 seen = probeResult_.texel({0, 0});
        return {static_cast<double>(seen.x), static_cast<double>(seen.y)};
    }

  private:
    bool estimateHolds(glm::ivec2 size) const {
        return glm::all(glm::lessThanEqual(size, estimate_.textures[0].size()));
    }

    /// Where the first sub-image begins; whole pictures begin where theirs do.
    int straddle(const Interleave& interleave) const {
        const bool room = estimateHolds(interleave.factor() * interleave.block(size_) + kStraddle);
        return interleave.factor() > 1 && room ? kStraddle : 0;
    }

    /// Camera moves, the most frequent edits, leave the environment as it is.
    void updateEnvironment(const scene::Scene& scene, const View& view) {
        if (environment_ && *environment_ == scene.environment && lights_ == scene.lights) return;
        view.upload(*harmonicsKernel_);
        harmonicsKernel_->setParameters("environment", scene.environment);
        environmentPicture_.bind(*harmonicsKernel_);
        harmonicsKernel_->run(harmonicsTargets_);
        if (distribution_) distribution_->update(scene, view, environmentPicture_);
        environment_ = scene.environment;
        lights_ = scene.lights;
    }

    bool peaked() const { return distribution_ && distribution_->peaked(); }

    /// The driver finishes compiling now, and not in somebody's step.
    void warmGenerate() {
        bindAccumulators(*generate_);
        generate_->run(estimate_.targets, gpu::Region{{0, 0}, {1, 1}}, {0, 0});
    }

    /// For the environment as it is.
    void makeGenerate(const scene::Scene& scene, const Subject& subject) {
        generate_ = cache_.get(scene.renderer.module("type").name, generateSource(scene, subject, options_, peaked()),
                               options_.stage, {kFloat4, kFloat4, kFloat4});
        peaked_ = peaked();
    }

    void bindBuffers(gpu::Kernel& kernel, const Interleave& interleave) {
        for (std::size_t i = 0; i < kEstimate.size(); ++i)
            kernel.set(kEstimate[i], estimate_.textures[i]);
        bindAccumulators(kernel);
        kernel.set("estimate_factor", interleave.factor());
        kernel.set("estimate_block", interleave.block(size_));
        kernel.set("estimate_origin", glm::ivec2(straddle(interleave)));
    }

    /// The kernel that presents into such a picture, with all but its target bound.
    gpu::Kernel& preparePresent(const Picture& picture, const Interleave& interleave, const Progress& progress,
                                const History* history) {
        const PresentKind kind{progress.blocks < 0, static_cast<bool>(picture.point), history != nullptr};
        std::shared_ptr<gpu::Kernel>& present = present_[kind.index()];
        if (!present) present = makePresent_(kind);
        gpu::Kernel& kernel = *present;
        if (view_) view_->upload(kernel);
        bindBuffers(kernel, interleave);
        kernel.set("estimate_done", progress.blocks);
        if (progress.blocks > 0) {
            const auto nearest = interleave.nearest(progress.blocks);
            kernel.set("estimate_nearest[0]", std::span<const int>(nearest));
        }
        kernel.set("estimate_current", interleave.offset(std::max(progress.blocks, 0)));
        kernel.set("estimate_band", progress.band);
        if (!history) return kernel;
        kernel.set("history_radiance", history->picture.radiance);
        kernel.set("history_geometry", history->picture.geometry);
        kernel.set("history_albedo", history->picture.albedo);
        kernel.set("history_point", history->picture.point);
        history->view.uploadAsHistory(kernel, history->offset, history->scale);
        kernel.set("history_share", history->share);
        return kernel;
    }

    void bindAccumulators(gpu::Kernel& kernel) {
        for (std::size_t i = 0; i < kAccumulator.size(); ++i)
            kernel.set(kAccumulator[i], front_->textures[i]);
    }

    const gpu::Context& context_;
    gpu::KernelCache& cache_;
    BuildOptions options_;
    const Subject* subject_ = nullptr;   ///< of the last setScene()
    std::optional<std::uint32_t> drawn_; ///< the sample that the subject was drawn for
    EnvironmentPicture environmentPicture_;
    glm::ivec2 size_;
    glm::ivec2 prepassSize_;
    int prepassLeft_ = 0; ///< texels that are not worked out yet
    Buffers<3> estimate_;
    std::unique_ptr<Buffers<4>> front_; ///< the current accumulators
    std::unique_ptr<Buffers<4>> back_;
    bool empty_ = true;
    float errorLimit_ = 0.0F; ///< [radiance]
    gpu::Texture starts_;     ///< where the rays of each tile of pixels may start
    gpu::Targets startsTargets_;
    SharedPoints sharedPoints_;
    std::unique_ptr<Picture> nothing_;
    gpu::Texture harmonics_;
    gpu::Targets harmonicsTargets_;
    std::optional<EnvironmentDistribution> distribution_; ///< for renderers that sample it
    std::optional<parameter::Node> environment_; ///< what the harmonics were made of; skies also depend on lights
    std::vector<parameter::Node> lights_;
    bool peaked_ = false; ///< what generate_ was made for
    gpu::Texture probeResult_;
    gpu::Targets probeTargets_;
    std::shared_ptr<gpu::Kernel> prepass_;
    std::shared_ptr<gpu::Kernel> generate_;
    std::shared_ptr<gpu::Kernel> integrate_;
    std::optional<View> view_;
    std::array<std::shared_ptr<gpu::Kernel>, 8> present_; ///< by PresentKind::index(): compiled when they are needed
    std::function<std::shared_ptr<gpu::Kernel>(const PresentKind&)> makePresent_;
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
