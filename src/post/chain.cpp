#include "post/chain.hpp"

#include "core/error.hpp"
#include "parameter/text.hpp"
#include "scene/camera.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace apeiron::post {

constexpr auto kFloat4 = gpu::PixelFormat::RGBA32F;

namespace {

/// How often an effect's kernel runs: its tag `passes`.
int passesOf(const parameter::GlslModule& module) {
    constexpr int kMostPasses = 32;
    const auto tag = module.tags.find("passes");
    if (tag == module.tags.end()) return 1;
    const auto number = parameter::parseNumber(tag->second);
    if (!number || *number < 1.0 || *number > kMostPasses || *number != std::floor(*number))
        throw Error(ErrorKind::BadInput, fmt::format("#pragma apeiron passes needs a number from 1 to {}", kMostPasses),
                    module.file);
    return static_cast<int>(*number);
}

} // namespace

gpu::ShaderSource effectSource(const parameter::Node& effect) {
    gpu::ShaderSource source;
    // Never specialised: what the chain shows is there to be turned live.
    source.addModule(effect.module("type"), "fx_", effect, "effect", false);
    return source;
}

gpu::ShaderSource displaySource(const parameter::Node& post) {
    gpu::ShaderSource source;
    source.addFile("post/display.glsl");
    source.addModule(post.module("tonemapper"), "tonemapper_", post, "post", false);
    return source;
}

Chain::Stop::Stop(const gpu::Context& context, glm::ivec2 size)
    : color(context, kFloat4, size, "post"), targets(context, {&color}) {}

Chain::Chain(const gpu::Context& context, gpu::KernelCache& cache, gpu::Stage stage, const scene::Scene& scene,
             glm::ivec2 size)
    : noSamples_(context, kFloat4, {1, 1}, "no samples"), size_(size) {
    std::size_t active = 0;
    for (const parameter::Node& effect : scene.effects) {
        if (!effect.flag("enabled")) {
            effects_.push_back({});
            continue;
        }
        const parameter::GlslModule& module = effect.module("type");
        const bool pyramid = module.tags.count("pyramid") > 0;
        effects_.push_back({cache.get(module.name, effectSource(effect), stage, {kFloat4}), passesOf(module), pyramid});
        if (pyramid && halved_.empty()) {
            // 1,024 pixels are wider than any kernel that anyone would see the shape of.
            for (int level = 1; level <= 10 && (1 << level) <= std::min(size.x, size.y); ++level) {
                const glm::ivec2 smaller = (size + (1 << level) - 1) >> level;
                halved_.push_back(std::make_unique<Stop>(context, smaller));
                returned_.push_back(std::make_unique<Stop>(context, smaller));
            }
        }
        // Of several passes, each needs the one before it, and what the first one saw.
        const std::size_t needed = std::min<std::size_t>(++active, 2) + (effects_.back().passes > 1 ? 2 : 0);
        while (stops_.size() < std::min<std::size_t>(needed, 3))
            stops_.push_back(std::make_unique<Stop>(context, size));
    }
    if (scene.post.text("exposure_mode") == "auto") meter_ = std::make_unique<Meter>(context, cache, stage);
    if (!meter_) noMeter_ = gpu::Texture(context, kFloat4, {1, 1}, "no meter");
    const gpu::ShaderSource source = displaySource(scene.post);
    display_ = cache.get("display", source, stage, {kFloat4});
    screen_ = stage == gpu::Stage::Fragment ? display_ : cache.get("display", source, gpu::Stage::Fragment, {kFloat4});
}

void Chain::warmUp(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets) {
    run(scene, picture, targets, {}, {{0, 0}, {1, 1}}, {0, 0});
}

Chain::Stop& Chain::freeStop(const gpu::Texture& one, const gpu::Texture& other) {
    return **std::find_if(stops_.begin(), stops_.end(),
                          [&](const auto& stop) { return &stop->color != &one && &stop->color != &other; });
}

const gpu::Texture& Chain::run(const Effect& effect, const gpu::Texture& input, const gpu::Region& region,
                               glm::ivec2 size) {
    gpu::Kernel& kernel = *effect.kernel;
    const auto levels = static_cast<int>(halved_.size());
    kernel.set("effect_levels", levels);
    const int passes = effect.pyramid ? std::max(2 * levels, 1) : effect.passes;
    const gpu::Texture* color = &input;
    for (int pass = 0; pass < passes; ++pass) {
        const int level = !effect.pyramid ? 0 : pass < levels ? pass + 1 : std::max(2 * levels - 1 - pass, 0);
        const auto index = static_cast<std::size_t>(level - 1);
        kernel.set("effect_pass", pass);
        kernel.set("effect_level", level);
        kernel.set("effect_color", *color);
        if (level == 0) {
            Stop& stop = freeStop(*color, input);
            kernel.set("effect_same", input);
            kernel.run(stop.targets, region, size);
            color = &stop.color;
            continue;
        }
        // On the way there, nothing is known of the same level yet, but its sampler must be bound to something else.
        const bool there = pass < levels;
        const Stop& stop = there ? *halved_[index] : *returned_[index];
        const glm::ivec2 whole = size == glm::ivec2(0) ? size : stop.color.size();
        kernel.set("effect_same", there ? *color : halved_[index]->color);
        kernel.run(stop.targets, size == glm::ivec2(0) ? region : gpu::Region{{0, 0}, whole}, whole);
        color = &stop.color;
    }
    return *color;
}

void Chain::run(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets,
                const Display& display) {
    run(scene, picture, targets, display, {{0, 0}, size_}, size_);
}

void Chain::run(const scene::Scene& scene, const render::Picture& picture, const gpu::Targets& targets,
                const Display& display, const gpu::Region& region, glm::ivec2 size) {
    const scene::Camera camera(scene.camera);
    const bool orthographic = scene.camera.text("projection") == "orthographic";
    const double extent = camera.extent();
    const gpu::Texture* color = &picture.radiance;
    for (std::size_t i = 0; i < effects_.size(); ++i) {
        if (!effects_[i].kernel) continue;
        gpu::Kernel& kernel = *effects_[i].kernel;
        kernel.setParameters("effect", scene.effects[i]);
        kernel.set("effect_input", *color);
        kernel.set("effect_mean", picture.mean != nullptr ? *picture.mean : noSamples_);
        kernel.set("effect_spread", picture.spread != nullptr ? *picture.spread : noSamples_);
        kernel.set("effect_geometry", picture.geometry);
        kernel.set("effect_albedo", picture.albedo);
        kernel.set("effect_size", size_);
        kernel.set("effect_focus", static_cast<float>(camera.focus()));
        kernel.set("effect_scale", static_cast<float>(size_.y / extent));
        kernel.set("effect_orthographic", orthographic);
        color = &run(effects_[i], *color, region, size);
    }
    if (meter_ && size == size_) meter_->run(*color, scene.post.number("key"));
    if (meter_ && size != size_) meter_->warmUp(*color);
    gpu::Kernel& kernel = targets.textures().empty() ? *screen_ : *display_;
    kernel.setParameters("post", scene.post);
    kernel.set("effect_color", *color);
    kernel.set("display_exposure", static_cast<float>(std::exp2(scene.post.number("exposure"))));
    kernel.set("display_metered", meter_ != nullptr);
    kernel.set("display_meter", meter_ ? meter_->result() : noMeter_);
    kernel.set("display_dither", static_cast<float>(display.dither));
    kernel.set("display_flip", display.flip);
    kernel.set("display_height", size_.y);
    kernel.set("display_background", display.background);
    kernel.set("display_opaque", display.opaque);
    kernel.run(targets, region, size);
}

} // namespace apeiron::post
