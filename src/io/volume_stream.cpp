#include "io/volume_stream.hpp"

#include "core/json.hpp"

#include <cstring>

namespace apeiron::io {
namespace {

using volume::Volume;

constexpr std::uint64_t kLongestHeader = std::uint64_t{16} << 20;

bool sendHeader(std::FILE* to, const Json& header) {
    const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::uint64_t length = text.size();
    return std::fwrite(&length, sizeof length, 1, to) == 1 &&
           std::fwrite(text.data(), 1, text.size(), to) == text.size();
}

Json receiveHeader(std::FILE* from) {
    std::uint64_t length = 0;
    if (std::fread(&length, sizeof length, 1, from) != 1 || length > kLongestHeader) return nullptr;
    std::string text(length, '\0');
    if (std::fread(text.data(), 1, text.size(), from) != text.size()) return nullptr;
    return Json::parse(text, nullptr, false);
}

} // namespace

bool sendVolume(std::FILE* to, const Volume& volume) {
    Json matrix = Json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            matrix.push_back(volume.indexToWorld[column][row]);
    const Json header{{"size", {volume.size.x, volume.size.y, volume.size.z}},
                      {"channels", volume.channels},
                      {"times", volume.timePoints},
                      {"type", static_cast<int>(volume.type)},
                      {"slope", volume.slope},
                      {"intercept", volume.intercept},
                      {"matrix", matrix},
                      {"oriented", volume.oriented},
                      {"time_step", volume.timeStep},
                      {"modality", static_cast<int>(volume.modality)},
                      {"unit", volume.unit},
                      {"name", volume.name},
                      {"channel_names", volume.channelNames},
                      {"messages", volume.messages}};
    return sendHeader(to, header) &&
           std::fwrite(volume.voxels.data(), 1, volume.voxels.size(), to) == volume.voxels.size() &&
           std::fflush(to) == 0;
}

bool sendError(std::FILE* to, const Error& error) {
    return sendHeader(to, Json{{"kind", static_cast<int>(error.kind())}, {"error", error.what()}}) &&
           std::fflush(to) == 0;
}

Volume receiveVolume(std::FILE* from, std::size_t limit) {
    const Json header = receiveHeader(from);
    if (!header.is_object()) throw Error(ErrorKind::Io, "cannot be read: it is damaged, or larger than the memory");
    if (header.contains("error"))
        throw Error(static_cast<ErrorKind>(header.at("kind").get<int>()), header.at("error").get<std::string>());
    const auto size = header.at("size").get<std::vector<int>>();
    Volume volume = volume::makeVolume({size.at(0), size.at(1), size.at(2)},
                                       static_cast<volume::VoxelType>(header.at("type").get<int>()),
                                       header.at("channels").get<int>(), header.at("times").get<int>(), limit);
    volume.slope = header.at("slope").get<double>();
    volume.intercept = header.at("intercept").get<double>();
    for (int i = 0; i < 16; ++i)
        volume.indexToWorld[i / 4][i % 4] = header.at("matrix").at(static_cast<std::size_t>(i)).get<double>();
    volume.oriented = header.at("oriented").get<bool>();
    volume.timeStep = header.at("time_step").get<double>();
    volume.modality = static_cast<volume::Modality>(header.at("modality").get<int>());
    volume.unit = header.at("unit").get<std::string>();
    volume.name = header.at("name").get<std::string>();
    volume.channelNames = header.at("channel_names").get<std::vector<std::string>>();
    volume.messages = header.at("messages").get<std::vector<std::string>>();
    if (std::fread(volume.voxels.data(), 1, volume.voxels.size(), from) != volume.voxels.size())
        throw Error(ErrorKind::Io, "reading it broke off");
    return volume;
}

} // namespace apeiron::io
