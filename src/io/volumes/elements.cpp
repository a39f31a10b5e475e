#include "io/volumes/elements.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace apeiron::io::volumes {
namespace {

using volume::Volume;
using volume::VoxelType;

template <class From, class To> std::vector<std::byte> converted(const std::vector<std::byte>& from) {
    const std::size_t count = from.size() / sizeof(From);
    std::vector<std::byte> to(count * sizeof(To));
    for (std::size_t i = 0; i < count; ++i) {
        From value{};
        std::memcpy(&value, from.data() + i * sizeof(From), sizeof(From));
        const auto result = static_cast<To>(value);
        std::memcpy(to.data() + i * sizeof(To), &result, sizeof(To));
    }
    return to;
}

template <class From> void setWide(Volume& volume, const std::vector<std::byte>& elements, const char* name) {
    const std::size_t count = elements.size() / sizeof(From);
    const auto at = [&elements](std::size_t i) {
        From value{};
        std::memcpy(&value, elements.data() + i * sizeof(From), sizeof(From));
        return value;
    };
    From low = at(0);
    From high = low;
    bool exact = true;
    for (std::size_t i = 0; i < count; ++i) {
        const From value = at(i);
        low = std::min(low, value);
        high = std::max(high, value);
        const auto single = static_cast<double>(static_cast<float>(value));
        exact = exact && (single == static_cast<double>(value) || std::isnan(single));
    }
    if constexpr (std::is_integral_v<From>) {
        if (low >= From{0} && high <= From{65535}) {
            volume.type = VoxelType::UInt16;
            volume.voxels = converted<From, std::uint16_t>(elements);
            return;
        }
        if (static_cast<double>(low) >= -32768.0 && static_cast<double>(high) <= 32767.0) {
            volume.type = VoxelType::Int16;
            volume.voxels = converted<From, std::int16_t>(elements);
            return;
        }
    }
    volume.type = VoxelType::Float32;
    volume.voxels = converted<From, float>(elements);
    if (!exact) volume.messages.push_back(fmt::format("{} values are rounded to floats of 24 bits", name));
}

} // namespace

std::size_t bytesOf(Element element) {
    constexpr std::array<std::size_t, 11> kBytes{1, 1, 2, 2, 2, 4, 4, 4, 8, 8, 8};
    return kBytes[static_cast<std::size_t>(element)];
}

std::size_t requireMemory(const Shape& shape, Element element, std::size_t limit) {
    auto bytes = static_cast<double>(bytesOf(element));
    for (const std::uint64_t n : {shape.x, shape.y, shape.z, shape.channels, shape.times}) {
        if (n < 1) throw Error(ErrorKind::Io, "its header says that it is empty: it is damaged");
        bytes *= static_cast<double>(n);
    }
    if (bytes > static_cast<double>(limit))
        throw Error(
            ErrorKind::Io,
            fmt::format(
                "its header asks for {:.4g} GB of memory ({} x {} x {} voxels, {} channels, {} points of time), and "
                "there are {:.4g} GB",
                bytes / 1e9, shape.x, shape.y, shape.z, shape.channels, shape.times, static_cast<double>(limit) / 1e9));
    if (std::max({shape.x, shape.y, shape.z}) > volume::kMaxEdge)
        throw Error(ErrorKind::Io,
                    fmt::format("an edge of {} voxels is too long", std::max({shape.x, shape.y, shape.z})));
    return static_cast<std::size_t>(bytes);
}

void setVoxels(Volume& volume, const Shape& shape, Element element, std::vector<std::byte> elements) {
    volume.size = {static_cast<int>(shape.x), static_cast<int>(shape.y), static_cast<int>(shape.z)};
    volume.channels = static_cast<int>(shape.channels);
    volume.timePoints = static_cast<int>(shape.times);
    switch (element) {
    case Element::UInt32:
        return setWide<std::uint32_t>(volume, elements, "32-bit");
    case Element::Int32:
        return setWide<std::int32_t>(volume, elements, "32-bit");
    case Element::UInt64:
        return setWide<std::uint64_t>(volume, elements, "64-bit");
    case Element::Int64:
        return setWide<std::int64_t>(volume, elements, "64-bit");
    case Element::Float64:
        return setWide<double>(volume, elements, "64-bit");
    default:
        break;
    }
    volume.type = static_cast<VoxelType>(element);
    volume.voxels = std::move(elements);
}

std::vector<std::byte> separated(const std::vector<std::byte>& elements, std::size_t bytes, std::size_t voxels,
                                 std::size_t channels, std::size_t kept, std::size_t times) {
    std::vector<std::byte> result(bytes * voxels * kept * times);
    std::byte* to = result.data();
    for (std::size_t t = 0; t < times; ++t)
        for (std::size_t c = 0; c < kept; ++c)
            for (std::size_t i = 0; i < voxels; ++i, to += bytes)
                std::memcpy(to, elements.data() + ((t * voxels + i) * channels + c) * bytes, bytes);
    return result;
}

std::uint64_t keptChannels(std::uint64_t channels, Volume& volume) {
    if (channels <= 4) return channels;
    volume.messages.push_back(fmt::format("the first 4 of {} channels are shown", channels));
    return 4;
}

} // namespace apeiron::io::volumes
