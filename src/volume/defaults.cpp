#include "volume/defaults.hpp"

#include "volume/histogram.hpp"
#include "volume/statistics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

namespace apeiron::volume {
namespace {

constexpr int kClasses = 512;

/// The class at which the background ends: to the right of the fullest class, where the counts have fallen to a small
/// part of it or rise again. 0 where there is no background at the low end.
int endOfBackground(const Histogram& histogram) {
    // Over several classes: integers and classes do not go together evenly.
    const auto smooth = [&](int x) {
        constexpr int kReach = 4;
        std::int64_t sum = 0;
        for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, kClasses - 1); ++i)
            sum += histogram.at(i);
        return static_cast<double>(sum);
    };
    int mode = 0;
    for (int x = 1; x < kClasses; ++x)
        if (smooth(x) > smooth(mode)) mode = x;
    constexpr double kBackground = 0.04; // of all voxels: fewer are no background
    if (mode > kClasses / 2 || smooth(mode) < kBackground * static_cast<double>(histogram.voxels)) return 0;
    int valley = mode;
    constexpr int kRise = 10; // classes without a lower count: a valley
    for (int x = mode; x < std::min(mode + kRise, kClasses); ++x)
        if (smooth(x) < smooth(valley)) valley = x;
    for (int x = valley; x < kClasses && x - valley < kRise; ++x) {
        if (smooth(x) < smooth(valley)) valley = x;
        if (smooth(valley) < 0.02 * smooth(mode)) break;
    }
    return valley;
}

/// The window: without the background, up to what only few of the object's voxels exceed.
void findWindow(const Volume& volume, int channel, int time, const ChannelStatistics& s, DataRange& range) {
    const double bottom = s.percentiles[0];
    const double top = s.percentiles.back();
    range.low = s.min;
    range.high = s.max;
    if (!(top > bottom)) { // a few voxels on an even ground
        if (!(range.high > range.low)) range.high = range.low + 1.0;
        return;
    }
    const Histogram histogram = valueHistogram(volume, bottom, top, kClasses, channel, time);
    const int end = endOfBackground(histogram);
    const double width = (top - bottom) / kClasses;
    range.low = end > 0 ? bottom + (end + 0.5) * width : s.percentiles[1];
    std::int64_t behind = 0;
    for (int x = 0; x < end; ++x)
        behind += histogram.at(x);
    const double background = static_cast<double>(behind) / static_cast<double>(histogram.voxels);
    constexpr double kObject = 0.995;
    range.high = quantile(histogram, background + kObject * (1.0 - background));
    if (!(range.high > range.low + 2.0 * width)) {
        range.low = bottom;
        range.high = top;
    }
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

Json point(double value, const char* color, double opacity) {
    return {{"value", value}, {"color", color}, {"opacity", opacity}};
}

/// From translucent and dark to dense and bright.
Json glowing(const char* dark, const char* middle, const char* bright, double most) {
    return {{"window", "data"},
            {"points", Json::array({point(0.0, dark, 0.0), point(0.2, dark, 0.03 * most),
                                    point(0.6, middle, 0.4 * most), point(1.0, bright, most)})}};
}

/// Colours of microscopes' channels by what is stained; another one for each where the names say nothing.
Json microscopyTransfer(const Volume& volume) {
    struct Stain {
        std::array<std::string_view, 4> words;
        Json transfer;
    };
    static const std::vector<Stain> kStains{
        {{"bright", "transmitted", "phase", "dic"}, {{"points", Json::array({point(0.0, "#ffffff", 0.0)})}}},
        {{"dna", "dapi", "hoechst", "nucle"}, glowing("#16307a", "#4a7dff", "#c4d8ff", 1.0)},
        {{"memb", "wga", "cellmask", "lipid"}, glowing("#6a1f5c", "#d85fb8", "#ffd0f2", 0.08)},
        {{"struct", "gfp", "tubul", "actin"}, glowing("#12603a", "#3fd58a", "#c8ffe2", 1.0)},
        {{"mito", "tomm", "rfp", "cherry"}, glowing("#7a3a12", "#f59a3c", "#ffe3b8", 1.0)},
    };
    static const std::vector<Json> kOthers{
        glowing("#12603a", "#3fd58a", "#c8ffe2", 1.0), glowing("#6a1f5c", "#e05fc0", "#ffd0f2", 1.0),
        glowing("#7a5a12", "#f5c03c", "#fff0c0", 1.0), glowing("#16307a", "#4a7dff", "#c4d8ff", 1.0)};
    Json transfer = Json::array();
    for (std::size_t channel = 0; channel < static_cast<std::size_t>(volume.channels); ++channel) {
        const std::string name = channel < volume.channelNames.size() ? lower(volume.channelNames[channel]) : "";
        const auto stain = std::find_if(kStains.begin(), kStains.end(), [&](const Stain& known) {
            return std::any_of(known.words.begin(), known.words.end(),
                               [&](std::string_view word) { return name.find(word) != std::string::npos; });
        });
        transfer.push_back(stain != kStains.end() ? stain->transfer : kOthers[channel % kOthers.size()]);
    }
    return transfer;
}

} // namespace

std::vector<DataRange> dataRanges(const Volume& volume, int time) {
    std::vector<DataRange> ranges;
    for (int channel = 0; channel < volume.channels; ++channel) {
        const ChannelStatistics s = statistics(volume, channel, time);
        DataRange range;
        range.minimum = s.min;
        range.maximum = s.max > s.min ? s.max : s.min + 1.0;
        findWindow(volume, channel, time, s, range);
        // Most voxels lie inside of something: gradients that matter are those of the few others.
        const Histogram gradients = gradientHistogram(volume, 4096, channel, time);
        range.gradientHigh = std::max(quantile(gradients, 0.999), 1e-6 * (range.maximum - range.minimum));
        ranges.push_back(range);
    }
    return ranges;
}

bool inHounsfieldUnits(const Volume& volume, const std::vector<DataRange>& ranges) {
    if (volume.unit == "HU") return true;
    // Without the intercept of -1024 air is not where it should be.
    return volume.modality == Modality::Ct && ranges.front().minimum < -500.0 && ranges.front().maximum > 100.0;
}

Json automaticTransfer(const Volume& volume, const std::vector<DataRange>& ranges) {
    switch (guessModality(volume, statistics(volume))) {
    case Modality::Ct:
        return inHounsfieldUnits(volume, ranges) ? "ct_skin_and_bone" : "layers";
    case Modality::Mri:
        return "mri";
    case Modality::Microscopy:
        return microscopyTransfer(volume);
    case Modality::Simulation:
        return "simulation";
    case Modality::Unknown:
        break;
    }
    return "layers";
}

glm::dvec3 frontDirection() {
    return glm::normalize(glm::dvec3(0.38, -1.0, 0.22));
}

double framingDistance(double radius, double fov) {
    constexpr double kMargin = 0.92; // a sphere around a box is larger than what is in it
    return kMargin * radius / std::sin(0.5 * fov);
}

} // namespace apeiron::volume
