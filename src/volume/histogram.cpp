#include "volume/histogram.hpp"

#include "volume/voxels.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::volume {
namespace {

/// Every n-th voxel along each axis is looked at.
int strideOf(const Volume& volume) {
    int stride = 1;
    const auto along = [&](int edge) { return static_cast<std::int64_t>((edge + stride - 1) / stride); };
    while (along(volume.size.x) * along(volume.size.y) * along(volume.size.z) > kHistogramVoxels)
        ++stride;
    return stride;
}

/// Calls use(value, gradient) for the voxels that are looked at, in value units; gradients only where `differences`.
template <class Use> void forEachVoxel(const Volume& volume, int channel, int time, bool differences, const Use& use) {
    const int stride = strideOf(volume);
    const glm::ivec3 size = volume.size;
    // From differences along the grid's axes to the world's gradient.
    const glm::dmat3 toWorld = glm::transpose(glm::inverse(glm::dmat3(volume.indexToWorld)));
    visitVoxels(volume, channelOffset(volume, channel, time), [&](const auto* voxels) {
        const auto at = [&](int x, int y, int z) {
            return static_cast<double>(number(
                voxels[(static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(y)) *
                           static_cast<std::size_t>(size.x) +
                       static_cast<std::size_t>(x)]));
        };
        // One-sided at the borders.
        const auto slope = [](double before, double after, int i, int n) {
            return (after - before) / (i > 0 && i + 1 < n ? 2.0 : 1.0);
        };
        for (int z = 0; z < size.z; z += stride) {
            const int z0 = std::max(z - 1, 0);
            const int z1 = std::min(z + 1, size.z - 1);
            for (int y = 0; y < size.y; y += stride) {
                const int y0 = std::max(y - 1, 0);
                const int y1 = std::min(y + 1, size.y - 1);
                for (int x = 0; x < size.x; x += stride) {
                    const double value = at(x, y, z);
                    if (!std::isfinite(value)) continue;
                    double gradient = 0.0;
                    if (differences) {
                        const int x0 = std::max(x - 1, 0);
                        const int x1 = std::min(x + 1, size.x - 1);
                        const glm::dvec3 d(slope(at(x0, y, z), at(x1, y, z), x, size.x),
                                           slope(at(x, y0, z), at(x, y1, z), y, size.y),
                                           slope(at(x, y, z0), at(x, y, z1), z, size.z));
                        gradient = std::abs(volume.slope) * glm::length(toWorld * d);
                        if (!std::isfinite(gradient)) continue; // a neighbour is not
                    }
                    use(volume.slope * value + volume.intercept, gradient);
                }
            }
        }
    });
}

int classOf(double place, int classes) {
    return static_cast<int>(std::clamp(place * classes, 0.0, classes - 1.0));
}

} // namespace

Histogram valueHistogram(const Volume& volume, double low, double high, int classes, int channel, int time) {
    Histogram histogram{classes, 1, low, high, 0.0, 0, {}};
    histogram.counts.resize(static_cast<std::size_t>(classes));
    const double scale = 1.0 / (high - low);
    forEachVoxel(volume, channel, time, false, [&](double value, double /*gradient*/) {
        ++histogram.counts[static_cast<std::size_t>(classOf((value - low) * scale, classes))];
        ++histogram.voxels;
    });
    return histogram;
}

Histogram gradientHistogram(const Volume& volume, int classes, int channel, int time) {
    double most = 0.0;
    forEachVoxel(volume, channel, time, true, [&](double, double gradient) { most = std::max(most, gradient); });
    Histogram histogram{classes, 1, 0.0, most, most, 0, {}};
    histogram.counts.resize(static_cast<std::size_t>(classes));
    const double scale = most > 0.0 ? 1.0 / most : 0.0;
    forEachVoxel(volume, channel, time, true, [&](double, double gradient) {
        ++histogram.counts[static_cast<std::size_t>(classOf(gradient * scale, classes))];
        ++histogram.voxels;
    });
    return histogram;
}

Histogram jointHistogram(const Volume& volume, double low, double high, double gradientHigh, int values, int gradients,
                         int channel, int time) {
    Histogram histogram{values, gradients, low, high, gradientHigh, 0, {}};
    histogram.counts.resize(static_cast<std::size_t>(values) * static_cast<std::size_t>(gradients));
    const double scale = 1.0 / (high - low);
    forEachVoxel(volume, channel, time, true, [&](double value, double gradient) {
        const auto x = static_cast<std::size_t>(classOf((value - low) * scale, values));
        const auto y = static_cast<std::size_t>(classOf(gradient / gradientHigh, gradients));
        ++histogram.counts[y * static_cast<std::size_t>(values) + x];
        ++histogram.voxels;
    });
    return histogram;
}

std::pair<double, double> histogramAxis(const DataRange& range) {
    // As much again as the window to its sides, at most.
    const double reach = range.high - range.low;
    return {std::max(range.minimum, range.low - reach), std::min(range.maximum, range.high + reach)};
}

double quantile(const Histogram& histogram, double part) {
    std::vector<std::int64_t> columns(static_cast<std::size_t>(histogram.values));
    for (std::size_t i = 0; i < histogram.counts.size(); ++i)
        columns[i % columns.size()] += histogram.counts[i];
    double left = std::clamp(part, 0.0, 1.0) * static_cast<double>(histogram.voxels);
    const double width = (histogram.high - histogram.low) / histogram.values;
    for (std::size_t x = 0; x < columns.size(); ++x) {
        const auto count = static_cast<double>(columns[x]);
        if (left <= count && count > 0.0) return histogram.low + width * (static_cast<double>(x) + left / count);
        left -= count;
    }
    return histogram.high;
}

Json toJson(const Histogram& histogram) {
    Json json = {{"values", histogram.values}, {"gradients", histogram.gradients},        {"low", histogram.low},
                 {"high", histogram.high},     {"gradient_high", histogram.gradientHigh}, {"voxels", histogram.voxels},
                 {"counts", histogram.counts}};
    const std::int64_t most =
        histogram.counts.empty() ? 0 : *std::max_element(histogram.counts.begin(), histogram.counts.end());
    Json shown = Json::array();
    for (const std::int64_t count : histogram.counts) {
        const double part =
            most > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most)) : 0.0;
        shown.push_back(std::round(1e4 * part) / 1e4);
    }
    json["log"] = std::move(shown);
    return json;
}

} // namespace apeiron::volume
