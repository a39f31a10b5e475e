#include "render/environment_distribution.hpp"

#include "render/kernel_sources.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::render {
namespace {

constexpr auto kFormat = gpu::PixelFormat::RGBA32F;
constexpr glm::ivec2 kCells{128, 64};

/// Part of the samples that go everywhere alike: light that falls between the 16 directions of a cell is found too.
constexpr double kUniform = 0.02;

constexpr float kSphere = 12.5663706F; ///< solid angle [sr]

} // namespace

EnvironmentDistribution::EnvironmentDistribution(const gpu::Context& context, gpu::KernelCache& cache,
                                                 const BuildOptions& options, const scene::Scene& scene)
    : power_(context, kFormat, kCells, "environment_power"), powerTargets_(context, {&power_}),
      table_(context, kFormat, kCells, "environment_distribution"),
      kernel_(cache.get("environment_power", environmentPowerSource(scene, options), options.stage, {kFormat})) {}

void EnvironmentDistribution::update(const scene::Scene& scene, const View& view, const EnvironmentPicture& picture) {
    view.upload(*kernel_);
    kernel_->set("environment_cells", power_.size());
    kernel_->setParameters("environment", scene.environment);
    picture.bind(*kernel_);
    kernel_->run(powerTargets_);
    const std::vector<float> table = environmentTable(power_.download());
    table_.upload(table);
    peak_ = 0.0F;
    for (std::size_t i = 1; i < table.size(); i += 4)
        peak_ = std::max(peak_, table[i] * kSphere);
}

void EnvironmentDistribution::bind(gpu::Kernel& kernel) const {
    kernel.set("environment_cells", table_.size());
    kernel.set("environment_distribution", table_);
}

std::vector<float> environmentTable(const Image<float>& power) {
    const auto width = static_cast<std::size_t>(power.width());
    const auto height = static_cast<std::size_t>(power.height());
    const std::size_t cells = width * height;
    std::vector<double> weight(cells);
    double sum = 0.0;
    for (std::size_t i = 0; i < cells; ++i) {
        const auto value = static_cast<double>(power.data()[i * static_cast<std::size_t>(power.channels())]);
        weight[i] = std::isfinite(value) && value > 0.0 ? value : 0.0;
        sum += weight[i];
    }
    const double mean = sum / static_cast<double>(cells);
    for (double& w : weight)
        w = mean > 0.0 ? (1.0 - kUniform) * w / mean + kUniform : 1.0; // the mean weight is 1
    std::vector<float> table(4 * cells);
    double rows = 0.0;
    for (std::size_t y = 0; y < height; ++y) {
        double row = 0.0;
        for (std::size_t x = 0; x < width; ++x)
            row += weight[y * width + x];
        rows += row;
        double part = 0.0;
        for (std::size_t x = 0; x < width; ++x) {
            part += weight[y * width + x];
            float* texel = &table[4 * (y * width + x)];
            texel[0] = static_cast<float>(part / row);
            texel[1] = static_cast<float>(weight[y * width + x]) / kSphere;
            texel[2] = static_cast<float>(rows / static_cast<double>(cells));
            texel[3] = static_cast<float>(mean);
        }
    }
    return table;
}

} // namespace apeiron::render
