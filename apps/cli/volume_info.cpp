#include "volume_info.hpp"

#include "core/json.hpp"
#include "io/volume_file.hpp"
#include "table.hpp"
#include "volume/orientation.hpp"
#include "volume/statistics.hpp"

#include <fmt/format.h>

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
        {"extent",
         fmt::format("{:.6g} x {:.6g} x {:.6g} mm, first voxel at ({:.6g}, {:.6g}, {:.6g})", step.x * volume.size.x,
                     step.y * volume.size.y, step.z * volume.size.z, origin.x, origin.y, origin.z)},
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

int volumeInfo(const std::string& file, const VolumeForm& form, bool json) {
    const Volume volume = io::readVolume({file, form.raw, form.grid, 0});
    if (json) {
        const Json all = {{"file", file}, {"volume", volumeJson(volume)}};
        fmt::print("{}\n", all.dump(2, ' ', false, Json::error_handler_t::replace));
    } else {
        printInfo(volume);
    }
    return kDone;
}

} // namespace apeiron::cli
