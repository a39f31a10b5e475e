#include "volume/defaults.hpp"

#include "volume/grid.hpp"
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

/// From translucent and dark to dense and bright, with a light of its own, as what fluoresces has.
Json glowing(const char* dark, const char* middle, const char* bright, double most) {
    Json points = Json::array({point(0.0, dark, 0.0), point(0.2, dark, 0.03 * most), point(0.6, middle, 0.4 * most),
                               point(1.0, bright, most)});
    points[1]["emission"] = 0.2;
    points[2]["emission"] = 0.9;
    points[3]["emission"] = 1.8;
    return {{"window", "data"}, {"points", points}};
}

/// Colours of microscopes' channels by what is stained; another one for each where the names say nothing.
Json microscopyTransfer(const Volume& volume) {
    struct Stain {
        std::array<std::string_view, 4> words;
        Json transfer;
    };
    static const std::vector<Stain> kStains{
        {{"bright", "transmitted", "phase", "dic"}, {{"points", Json::array({point(0.0, "#ffffff", 0.0)})}}},
        {{"dna", "dapi", "hoechst", "nucle"}, glowing("#16307a", "#4a7dff", "#8fb4ff", 1.0)},
        {{"memb", "wga", "cellmask", "lipid"}, glowing("#6a1f5c", "#d85fb8", "#ff8fdc", 0.03)},
        {{"struct", "gfp", "tubul", "actin"}, glowing("#12603a", "#3fd58a", "#7dffb4", 0.05)},
        {{"mito", "tomm", "rfp", "cherry"}, glowing("#7a3a12", "#f59a3c", "#ffc46a", 1.0)},
    };
    static const std::vector<Json> kOthers{
        glowing("#12603a", "#3fd58a", "#7dffb4", 0.3), glowing("#6a1f5c", "#e05fc0", "#ff8fdc", 0.3),
        glowing("#7a5a12", "#f5c03c", "#ffe070", 0.3), glowing("#16307a", "#4a7dff", "#8fb4ff", 0.3)};
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

/// What scanners add to Hounsfield units so that nothing is below 0.
constexpr double kScannerOffset = 1024.0;

/// Whether whole numbers from 0 to about 4095 are a CT's without its intercept: much air near 0, and much soft tissue
/// where water is.
bool isScannerCt(const Volume& volume) {
    const ChannelStatistics s = statistics(volume);
    const bool whole = volume.type == VoxelType::UInt16 || volume.type == VoxelType::Int16;
    if (!whole || volume.channels != 1 || s.min < 0.0 || s.max < 1500.0 || s.max > 5000.0) return false;
    const Histogram histogram = valueHistogram(volume, 0.0, 5000.0, 50);
    const auto share = [&](int first, int last) {
        std::int64_t sum = 0;
        for (int x = first; x < last; ++x)
            sum += histogram.at(x);
        return static_cast<double>(sum) / static_cast<double>(histogram.voxels);
    };
    return share(0, 3) > 0.2 && share(9, 12) > 0.1 && share(4, 8) < share(9, 12);
}

/// A preset with its values moved.
Json shifted(const char* name, double offset) {
    for (const TransferPreset& preset : transferPresets()) {
        if (preset.name != name) continue;
        Json transfer = preset.transfer;
        for (Json& point : transfer.at("points"))
            point.at("value") = point.at("value").get<double>() + offset;
        return transfer;
    }
    return "layers";
}

/// By the distribution of the values that are no background: where it only falls, a quantity that fades away; where
/// most of it is low, fine and thin things; else solid ones.
Json unknownTransfer(const Volume& volume, const DataRange& range) {
    constexpr int kBins = 32;
    const Histogram histogram = valueHistogram(volume, range.low, std::max(range.high, range.low + 1e-9), kBins);
    std::int64_t object = 0;
    std::int64_t low = 0;
    for (int x = 1; x < kBins; ++x) { // the first holds the background as well
        object += histogram.at(x);
        if (x < kBins / 4) low += histogram.at(x);
    }
    if (object == 0) return "layers";
    bool rises = false;
    std::int64_t least = histogram.at(1);
    for (int x = 2; x < kBins - 1; ++x) { // nor does the last count, with all that is above
        least = std::min(least, histogram.at(x));
        rises = rises || (histogram.at(x) > least + least / 2 && histogram.at(x) > object / 30);
    }
    if (!rises) return "simulation";
    return 2 * low > object ? "layers" : "solid";
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
        if (inHounsfieldUnits(volume, ranges)) return "ct_skin_and_bone";
        return isScannerCt(volume) ? shifted("ct_skin_and_bone", kScannerOffset) : Json("layers");
    case Modality::Mri:
        return "mri";
    case Modality::Microscopy:
        return microscopyTransfer(volume);
    case Modality::Simulation:
        return "simulation";
    case Modality::Unknown:
        break;
    }
    if (isScannerCt(volume)) return shifted("ct_skin_and_bone", kScannerOffset);
    return unknownTransfer(volume, ranges.front());
}

bool isUpsideDown(const Volume& volume, const std::vector<DataRange>& ranges, int time) {
    if (volume.oriented || volume.size.z < 8) return false;
    switch (guessModality(volume, statistics(volume))) {
    case Modality::Microscopy:
    case Modality::Simulation:
        return false;
    default:
        break;
    }
    // Parts of the lowest and the highest slice that are above a value.
    std::vector<float> slice(static_cast<std::size_t>(volume.size.x) * static_cast<std::size_t>(volume.size.y));
    const auto covered = [&](int z, double value) {
        readSlice(volume, time, 0, z, slice);
        const double stored = (value - volume.intercept) / (volume.slope != 0.0 ? volume.slope : 1.0);
        const auto count =
            std::count_if(slice.begin(), slice.end(), [stored](float v) { return static_cast<double>(v) > stored; });
        return static_cast<double>(count) / static_cast<double>(slice.size());
    };
    const int last = volume.size.z - 1;
    constexpr double kCut = 0.05; // of the face, at least
    const bool scanner = isScannerCt(volume);
    if (scanner || inHounsfieldUnits(volume, ranges)) {
        // Of a head more is bone than of a neck.
        const double water = scanner ? kScannerOffset : 0.0;
        const auto bone = [&](int z) { return covered(z, water + 250.0) / std::max(covered(z, water - 300.0), kCut); };
        return bone(0) > 2.5 * bone(last);
    }
    const double low = ranges.front().low;
    return covered(last, low) > kCut && covered(last, low) > 4.0 * covered(0, low);
}

glm::dvec3 frontDirection(Modality modality, glm::dvec3 extent) {
    const bool flat = extent.z < 0.35 * std::min(extent.x, extent.y);
    if (flat || modality == Modality::Microscopy) return glm::normalize(glm::dvec3(0.22, -0.75, flat ? 1.6 : 0.9));
    return glm::normalize(glm::dvec3(0.38, -1.0, 0.22));
}

} // namespace apeiron::volume
