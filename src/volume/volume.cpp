#include "volume/volume.hpp"

#include "core/error.hpp"
#include "volume/voxels.hpp"

#include <fmt/format.h>

namespace apeiron::volume {

const char* toString(VoxelType type) {
    constexpr std::array<const char*, 6> kNames{"uint8", "int8", "uint16", "int16", "float16", "float32"};
    return kNames[static_cast<std::size_t>(type)];
}

const char* toString(Modality modality) {
    constexpr std::array<const char*, 5> kNames{"unknown", "ct", "mri", "microscopy", "simulation"};
    return kNames[static_cast<std::size_t>(modality)];
}

std::size_t byteSize(glm::ivec3 size, VoxelType type, int channels, int timePoints, std::size_t limit) {
    if (size.x < 1 || size.y < 1 || size.z < 1 || size.x > kMaxEdge || size.y > kMaxEdge || size.z > kMaxEdge)
        throw Error(ErrorKind::BadInput, fmt::format("a volume of {}x{}x{} voxels cannot be", size.x, size.y, size.z),
                    {}, fmt::format("every edge has 1 to {}", kMaxEdge));
    if (channels < 1 || channels > 4)
        throw Error(ErrorKind::BadInput, fmt::format("{} channels are not 1 to 4", channels));
    if (timePoints < 1) throw Error(ErrorKind::BadInput, fmt::format("{} points of time are too few", timePoints));
    // At most 2^48 voxels, times 16 bytes: no overflow until time comes in.
    const auto frame = static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) *
                       static_cast<std::uint64_t>(size.z) * bytesPerVoxel(type) * static_cast<std::uint64_t>(channels);
    const auto times = static_cast<std::uint64_t>(timePoints);
    if (frame > limit / times)
        throw Error(
            ErrorKind::BadInput,
            fmt::format("{}x{}x{} {} voxels, {} channels, {} points of time need {:.4g} GB, and there are {:.4g} GB",
                        size.x, size.y, size.z, toString(type), channels, timePoints,
                        static_cast<double>(frame) * timePoints / 1e9, static_cast<double>(limit) / 1e9));
    return static_cast<std::size_t>(frame * times);
}

Volume makeVolume(glm::ivec3 size, VoxelType type, int channels, int timePoints, std::size_t limit) {
    Volume volume;
    volume.voxels.resize(byteSize(size, type, channels, timePoints, limit));
    volume.size = size;
    volume.type = type;
    volume.channels = channels;
    volume.timePoints = timePoints;
    return volume;
}

double valueAt(const Volume& volume, glm::ivec3 voxel, int channel, int time) {
    const std::size_t index = (static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(volume.size.y) +
                               static_cast<std::size_t>(voxel.y)) *
                                  static_cast<std::size_t>(volume.size.x) +
                              static_cast<std::size_t>(voxel.x);
    const double stored = visitVoxels(volume, channelOffset(volume, channel, time) + index,
                                      [](const auto* v) { return static_cast<double>(number(*v)); });
    return volume.slope * stored + volume.intercept;
}

void centre(Volume& volume, glm::dvec3 spacing) {
    volume.indexToWorld = glm::dmat4(1);
    for (int axis = 0; axis < 3; ++axis) {
        volume.indexToWorld[axis][axis] = spacing[axis];
        volume.indexToWorld[3][axis] = -0.5 * (volume.size[axis] - 1) * spacing[axis];
    }
}

} // namespace apeiron::volume
