#pragma once

#include "volume/brick_choice.hpp"
#include "volume/brick_slots.hpp"

#include <map>

namespace apeiron::volume {

/// A point of time of a large volume on the GPU, as much of it as a limit of memory allows: bricks of several levels in
/// one 3D texture (the atlas), and for each brick of level 0 where its values are (the pages). One coarse level is
/// there always; finer bricks come in as they are wanted, and what is shown is whole at any time. Needs its context
/// current.
class BrickStream {
  public:
    /// Reads everything once: afterwards the base level is there. @param memory for all of it, on the GPU and beside
    /// it [bytes] @param side of the bricks of which ranges are known, at least: larger ones where they would take
    /// too much
    /// @throws Error (BadInput) when the memory is too little for anything, (Io), (Gpu)
    BrickStream(const gpu::Context& context, LargeVolume volume, int time, std::size_t memory, int side);

    const LargeVolume& volume() const { return volume_; }
    /// A coarser volume in memory, for statistics.
    const std::shared_ptr<const Volume>& overview() const { return overview_; }
    const BrickRanges& ranges() const { return ranges_; } ///< of all voxels
    const TexelForm& form() const { return form_; }

    /// From now on the best bricks for that view are wanted. What has to go for them is not shown any more.
    /// @param needed of neededBricks() @returns whether what is shown changed
    bool want(const BrickView& view, std::vector<std::uint8_t> needed);

    /// Loads wanted bricks for at most so long [s], one at least. @returns whether what is shown changed: what came in
    /// is shown when all is there, and before that when it is worth it. @throws Error (Io)
    bool load(double seconds);

    /// Whether load() has more to do.
    bool busy() const { return slots_.missing() > 0; }

    gpu::Texture3D& atlas() { return atlas_; }
    const gpu::Texture3D& atlas() const { return atlas_; }
    /// For each brick of level 0: grid coordinates * w + xyz are the place in the atlas [texels].
    const gpu::Texture3D& pages() const { return pages_; }

    /// Ranges of what is shown now, for majorants. @param seen of the ranges of all voxels, above 0 where there is
    /// something to be seen: elsewhere those are right, however coarse what is shown is
    BrickRanges shownRanges(std::span<const float> seen) const;

    /// Names and values of now.
    std::vector<std::pair<std::string, double>> counters() const;

  private:
    void upload(const BrickKey& key, std::size_t slot);
    glm::ivec3 placeOf(std::size_t slot) const;
    /// Shows the best there is of what is wanted. @returns whether that is something else than before
    bool publish();

    const gpu::Context& context_;
    LargeVolume volume_;
    int time_;
    std::shared_ptr<const Volume> overview_; ///< the base level ...
    LargeVolume coarse_;                     ///< ... for reading
    BrickRanges ranges_;
    std::map<int, BrickRanges> coarserRanges_; ///< by level
    BrickPyramid pyramid_;
    int base_ = 0;
    TexelForm form_;
    glm::ivec3 grid_{1}; ///< places of the atlas along its axes
    BrickSlots slots_{0};
    gpu::Texture3D atlas_;
    gpu::Texture3D pages_;

    std::vector<std::uint8_t> targets_; ///< of each brick of level 0: the level that is wanted there
    std::vector<std::uint8_t> shown_;   ///< the level that is shown there
    std::vector<std::size_t> shownSlots_;
    std::size_t wanted_ = 0;
    std::size_t arrived_ = 0; ///< since what is shown changed last
    std::size_t loaded_ = 0;  ///< all in all
    std::size_t bytes_ = 0;   ///< on the GPU and beside it
};

} // namespace apeiron::volume
