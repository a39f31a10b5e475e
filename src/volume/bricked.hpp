#pragma once

#include "volume/grid.hpp"
#include "volume/large.hpp"

#include <vector>

// Volumes that are larger than the memory that may be used for them: a pyramid of levels, each half as fine as the one
// before, cut into bricks that are read when they are needed (after LaMar, Hamann & Joy 1999; Crassin et al. 2009).
namespace apeiron::volume {

/// A brick of a level; bricks are counted along every axis.
struct BrickKey {
    int level = 0;
    glm::ivec3 brick{0};
    bool operator==(const BrickKey&) const = default;
    bool operator<(const BrickKey& other) const;
    /// The brick of a coarser level that covers this one.
    BrickKey ancestor(int coarser) const { return {coarser, brick >> (coarser - level)}; }
};

/// The levels of a volume. A voxel of level l is the mean of the 2^l x 2^l x 2^l voxels of level 0 that it covers, of
/// as many as there are at the far ends.
class BrickPyramid {
  public:
    static constexpr int kEdge = 32;          ///< voxels of a brick
    static constexpr int kStored = kEdge + 2; ///< with one voxel of its neighbours on each side, for interpolation
    static constexpr std::size_t kStoredVoxels = std::size_t{kStored} * kStored * kStored;

    explicit BrickPyramid(glm::ivec3 size) : size_(size) {}

    glm::ivec3 size() const { return size_; }
    /// The coarsest level is one brick.
    int levels() const;
    /// Voxels of a level.
    glm::ivec3 sizeOf(int level) const;
    /// Bricks of a level.
    glm::ivec3 bricksOf(int level) const;
    /// How many these are.
    std::size_t brickCount(int level) const;

  private:
    glm::ivec3 size_;
};

/// The values of a brick with its border, kStored³ stored values, x fastest; beyond the volume its outermost voxels are
/// repeated. @throws Error (Io)
std::vector<float> brickValues(const LargeVolume& volume, const BrickKey& key, int channel, int time);

/// What is known of a large volume after everything was read once.
struct Survey {
    int level = 0; ///< of the overview
    Volume
        overview; ///< one point of time of a coarser level, in the volume's own type; what it lies between is rounded
    BrickRanges ranges; ///< of all voxels
};

/// Reads one point of time, slice by slice. @param level of the overview @param side of the bricks of which ranges are
/// wanted. @throws Error (Io)
Survey survey(const LargeVolume& volume, int time, int level, int side);

/// Ranges of all that can be seen in each brick where values of a coarser level are interpolated: of all voxels in
/// reach of that. They cover those of finer levels: a majorant stays one while finer bricks come in.
BrickRanges coarserRanges(const BrickRanges& ranges, int level);

} // namespace apeiron::volume
