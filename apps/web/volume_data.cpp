#include "volume_data.hpp"

#include "core/error.hpp"
#include "core/json.hpp"
#include "volume/raw.hpp"

#include <fmt/format.h>

#include <array>
#include <limits>

namespace apeiron::web {
namespace {

using volume::Volume;
using volume::VoxelType;

VoxelType typeOf(const std::string& name) {
    for (const VoxelType type : {VoxelType::UInt8, VoxelType::Int8, VoxelType::UInt16, VoxelType::Int16,
                                 VoxelType::Float16, VoxelType::Float32})
        if (name == volume::toString(type)) return type;
    throw Error(ErrorKind::BadInput, "voxels of type " + inQuotes(name) + " cannot be shown");
}

volume::Modality modalityOf(const std::string& name) {
    using volume::Modality;
    for (const Modality modality : {Modality::Ct, Modality::Mri, Modality::Microscopy, Modality::Simulation})
        if (name == volume::toString(modality)) return modality;
    return Modality::Unknown;
}

/// Copies the bytes, whose number must be right.
void fill(Volume& volume, std::size_t offset, const emscripten::val& voxels) {
    const auto given = voxels["length"].as<double>();
    const auto needed = static_cast<double>(offset + volume.voxels.size());
    if (given < needed)
        throw Error(ErrorKind::BadInput,
                    fmt::format("the file ends too soon: {:.0f} bytes of voxels are missing", needed - given),
                    volume.name);
    const auto start = static_cast<double>(offset);
    // (The view is taken after all allocations: memory that grows moves.)
    emscripten::val(emscripten::typed_memory_view(
                        volume.voxels.size(), reinterpret_cast<std::uint8_t*>(volume.voxels.data()))) // NOLINT: bytes
        .call<void>("set", voxels.call<emscripten::val>("subarray", start, needed));
}

Volume readForm(const std::string& name, const Json& form) {
    const auto size = form.at("size").get<std::array<int, 3>>();
    Volume volume = volume::makeVolume({size[0], size[1], size[2]}, typeOf(form.at("type").get<std::string>()),
                                       form.value("channels", 1), form.value("times", 1));
    volume.name = name;
    volume.slope = form.value("slope", 1.0);
    volume.intercept = form.value("intercept", 0.0);
    volume.oriented = form.value("oriented", false);
    volume.unit = form.value("unit", std::string());
    volume.modality = modalityOf(form.value("modality", std::string()));
    volume.channelNames = form.value("channelNames", std::vector<std::string>());
    volume.messages = form.value("messages", std::vector<std::string>());
    const auto axes = form.at("indexToWorld").get<std::array<double, 12>>(); // three axes, and where voxel 0 is
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            volume.indexToWorld[column][row] = axes[static_cast<std::size_t>(3 * column + row)];
    return volume;
}

} // namespace

Volume volumeOf(const std::string& name, const emscripten::val& voxels, const std::string& form) {
    const Json json = Json::parse(form);
    if (!json.contains("raw")) {
        Volume volume = readForm(name, json);
        fill(volume, 0, voxels);
        return volume;
    }
    const volume::RawForm raw = volume::parseRawForm(json.at("raw").get<std::string>());
    Volume volume = volume::makeVolume(raw, std::numeric_limits<std::size_t>::max());
    volume.name = name;
    fill(volume, static_cast<std::size_t>(raw.offset), voxels);
    volume::toNativeOrder(volume, raw);
    return volume;
}

} // namespace apeiron::web
