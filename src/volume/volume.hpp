#pragma once

#include "core/math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace apeiron::volume {

/// How a voxel is stored. Values are kept as they were measured; nothing is cut to fewer bits.
enum class VoxelType { UInt8, Int8, UInt16, Int16, Float16, Float32 };

/// What made the data: decides presets and units.
enum class Modality { Unknown, Ct, Mri, Microscopy, Simulation };

/// A grid of measured values in memory, of one or more channels and points of time.
///
/// World coordinates of patients are DICOM's LPS [mm]: +x to the patient's left, +y to the back (posterior), +z to the
/// head (superior). Readers convert from RAS. Data without any orientation keeps its own axes.
struct Volume {
    glm::ivec3 size{0}; ///< voxels along x, y, z
    int channels = 1;   ///< 1 to 4
    int timePoints = 1;
    VoxelType type = VoxelType::UInt8;
    double slope = 1; ///< value = slope * stored + intercept
    double intercept = 0;
    glm::dmat4 indexToWorld{1}; ///< centre of voxel (i, j, k) -> world [mm]; any affine map, oblique and mirrored too
    bool oriented = false;      ///< the file says how the grid lies in the patient or the world
    double timeStep = 0;        ///< between points of time [s]; 0: unknown
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

/// "uint8", "int8", "uint16", "int16", "float16", "float32".
const char* toString(VoxelType type);

/// "unknown", "ct", "mri", "microscopy", "simulation".
const char* toString(Modality modality);

/// Of a grid of this size.
inline std::size_t voxelsIn(const glm::ivec3& size) {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

/// Voxels of one channel at one point of time.
inline std::size_t voxelsPerChannel(const Volume& volume) {
    return voxelsIn(volume.size);
}

/// Distance between neighbouring voxels along the grid's own axes [mm].
inline glm::dvec3 spacing(const Volume& volume) {
    return {glm::length(glm::dvec3(volume.indexToWorld[0])), glm::length(glm::dvec3(volume.indexToWorld[1])),
            glm::length(glm::dvec3(volume.indexToWorld[2]))};
}

/// Where the first voxel of a channel at a point of time is in `voxels`, counted in voxels.
inline std::size_t channelOffset(const Volume& volume, int channel, int time) {
    return voxelsPerChannel(volume) * (static_cast<std::size_t>(time) * static_cast<std::size_t>(volume.channels) +
                                       static_cast<std::size_t>(channel));
}

/// How many bytes a volume has. @throws Error (BadInput) for sizes below 1, channels not in 1 to 4, time points below
/// 1, an edge above kMaxEdge, and more bytes than `limit`.
std::size_t byteSize(glm::ivec3 size, VoxelType type, int channels, int timePoints, std::size_t limit);

/// No edge may be longer.
inline constexpr int kMaxEdge = 65'536;

/// A volume of zeros, with voxels of 1 mm. @throws Error as byteSize() does, before anything is allocated.
Volume makeVolume(glm::ivec3 size, VoxelType type, int channels = 1, int timePoints = 1,
                  std::size_t limit = std::numeric_limits<std::size_t>::max());

/// The value as measured (slope and intercept applied) at a voxel. @pre inside the volume
double valueAt(const Volume& volume, glm::ivec3 voxel, int channel = 0, int time = 0);

/// Puts the centre of the grid at the world's origin, axes along the world's, voxels `spacing` [mm] apart;
/// against an axis where that is negative.
void centre(Volume& volume, glm::dvec3 spacing);

} // namespace apeiron::volume
