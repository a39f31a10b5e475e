#pragma once

#include "gpu/kernel_cache.hpp"
#include "terrain/cell_key.hpp"
#include "terrain/selection.hpp"

#include <list>
#include <unordered_map>

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
    bool has(const Tile& tile) const { return index_.contains({tile.level, tile.x, tile.y}); }

    /// The first texel of a tile's square, which stays for this picture; (-1, -1) when it is not there.
    glm::ivec2 find(const Tile& tile);

    /// The same, but makes it when it is not there. What a picture needs and has it must have asked find() for before:
    /// the room for new tiles is that of others. @returns (-1, -1) when every tile is in use
    glm::ivec2 place(const Tile& tile, Maker maker, gpu::KernelCache& kernels, gpu::Stage stage);

    const gpu::Texture& heights() const { return heights_; } ///< RG32I: fine and coarse (see VertexHeights)
    /// RGBA16F: slopes along x and y of the fine and of the coarse heights [cells' heights per cell]
    const gpu::Texture& slopes() const { return slopes_; }

    std::size_t cached() const { return index_.size(); }
    std::int64_t generated() const { return generated_; } ///< since it was made

  private:
    struct Entry {
        CellKey key;
        int slot;
        std::uint32_t turn;
    };
    glm::ivec2 squareAt(int slot) const { return glm::ivec2(slot % across_, slot / across_) * side_; }
    void make(const Tile& tile, glm::ivec2 at, Maker maker, gpu::KernelCache& kernels, gpu::Stage stage);

    int tileLevels_;
    std::int64_t bytes_;
    int side_;   ///< vertices along a tile's side
    int across_; ///< tiles along the textures' side
    gpu::Texture heights_;
    gpu::Texture slopes_;
    gpu::Targets heightTargets_;
    Shape shape_;
    std::uint32_t turn_ = 0;
    std::list<Entry> entries_; ///< most recently used first
    std::unordered_map<CellKey, std::list<Entry>::iterator, CellKeyHash> index_;
    std::vector<VertexHeights> vertices_; ///< scratch
    std::vector<float> slopeTexels_;
    std::vector<std::int32_t> heightTexels_;
    std::int64_t generated_ = 0;
};

} // namespace apeiron::terrain
