#pragma once

#include "core/math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace apeiron::volume {

/// How a voxel is stored. Values are kept as they were measured; nothing is cut to fewer bits.
enum class VoxelType { UInt8, Int8, UInt16, Int16, Float16, Float32 };

/// What made the data: decides presets and units.
enum class Modality { Unknown, Ct, Mri, Microscopy, Simulation };

/// A grid of measured values in memory, of one or more channels and points of time.
struct Volume {
    glm::ivec3 size{0}; ///< voxels along x, y, z
    int channels = 1;   ///< 1 to 4
    int timePoints = 1;
    VoxelType type = VoxelType::UInt8;
    double slope = 1; ///< value = slope * stored + intercept
    double intercept = 0;
    glm::dmat4 indexToWorld{1}; ///< centre of voxel (i, j, k) -> world [mm]; any affine map, oblique and mirrored too
    Modality modality = Modality::Unknown;
    std::string unit; ///< of a value, "HU" for example; empty: unknown
    std::string name; ///< for messages: the file or generator it came from
    std::vector<std::string> channelNames;
    std::vector<std::string>
        messages; ///< what was done to the data on reading (resampled, sheared, ...), one sentence each
    /// x fastest, then y, z, channel, time; native byte order. size.x * size.y * size.z * channels * timePoints voxels.
    std::vector<std::byte> voxels;
};

/// Bytes of one voxel of one channel.
constexpr std::size_t bytesPerVoxel(VoxelType type) {
    constexpr std::array<std::size_t, 6> kBytes{1, 1, 2, 2, 2, 4};
    return kBytes[static_cast<std::size_t>(type)];
}

} // namespace apeiron::volume
