#pragma once

#include "terrain/cell_key.hpp"
#include "terrain/height.hpp"

#include <unordered_map>
#include <vector>

namespace apeiron::terrain {

/// A quadtree of cells that were looked at of late, with their windows and bounds, so that a picture computes only
/// those that are new. Bounded: what was not seen for long goes.
///
/// Between two pictures a processor's caches are used for other things. So what a walk down the tree reads of a cell is
/// little, and the four children of one are a line of memory.
class CellCache {
  public:
    /// What a walk down the tree reads of a cell. Its name is known from the way that led there.
    struct Node {
        std::int32_t corner = 0; ///< the window's height 5, that of the cell's corner
        Bounds bounds;
        std::int32_t children = -1; ///< the family of its children; -1: not known
    };
    /// The four children of a cell.
    using Family = std::array<Node, 4>;

    /// One of a family's cells, or a root.
    struct Place {
        std::int32_t family = -1; ///< -1: a root
        std::int32_t digit = 0;   ///< of a root its number

        bool operator==(const Place&) const = default;
    };

    /// A cell of the coarsest level of a walk.
    struct Root {
        Cell cell;
        Node node;
    };

    /// Begins a turn; forgets all for another shape, and some that were not seen for long.
    void begin(const Shape& shape, std::uint32_t turn);

    /// Makes these cells the roots. Indices of families stay valid until the next begin().
    void setRoots(const std::vector<Cell>& cells);
    const std::vector<Root>& roots() const { return roots_; }

    /// The children of a cell. @param key its name
    std::int32_t children(Place place, const CellKey& key) {
        const std::int32_t known = node(place).children;
        return known >= 0 ? known : findChildren(place, key);
    }

    const Family& operator[](std::int32_t family) const { return families_[static_cast<std::size_t>(family)].nodes; }
    /// A cell with its window. @param key its name
    Cell cell(Place place, const CellKey& key) const;

    /// Reads a family ahead of its use. @param family may be -1
    void fetch(std::int32_t family) const {
        if (family >= 0) __builtin_prefetch(&families_[static_cast<std::size_t>(family)]);
    }

    void see(std::int32_t family) { seen_[static_cast<std::size_t>(family)] = turn_; }
    void draw(Place place) { drawnAt(place) = turn_; }
    bool drawnInTurn(Place place, std::uint32_t turn) const {
        return (place.family < 0
                    ? rootsDrawn_[static_cast<std::size_t>(place.digit)]
                    : drawn_[static_cast<std::size_t>(place.family)][static_cast<std::size_t>(place.digit)]) == turn;
    }

    /// Cells in memory.
    std::size_t size() const { return 4 * byParent_.size(); }

  private:
    struct alignas(64) Line {
        Family nodes;
    };
    /// What is known of a family beside its nodes.
    struct Kin {
        CellKey parentKey;
        Place parent; ///< that knows the family; of an orphan {-1, -1}
        bool used = false;
        std::array<std::int32_t, 25> heights{}; ///< of all four windows: 5 x 5 lattice points
    };

    Node& node(Place place) {
        return place.family < 0
                   ? roots_[static_cast<std::size_t>(place.digit)].node
                   : families_[static_cast<std::size_t>(place.family)].nodes[static_cast<std::size_t>(place.digit)];
    }
    std::uint32_t& drawnAt(Place place) {
        return place.family < 0 ? rootsDrawn_[static_cast<std::size_t>(place.digit)]
                                : drawn_[static_cast<std::size_t>(place.family)][static_cast<std::size_t>(place.digit)];
    }
    std::int32_t findChildren(Place place, const CellKey& key);
    std::int32_t add();
    void fill(std::int32_t family, const CellKey& parent, const std::array<std::int32_t, 25>& heights);
    void remove(std::int32_t family);
    /// Parent and children of a family know it no more.
    void cutOff(std::int32_t family);
    void forgetAll();

    Shape shape_;
    std::uint32_t turn_ = 0;
    std::vector<Root> roots_;
    std::vector<std::uint32_t> rootsDrawn_;
    std::vector<Line> families_;
    std::vector<Kin> kin_;
    std::vector<std::uint32_t> seen_;                 ///< the turn of the last visit
    std::vector<std::array<std::uint32_t, 4>> drawn_; ///< the turn in which it was drawn last
    std::vector<std::int32_t> free_;
    std::unordered_map<CellKey, std::int32_t, CellKeyHash> byParent_;
    std::size_t sweep_ = 0; ///< the next family to look at
};

} // namespace apeiron::terrain
