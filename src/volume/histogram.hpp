#pragma once

#include "core/json.hpp"
#include "volume/transfer_function.hpp"
#include "volume/volume.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace apeiron::volume {

/// How many voxels have which values, and which gradient magnitudes: what an editor of transfer functions shows.
///
/// Class x of the values holds those from low + (high - low) x / values to the next; what lies outside counts to the
/// first and the last. The same for gradients, from 0 to gradientHigh.
struct Histogram {
    int values = 0;    ///< classes of the value
    int gradients = 1; ///< classes of the gradient magnitude; 1: not told apart
    double low = 0.0;  ///< in value units
    double high = 1.0;
    double gradientHigh = 0.0;        ///< [value/mm]
    std::int64_t voxels = 0;          ///< that were looked at: the finite ones
    std::vector<std::int64_t> counts; ///< `gradients` rows of `values`

    std::int64_t at(int value, int gradient = 0) const {
        return counts[static_cast<std::size_t>(gradient) * static_cast<std::size_t>(values) +
                      static_cast<std::size_t>(value)];
    }
};

/// Voxels of a large volume that are looked at, at most: every n-th along each axis then.
inline constexpr std::int64_t kHistogramVoxels = 4'000'000;

/// Values of a channel from `low` to `high`. @pre low < high, classes > 0
Histogram valueHistogram(const Volume& volume, double low, double high, int classes, int channel = 0, int time = 0);

/// Gradient magnitudes alone, from 0 to the largest [value/mm], by central differences in the world's space.
Histogram gradientHistogram(const Volume& volume, int classes, int channel = 0, int time = 0);

/// Values × gradient magnitudes. Borders between two materials are arcs in it (Kindlmann & Durkin 1998).
/// @pre low < high, gradientHigh > 0
Histogram jointHistogram(const Volume& volume, double low, double high, double gradientHigh, int values, int gradients,
                         int channel = 0, int time = 0);

/// The values over which a channel is shown to people: all of them, unless few far away (metal in a CT, a hot pixel)
/// would press everything else together.
std::pair<double, double> histogramAxis(const DataRange& range);

/// The value below which a part (0 to 1) of a histogram's voxels lies, linear inside a class.
double quantile(const Histogram& histogram, double part);

/// {"values", "gradients", "low", "high", "gradient_high", "voxels", "counts": [...]}, and "log": counts by log(1 + n)
/// from 0 to 1, as they are shown.
Json toJson(const Histogram& histogram);

} // namespace apeiron::volume
