#pragma once

#include "volume/volume.hpp"

namespace apeiron::io::volumes {

/// What files store, of which our voxels are a part.
enum class Element { UInt8, Int8, UInt16, Int16, Float16, Float32, UInt32, Int32, UInt64, Int64, Float64 };

std::size_t bytesOf(Element element);

/// Sizes as files tell them: anything may be in there.
struct Shape {
    std::uint64_t x = 1, y = 1, z = 1;
    std::uint64_t channels = 1;
    std::uint64_t times = 1;
};

/// Bytes of such elements. @throws Error (Io) when a size is 0 or out of range, and when they and their voxels need
/// more than `limit`.
std::size_t requireMemory(const Shape& shape, Element element, std::size_t limit);

/// Makes the elements the volume's voxels: as they are, or integers of more than 16 bits as 16 bits where they fit,
/// else as 32-bit floats, with a message where that rounds. @param elements in the volume's order (channels one after
/// the other)
void setVoxels(volume::Volume& volume, const Shape& shape, Element element, std::vector<std::byte> elements);

/// From all channels of a voxel side by side to one channel after the other, `kept` of `channels` at each point of
/// time.
std::vector<std::byte> separated(const std::vector<std::byte>& elements, std::size_t bytes, std::size_t voxels,
                                 std::size_t channels, std::size_t kept, std::size_t times);

/// At most 4; a message says what is left out.
std::uint64_t keptChannels(std::uint64_t channels, volume::Volume& volume);

} // namespace apeiron::io::volumes
