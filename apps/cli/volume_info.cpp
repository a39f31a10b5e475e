#include "volume_info.hpp"

#include "core/error.hpp"
#include "core/json.hpp"
#include "io/volume_file.hpp"
#include "table.hpp"
#include "volume/defaults.hpp"
#include "volume/histogram.hpp"
#include "volume/orientation.hpp"
#include "volume/reading.hpp"
#include "volume/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace apeiron::cli {
namespace {

using volume::ChannelStatistics;
using volume::Volume;

template <class Vector> Json asJson(const Vector& v) {
    return {v.x, v.y, v.z};
}

Json channelJson(const Volume& volume, int channel, int time) {
    const ChannelStatistics s = volume::statistics(volume, channel, time);
    Json percentiles = Json::object();
    for (std::size_t i = 0; i < volume::kPercentiles.size(); ++i)
        percentiles[fmt::format("{}", volume::kPercentiles[i])] = s.percentiles[i];
    const auto index = static_cast<std::size_t>(channel);
    return {{"channel", channel},
            {"time", time},
            {"name", index < volume.channelNames.size() ? volume.channelNames[index] : ""},
            {"min", s.min},
            {"max", s.max},
            {"mean", s.mean},
            {"deviation", s.deviation},
            {"most_frequent", s.mostFrequent},
            {"not_finite", s.nonFinite},
            {"percentiles", percentiles}};
}

Json volumeJson(const Volume& volume) {
    // Of a long series the first point of time is enough to know it by.
    Json values = Json::array();
    for (int channel = 0; channel < volume.channels; ++channel)
        values.push_back(channelJson(volume, channel, 0));
    const volume::Orientation orientation = volume::orientationOf(volume);
    Json axes = Json::array();
    for (int axis = 0; axis < 3; ++axis)
        axes.push_back(asJson(glm::dvec3(volume.indexToWorld[axis])));
    return {{"name", volume.name},
            {"size", asJson(volume.size)},
            {"type", volume::toString(volume.type)},
            {"bytes", volume.voxels.size()},
            {"channels", volume.channels},
            {"times", volume.timePoints},
            {"time_step", volume.timeStep},
            {"spacing", asJson(volume::spacing(volume))},
            {"axes", axes},
            {"origin", asJson(glm::dvec3(volume.indexToWorld[3]))},
            {"orientation", orientation.letters},
            {"oblique", orientation.oblique},
            {"shear", orientation.shear},
            {"mirrored", orientation.mirrored},
            {"modality", volume::toString(volume::guessModality(volume, volume::statistics(volume)))},
            {"unit", volume.unit},
            {"values", values},
            {"messages", volume.messages}};
}

std::string orientationText(const Volume& volume) {
    const volume::Orientation o = volume::orientationOf(volume);
    std::string text = fmt::format("axes to {} (LPS)", o.letters);
    if (o.oblique > 0.05) text += fmt::format(", oblique by {:.3g} degrees", o.oblique);
    if (o.shear > 0.05) text += fmt::format(", sheared by {:.3g} degrees", o.shear);
    if (o.mirrored) text += ", mirrored";
    return text;
}

std::string numbers(glm::dvec3 v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

/// @throws Error (BadInput) outside of the volume
volume::Reading readAt(const Volume& volume, const std::vector<double>& at) {
    const glm::dvec3 place(at[0], at[1], at[2]);
    if (const auto reading = volume::readingAt(volume, place)) return *reading;
    const auto corner = [&](glm::dvec3 index) {
        return numbers(glm::dvec3(volume.indexToWorld * glm::dvec4(index, 1.0)));
    };
    throw Error(ErrorKind::BadInput, fmt::format("{} mm is outside of the volume", numbers(place)), "--at",
                fmt::format("its corners are at {} and {} mm", corner(glm::dvec3(-0.5)),
                            corner(glm::dvec3(volume.size) - 0.5)));
}

void printReading(const volume::Reading& reading) {
    std::vector<Row> rows{
        {"position", numbers(reading.position) + " mm"},
        {"voxel", fmt::format("({}, {}, {}), counted from 0", reading.voxel.x, reading.voxel.y, reading.voxel.z)}};
    for (std::size_t i = 0; i < reading.values.size(); ++i) {
        std::string text = fmt::format("{:.6g}", reading.values[i]);
        if (!reading.unit.empty()) text += " " + reading.unit;
        if (i < reading.names.size() && !reading.names[i].empty()) text += " (" + reading.names[i] + ")";
        rows.push_back({fmt::format("channel {}", i), text});
    }
    fmt::print("{}", alignedTable(rows));
}

/// A channel's histograms, of values alone and of values and gradient magnitudes.
struct Histograms {
    volume::Histogram values;
    volume::Histogram joint;
};

Histograms histogramsOf(const Volume& volume, const volume::DataRange& range, int channel, int classes, int rows) {
    const auto [low, high] = volume::histogramAxis(range);
    return {volume::valueHistogram(volume, low, high, classes, channel),
            volume::jointHistogram(volume, low, high, range.gradientHigh, classes, rows, channel)};
}

/// How high or dark a class is shown, 0 to 1: counts differ by many powers of ten.
double shownPart(std::int64_t count, std::int64_t most) {
    return most > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most)) : 0.0;
}

std::int64_t mostOf(const volume::Histogram& histogram) {
    return *std::max_element(histogram.counts.begin(), histogram.counts.end());
}

/// Bars of the values above, and the plane of values and gradient magnitudes below.
void printHistograms(const Volume& volume) {
    constexpr int kColumns = 72;
    constexpr int kBars = 6;
    constexpr int kRows = 12;
    const std::vector<volume::DataRange> ranges = volume::dataRanges(volume);
    for (int channel = 0; channel < volume.channels; ++channel) {
        const volume::DataRange& range = ranges[static_cast<std::size_t>(channel)];
        const auto [values, joint] = histogramsOf(volume, range, channel, kColumns, kRows);
        const std::int64_t most = mostOf(values);
        const std::string unit = volume.unit.empty() ? "" : " " + volume.unit;
        fmt::print("\nchannel {}: {} voxels, heights by log(1 + n), of {} at most\n", channel, values.voxels, most);
        for (int row = kBars; row > 0; --row) {
            constexpr std::array<std::string_view, 9> kBlocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
            std::string line;
            for (int x = 0; x < kColumns; ++x) {
                const double filled = kBars * shownPart(values.at(x), most) - (row - 1);
                line += kBlocks[static_cast<std::size_t>(std::clamp(std::lround(8.0 * filled), 0L, 8L))];
            }
            fmt::print("  {}\n", line);
        }
        const std::string left = fmt::format("{:.6g}", values.low);
        const std::string right = fmt::format("{:.6g}{}", values.high, unit);
        fmt::print("  {}{:>{}}\n", left, right, kColumns - static_cast<int>(left.size()));
        fmt::print("  gradient magnitudes up to {:.6g}{}/mm, over the same values\n", joint.gradientHigh, unit);
        for (int row = kRows - 1; row >= 0; --row) {
            constexpr std::string_view kInk = " .:-=+*#%@";
            std::string line;
            for (int x = 0; x < kColumns; ++x) {
                const double part = shownPart(joint.at(x, row), mostOf(joint));
                line += kInk[static_cast<std::size_t>(std::lround(part * (kInk.size() - 1)))];
            }
            fmt::print("  {}\n", line);
        }
    }
}

Json histogramsJson(const Volume& volume) {
    constexpr int kValues = 256;
    constexpr int kGradients = 64;
    const std::vector<volume::DataRange> ranges = volume::dataRanges(volume);
    Json channels = Json::array();
    for (int channel = 0; channel < volume.channels; ++channel) {
        const auto [values, joint] =
            histogramsOf(volume, ranges[static_cast<std::size_t>(channel)], channel, kValues, kGradients);
        channels.push_back({{"channel", channel}, {"values", toJson(values)}, {"joint", toJson(joint)}});
    }
    return channels;
}

void printInfo(const Volume& volume) {
    const glm::dvec3 step = volume::spacing(volume);
    const glm::dvec3 origin(volume.indexToWorld[3]);
    const ChannelStatistics first = volume::statistics(volume);
    const bool told = volume.modality != volume::Modality::Unknown;
    const std::string modality = volume::toString(volume::guessModality(volume, first));
    std::vector<Row> rows{
        {"size", fmt::format("{}x{}x{} voxels, {}, {:.4g} MB", volume.size.x, volume.size.y, volume.size.z,
                             volume::toString(volume.type), static_cast<double>(volume.voxels.size()) / 1e6)},
        {"spacing", fmt::format("{:.6g} x {:.6g} x {:.6g} mm", step.x, step.y, step.z)},
        {"extent", fmt::format("{:.6g} x {:.6g} x {:.6g} mm, first voxel at {}", step.x * volume.size.x,
                               step.y * volume.size.y, step.z * volume.size.z, numbers(origin))},
        {"orientation", orientationText(volume)},
        {"modality", modality + (told || modality == "unknown" ? "" : " (a guess)")}};
    if (!volume.unit.empty()) rows.push_back({"unit", volume.unit});
    rows.push_back({"times", volume.timeStep > 0 ? fmt::format("{}, {:.6g} s apart", volume.timePoints, volume.timeStep)
                                                 : fmt::format("{}", volume.timePoints)});
    for (int channel = 0; channel < volume.channels; ++channel) {
        const ChannelStatistics s = channel == 0 ? first : volume::statistics(volume, channel);
        const auto index = static_cast<std::size_t>(channel);
        std::string name = index < volume.channelNames.size() ? volume.channelNames[index] : "";
        if (!name.empty()) name += ": ";
        std::string text =
            fmt::format("{}{:.6g} to {:.6g}, mean {:.6g}, deviation {:.4g}", name, s.min, s.max, s.mean, s.deviation);
        if (s.nonFinite > 0) text += fmt::format(", {} not finite", s.nonFinite);
        rows.push_back({fmt::format("channel {}", channel), text});
        std::string percentiles;
        for (std::size_t i = 0; i < volume::kPercentiles.size(); ++i)
            percentiles += fmt::format("{}{} %: {:.6g}", i == 0 ? "" : ", ", volume::kPercentiles[i], s.percentiles[i]);
        rows.push_back({"", percentiles});
    }
    for (const std::string& message : volume.messages)
        rows.push_back({"note", message});
    fmt::print("{}", alignedTable(rows));
}

} // namespace

void VolumeForm::addTo(CLI::App& command) {
    command.add_option("--raw", raw, "The file is bare voxels: 128x128x64:uint16, then :big, :offset=512, ...")
        ->type_name("FORM");
    command.add_option("--grid", grid, "Which grid of an OpenVDB file")->type_name("NAME");
}

void VolumeQuestions::addTo(CLI::App& command) {
    command.add_option("--at", at, "Of a volume: its values at a place of its world [mm]")
        ->expected(3)
        ->delimiter(',')
        ->type_name("X,Y,Z");
    command.add_flag("--histogram", histogram,
                     "Of a volume: how many voxels have which values and gradient magnitudes");
}

int volumeInfo(const std::string& file, const VolumeForm& form, const VolumeQuestions& questions, bool json) {
    const Volume volume = io::readVolume({file, form.raw, form.grid, 0});
    const std::optional<volume::Reading> reading =
        questions.at.empty() ? std::nullopt : std::optional(readAt(volume, questions.at));
    if (json) {
        Json all = {{"file", file}, {"volume", volumeJson(volume)}};
        if (reading) all["at"] = toJson(*reading);
        if (questions.histogram) all["histograms"] = histogramsJson(volume);
        // A line for each of thousands of counts would be no help.
        fmt::print("{}\n", all.dump(questions.histogram ? -1 : 2, ' ', false, Json::error_handler_t::replace));
        return kDone;
    }
    if (reading) {
        printReading(*reading);
        if (!questions.histogram) return kDone;
    } else {
        printInfo(volume);
    }
    if (questions.histogram) printHistograms(volume);
    return kDone;
}

} // namespace apeiron::cli
