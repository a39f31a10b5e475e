#pragma once

#include "volume/bricked.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace apeiron::volume {

/// From where a volume is seen.
struct BrickView {
    glm::dmat4 toCamera{1.0}; ///< grid coordinates (voxel (i, j, k) is the box from there to + 1) -> camera space,
                              ///< which looks along -z [world units]
    double voxel = 1.0;       ///< longest side of a voxel of level 0 [world units]
    double extent = 1.0;      ///< height of the picture at distance 1, or anywhere in parallel projection [world units]
    double aspect = 1.0;      ///< of the picture: width / height
    int height = 1;           ///< of the picture [px]
    bool orthographic = false;

    bool operator==(const BrickView&) const = default;
};

/// How large a voxel of level 0 in a brick looks, where it is nearest, and whether the picture shows the brick.
struct BrickSight {
    double pixels = 0.0;   ///< [px]
    double distance = 0.0; ///< [world units]
    bool inPicture = false;
};
BrickSight sightOf(const BrickView& view, const BrickKey& key);

/// For each brick of level 0, whether something is to be seen in it or within a brick of ranges around it: gradients
/// look at neighbours. @param seen for each brick of ranges: above 0 where something is
std::vector<std::uint8_t> neededBricks(const BrickPyramid& pyramid, const BrickRanges& ranges,
                                       std::span<const float> seen);

/// The bricks that are wanted besides those of the base level, the most urgent first, no two of which show the same
/// place; the same for the same arguments.
///
/// Where all that is needed fits, that is the finest level of all of it, and then of everything, where that fits too.
/// Otherwise the coarse brick whose voxels look largest is replaced by its finer ones, again and again, until the
/// voxels of all are no larger than pixels or the room is used up; what is outside the picture counts a quarter.
/// @param needed of neededBricks() @param capacity bricks that there is room for
std::vector<BrickKey> chooseBricks(const BrickPyramid& pyramid, int base, std::span<const std::uint8_t> needed,
                                   const BrickView& view, std::size_t capacity);

} // namespace apeiron::volume
