#pragma once

#include "terrain/cell_key.hpp"
#include "terrain/height.hpp"

#include <unordered_map>
#include <vector>

namespace apeiron::terrain {

/// A quadtree of cells that were looked at of late, with their windows and bounds, so that a picture computes only
/// those that are new. Bounded: what was not seen for long goes.
class CellCache {
  public:
    /// What a walk down the tree reads: one line of a processor's cache. The windows lie elsewhere.
    struct alignas(64) Node {
        CellKey key;
        std::int32_t corner = 0; ///< the window's height 5, that of the cell's corner
        Bounds bounds;
        std::array<std::int32_t, 4> children{-1, -1, -1, -1}; ///< -1: not known
        std::int32_t parent = -1;
        std::uint32_t seen = 0;  ///< the turn of the last visit
        std::uint32_t drawn = 0; ///< the turn in which it was drawn last
        std::int8_t digit = 0;   ///< which child of the parent
        bool used = false;
    };

    /// Begins a turn; forgets all for another shape, and some that were not seen for long.
    void begin(const Shape& shape, std::uint32_t turn);

    /// The node of a cell; forgets all when another terrain's cell is there under its name. Indices stay valid within
    /// a turn.
    std::int32_t node(const Shape& shape, const Cell& cell);
    std::int32_t child(const Shape& shape, std::int32_t parent, int digit);

    const Node& operator[](std::int32_t index) const { return nodes_[static_cast<std::size_t>(index)]; }
    Cell cell(std::int32_t index) const {
        const CellKey& key = (*this)[index].key;
        return {key.level, key.x, key.y, windows_[static_cast<std::size_t>(index)]};
    }
    void see(std::int32_t index) { nodes_[static_cast<std::size_t>(index)].seen = turn_; }
    void draw(std::int32_t index) { nodes_[static_cast<std::size_t>(index)].drawn = turn_; }
    bool drawnInTurn(std::int32_t index, std::uint32_t turn) const { return (*this)[index].drawn == turn; }

    std::size_t size() const { return byKey_.size(); }

  private:
    std::int32_t add(const Shape& shape, const Cell& cell);
    void remove(std::int32_t index);
    void forgetAll();

    Shape shape_;
    std::uint32_t turn_ = 0;
    std::vector<Node> nodes_;
    std::vector<std::array<std::int32_t, 16>> windows_; ///< of the nodes' cells
    std::vector<std::int32_t> free_;
    std::unordered_map<CellKey, std::int32_t, CellKeyHash> byKey_;
    std::size_t sweep_ = 0; ///< the next node to look at
};

} // namespace apeiron::terrain
