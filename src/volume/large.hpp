#pragma once

#include "volume/volume.hpp"

#include <functional>
#include <memory>

namespace apeiron::volume {

/// A box of voxels: `first` inclusive, `size` voxels along every axis.
struct VoxelBox {
    glm::ivec3 first{0};
    glm::ivec3 size{0};
};

/// Reads stored values (no slope, no intercept) of a box of a channel at a point of time, x fastest; what is no finite
/// number becomes 0. The box is inside the volume. @throws Error (Io)
using BoxReader = std::function<void(const VoxelBox& box, int channel, int time, float* to)>;

/// A volume whose voxels are read in parts, when they are wanted.
struct LargeVolume {
    Volume form; ///< everything but the voxels
    BoxReader read;
};

/// A volume in memory, for those who read in parts. Keeps it alive.
LargeVolume inParts(std::shared_ptr<const Volume> volume);

/// Where a coarser grid lies, each of whose voxels stands for 2^level voxels along every axis of a grid.
glm::dmat4 coarserIndexToWorld(const glm::dmat4& indexToWorld, int level);

} // namespace apeiron::volume
