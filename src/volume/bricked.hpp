#pragma once

#include "volume/volume.hpp"

#include <functional>
#include <list>
#include <map>
#include <memory>
#include <vector>

// Volumes that are larger than the memory that may be used for them: a pyramid of levels, each half as fine as the one
// before, cut into bricks that are read when they are needed (after LaMar, Hamann & Joy 1999; Crassin et al. 2009).
namespace apeiron::volume {

/// A box of voxels of level 0: `first` inclusive, `size` voxels along every axis.
struct VoxelBox {
    glm::ivec3 first{0};
    glm::ivec3 size{0};
};

/// Reads values (slope and intercept applied) of a box of level 0, x fastest. The box is inside the volume.
using BoxReader = std::function<void(const VoxelBox& box, float* to)>;

/// Reads one channel at one point of time of a volume in memory.
BoxReader boxReader(std::shared_ptr<const Volume> volume, int channel = 0, int time = 0);

/// A brick of a level; bricks are counted along every axis.
struct BrickKey {
    int level = 0;
    glm::ivec3 brick{0};
    bool operator==(const BrickKey&) const = default;
    bool operator<(const BrickKey& other) const;
    /// The brick of the next coarser level that covers this one.
    BrickKey parent() const { return {level + 1, brick >> 1}; }
};

/// Bounds of values.
struct ValueRange {
    float low = 0;
    float high = 0;
};

/// The levels of a volume. A voxel of level l is the mean of the 2^l x 2^l x 2^l voxels of level 0 that it covers, of
/// as many as there are at the far ends. Keeps the bounds of small blocks in memory (about 8 bytes for 500 voxels), and
/// no values.
class BrickPyramid {
  public:
    static constexpr int kEdge = 32;          ///< voxels of a brick
    static constexpr int kStored = kEdge + 2; ///< with one voxel of its neighbours on each side, for interpolation

    /// Reads everything once, a slab at a time, for the bounds. @pre size is that of the reader's volume
    BrickPyramid(glm::ivec3 size, BoxReader read);

    /// The coarsest level is one brick.
    int levels() const { return static_cast<int>(blocks_.size()); }
    /// Voxels of a level.
    glm::ivec3 sizeOf(int level) const;
    /// Bricks of a level.
    glm::ivec3 bricksOf(int level) const;
    /// Bytes of a brick with its border.
    static constexpr std::size_t brickBytes() { return sizeof(float) * kStored * kStored * kStored; }

    /// Bounds of everything that can be seen where the brick is, and within a voxel of its level around it: of its own
    /// voxels and of those of all finer levels, however they are interpolated. A majorant from it stays one while finer
    /// bricks come in.
    ValueRange range(const BrickKey& key) const;

    /// The values of a brick with its border, kStored³ floats, x fastest; beyond the volume its outermost voxels are
    /// repeated.
    std::vector<float> values(const BrickKey& key) const;

    /// The finest level of which all bricks fit into so many bytes; the coarsest one when none does.
    int levelThatFits(std::size_t bytes) const;

    /// The bricks that a ray sees, from front to back, each of the level whose voxels are as large as what the ray
    /// stands for there.
    /// @param origin, direction in voxels of level 0, where voxel (i, j, k) is the cube from (i, j, k) to (i + 1, j +
    /// 1, k + 1)
    /// @param spread width of the ray per unit of distance (of a pixel); 0 asks for the finest level everywhere
    std::vector<BrickKey> bricksAlong(glm::dvec3 origin, glm::dvec3 direction, double spread) const;

  private:
    /// Bounds of blocks of 8 x 8 x 8 voxels of a level.
    struct Blocks {
        glm::ivec3 size{0};
        std::vector<ValueRange> ranges;
    };
    static constexpr int kBlock = 8;

    glm::ivec3 size_;
    BoxReader read_;
    std::vector<Blocks> blocks_; ///< of every level
};

/// The bricks in memory: never more bytes than the limit, those that were not used for the longest time go first. One
/// whole level, the finest that fits into half of the memory, is always there once it was loaded, so that there is a
/// picture without holes.
class BrickCache {
  public:
    /// @pre the pyramid outlives the cache. A limit below one brick counts as one brick.
    BrickCache(const BrickPyramid& pyramid, std::size_t memory);

    /// The level that is shown first, and never leaves.
    int baseLevel() const { return baseLevel_; }

    /// Wishes for bricks, the most urgent first; they replace earlier wishes. The base level comes before all of them.
    void request(const std::vector<BrickKey>& wanted);

    /// Reads up to `most` wished bricks. @returns how many; 0 when all wishes are fulfilled, or the memory holds only
    /// what is in use
    int load(int most);

    /// The wished brick, or the finest there is that covers it; null before the base level is there. Marks it as used.
    struct Found {
        BrickKey key;
        const std::vector<float>* values = nullptr;
    };
    Found find(const BrickKey& key);

    std::size_t bytes() const { return bricks_.size() * BrickPyramid::brickBytes(); }
    std::size_t memory() const { return memory_; }

  private:
    struct Brick {
        std::vector<float> values;
        std::list<BrickKey>::iterator use; ///< place in uses_; of the base level none
    };
    bool isBase(const BrickKey& key) const { return key.level == baseLevel_; }
    bool makeRoom(const std::map<BrickKey, int>& keep);

    const BrickPyramid& pyramid_;
    std::size_t memory_;
    int baseLevel_;
    std::map<BrickKey, Brick> bricks_;
    std::list<BrickKey> uses_; ///< the last used first
    std::vector<BrickKey> wishes_;
};

} // namespace apeiron::volume
