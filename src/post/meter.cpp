#include "post/meter.hpp"

namespace apeiron::post {
namespace {

constexpr auto kTexel = gpu::PixelFormat::RGBA32F;
constexpr glm::ivec2 kBlocks{32, 32};
constexpr int kBins = 256; ///< of a quarter of a stop: 32 stops up and down
/// What counts: a dark background may fill a third of the picture, the brightest twentieth are lights and glints.
const glm::vec2 kPercentiles{0.3F, 0.95F};

} // namespace

gpu::ShaderSource Meter::source(const std::string& pass) {
    gpu::ShaderSource source;
    source.addFile("post/glsl/meter_" + pass + ".glsl");
    return source;
}

Meter::Stop::Stop(const gpu::Context& context, glm::ivec2 size, const std::string& label)
    : color(context, kTexel, size, label), targets(context, {&color}) {}

Meter::Meter(const gpu::Context& context, gpu::KernelCache& cache, gpu::Stage stage)
    : grid_(context, kBlocks, "meter grid"), histogram_(context, {kBins, 1}, "meter histogram"),
      result_(context, {1, 1}, "meter result"), gridKernel_(cache.get("meter grid", source("grid"), stage, {kTexel})),
      histogramKernel_(cache.get("meter histogram", source("histogram"), stage, {kTexel})),
      resultKernel_(cache.get("meter result", source("result"), stage, {kTexel})) {}

void Meter::run(const gpu::Texture& color, double key, bool one) {
    const auto pass = [&](gpu::Kernel& kernel, const Stop& stop) {
        kernel.set("meter_blocks", kBlocks);
        kernel.set("meter_bins", kBins);
        const glm::ivec2 size = one ? glm::ivec2(1) : stop.color.size();
        kernel.run(stop.targets, {{0, 0}, size}, size);
    };
    gridKernel_->set("meter_color", color);
    gridKernel_->set("meter_size", color.size());
    pass(*gridKernel_, grid_);
    histogramKernel_->set("meter_grid", grid_.color);
    pass(*histogramKernel_, histogram_);
    resultKernel_->set("meter_histogram", histogram_.color);
    resultKernel_->set("meter_key", static_cast<float>(key));
    resultKernel_->set("meter_percentiles", kPercentiles);
    pass(*resultKernel_, result_);
}

} // namespace apeiron::post
