#include "volume/raw.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace apeiron::volume {
namespace {

constexpr const char* kExample =
    "write it as 128x128x64:uint16, followed by :big, :offset=512, :channels=2, :times=10, "
    ":spacing=0.5x0.5x1.2 as needed";

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::BadInput, what, "raw form", kExample);
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == separator) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

std::uint64_t wholeNumber(const std::string& text, std::uint64_t most) {
    if (text.empty() || text.size() > 15 || text.find_first_not_of("0123456789") != std::string::npos)
        refuse(inQuotes(text) + " is not a whole number");
    const std::uint64_t value = std::strtoull(text.c_str(), nullptr, 10);
    if (value > most) refuse(fmt::format("{} is too large", text));
    return value;
}

double length(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(value) || value <= 0)
        refuse(inQuotes(text) + " is not a length above 0");
    return value;
}

std::optional<VoxelType> typeOf(const std::string& name) {
    for (const VoxelType type : {VoxelType::UInt8, VoxelType::Int8, VoxelType::UInt16, VoxelType::Int16,
                                 VoxelType::Float16, VoxelType::Float32})
        if (name == toString(type)) return type;
    return std::nullopt;
}

bool machineIsBigEndian() {
    const std::uint16_t one = 1;
    unsigned char first = 0;
    std::memcpy(&first, &one, 1);
    return first == 0;
}

/// One of the parts behind size and type.
void readOption(const std::string& part, RawForm& form) {
    const std::size_t equals = part.find('=');
    const std::string name = part.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : part.substr(equals + 1);
    if (part == "big" || part == "little") {
        form.bigEndian = part == "big";
    } else if (name == "offset") {
        form.offset = wholeNumber(value, std::uint64_t{1} << 48);
    } else if (name == "channels") {
        form.channels = static_cast<int>(wholeNumber(value, 4));
    } else if (name == "times") {
        form.timePoints = static_cast<int>(wholeNumber(value, 1'000'000));
    } else if (name == "spacing") {
        const std::vector<std::string> lengths = split(value, 'x');
        if (lengths.size() != 3) refuse(inQuotes(value) + " is not three lengths");
        for (int axis = 0; axis < 3; ++axis)
            form.spacing[axis] = length(lengths[static_cast<std::size_t>(axis)]);
    } else {
        refuse(inQuotes(part) + " means nothing here");
    }
}

} // namespace

RawForm parseRawForm(std::string_view text) {
    const std::vector<std::string> parts = split(text, ':');
    const std::vector<std::string> edges = split(parts.front(), 'x');
    if (edges.size() != 3) refuse(inQuotes(parts.front()) + " is not three sizes");
    RawForm form;
    for (int axis = 0; axis < 3; ++axis)
        form.size[axis] = static_cast<int>(wholeNumber(edges[static_cast<std::size_t>(axis)], kMaxEdge));
    if (parts.size() < 2) refuse("the type of the voxels is missing");
    const std::optional<VoxelType> type = typeOf(parts[1]);
    if (!type) refuse(inQuotes(parts[1]) + " is none of uint8, int8, uint16, int16, float16, float32");
    form.type = *type;
    for (std::size_t i = 2; i < parts.size(); ++i)
        readOption(parts[i], form);
    byteSize(form, std::numeric_limits<std::size_t>::max());
    return form;
}

std::size_t byteSize(const RawForm& form, std::size_t limit) {
    return byteSize(form.size, form.type, form.channels, form.timePoints, limit);
}

Volume makeVolume(const RawForm& form, std::size_t limit) {
    Volume volume = makeVolume(form.size, form.type, form.channels, form.timePoints, limit);
    centre(volume, form.spacing);
    return volume;
}

void toNativeOrder(Volume& volume, const RawForm& form) {
    if (form.bigEndian == machineIsBigEndian()) return;
    const auto width = static_cast<std::ptrdiff_t>(bytesPerVoxel(volume.type));
    for (auto at = volume.voxels.begin(); width > 1 && at != volume.voxels.end(); at += width)
        std::reverse(at, at + width);
}

Volume fromRaw(const RawForm& form, std::string_view bytes) {
    const std::size_t wanted = byteSize(form, std::numeric_limits<std::size_t>::max());
    if (bytes.size() < form.offset || bytes.size() - form.offset < wanted)
        throw Error(ErrorKind::BadInput,
                    fmt::format("there are {} bytes, and {} are needed", bytes.size(), form.offset + wanted));
    Volume volume = makeVolume(form, wanted);
    std::memcpy(volume.voxels.data(), bytes.data() + form.offset, wanted);
    toNativeOrder(volume, form);
    return volume;
}

} // namespace apeiron::volume
