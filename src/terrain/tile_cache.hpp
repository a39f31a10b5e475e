#pragma once

#include "gpu/kernel_cache.hpp"
#include "terrain/cell_key.hpp"
#include "terrain/selection.hpp"

#include <vector>

namespace apeiron::terrain {

/// Heights and slopes of tiles in GPU memory, the last used ones kept. Two textures of equal squares: heights (fine,
/// coarse) as integers, and their slopes as halves. Needs its context current.
class TileCache {
  public:
    /// Who computes heights.
    enum class Maker { Cpu, Gpu };

    /// @param tileLevels a tile has 2^tileLevels cells along a side
    /// @param bytes most GPU memory that tiles take @throws Error (BadInput) when fewer than 16 tiles fit.
    TileCache(const gpu::Context& context, int tileLevels, std::int64_t bytes);

    int tileLevels() const { return tileLevels_; }
    std::int64_t bytes() const { return bytes_; }
    /// Tiles that there is room for.
    int capacity() const { return across_ * across_; }

    /// Begins a picture: tiles that are asked for from now on stay until the next one. Forgets all for another shape.
    void begin(const Shape& shape);

    /// Whether a tile is there.
    bool has(const Tile& tile) const { return slotOf({tile.level, tile.x, tile.y}) >= 0; }

    /// The first texel of a tile's square, which stays for this picture; (-1, -1) when it is not there.
    glm::ivec2 find(const Tile& tile);

    /// The same, but makes it when it is not there. What a picture needs and has it must have asked find() for before:
    /// the room for new tiles is that of others. @param where the place that it was selected for
    /// @returns (-1, -1) when every tile is in use
    glm::ivec2 place(const Tile& tile, const Place& where, Maker maker, gpu::KernelCache& kernels, gpu::Stage stage);

    const gpu::Texture& heights() const { return heights_; } ///< RG32I: fine and coarse (see VertexHeights)
    /// RGBA16F: slopes along x and y of the fine and of the coarse heights [cells' heights per cell]
    const gpu::Texture& slopes() const { return slopes_; }

    std::size_t cached() const { return entries_.size(); }
    std::int64_t generated() const { return generated_; } ///< since it was made

  private:
    /// A tile that is there. Those of all slots form a ring, in which the last used one comes after the newest.
    struct Entry {
        CellKey key;
        std::uint32_t turn; ///< of its last use
        std::int32_t newer; ///< slots of its neighbours in the ring
        std::int32_t older;
    };
    /// -1: not there.
    std::int32_t slotOf(const CellKey& key) const;
    /// Where in the index a key is, or would be.
    std::size_t position(const CellKey& key) const;
    void forget(const CellKey& key);
    /// Takes an entry out of the ring / makes it the newest.
    void unlink(std::int32_t slot);
    void link(std::int32_t slot);
    glm::ivec2 squareAt(int slot) const { return glm::ivec2(slot % across_, slot / across_) * side_; }
    void make(const Cell& cell, glm::ivec2 at, Maker maker, gpu::KernelCache& kernels, gpu::Stage stage);

    int tileLevels_;
    std::int64_t bytes_;
    int side_;   ///< vertices along a tile's side
    int across_; ///< tiles along the textures' side
    gpu::Texture heights_;
    gpu::Texture slopes_;
    gpu::Targets heightTargets_;
    Shape shape_;
    std::uint32_t turn_ = 0;
    std::vector<Entry> entries_; ///< by slots
    std::int32_t newest_ = -1;   ///< slot of the entry that was used last
    /// Slots by their keys' hashes, with open addressing: a picture asks for a thousand tiles, and pointers to follow
    /// would be as many misses of the processor's caches. A power of two of them, at most half in use; -1: none.
    std::vector<std::int32_t> index_;
    std::vector<VertexHeights> vertices_; ///< scratch
    std::vector<float> slopeTexels_;
    std::vector<std::int32_t> heightTexels_;
    std::int64_t generated_ = 0;
};

} // namespace apeiron::terrain
