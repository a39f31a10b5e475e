#include "terrain/cell_cache.hpp"

#include "terrain/height_detail.hpp"

namespace apeiron::terrain {
namespace {

constexpr std::int32_t kOrphan = -1;

/// The lattice points of all four children's windows.
std::array<std::int32_t, 25> childrensHeights(const Shape& shape, const Cell& parent) {
    std::array<std::uint32_t, 16> parents{};
    std::array<std::uint32_t, 25> children{};
    for (std::size_t i = 0; i < 16; ++i)
        parents[i] = static_cast<std::uint32_t>(parent.window[i]);
    // As in childCell(), for both halves along each axis.
    detail::subdivide(detail::octave(shape, parent.level + 1), shape.kernel, parents.data(), 4, parent.x - 1U,
                      parent.y - 1U, 1, 1, 5, children.data());
    std::array<std::int32_t, 25> heights{};
    for (std::size_t i = 0; i < 25; ++i)
        heights[i] = static_cast<std::int32_t>(children[i]);
    return heights;
}

/// @param key the child's
Cell childOf(const std::array<std::int32_t, 25>& heights, int digit, const CellKey& key) {
    Cell cell{key.level, key.x, key.y, {}};
    const std::size_t first = static_cast<std::size_t>(digit & 1) + 5 * static_cast<std::size_t>(digit >> 1);
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i)
            cell.window[4 * j + i] = heights[first + 5 * j + i];
    }
    return cell;
}

} // namespace

void CellCache::forgetAll() {
    roots_.clear();
    rootsDrawn_.clear();
    families_.clear();
    kin_.clear();
    seen_.clear();
    drawn_.clear();
    free_.clear();
    byParent_.clear();
    sweep_ = 0;
}

void CellCache::begin(const Shape& shape, std::uint32_t turn) {
    constexpr std::size_t kMost = 4096;    // families
    constexpr std::size_t kSwept = 32;     // of them looked at in a turn
    constexpr std::uint32_t kMemory = 128; // turns
    turn_ = turn;
    if (shape != shape_ || byParent_.size() > kMost) {
        forgetAll();
        shape_ = shape;
    }
    for (std::size_t i = 0; i < kSwept && !families_.empty(); ++i) {
        sweep_ = (sweep_ + 1) % families_.size();
        if (turn_ - seen_[sweep_] > kMemory && kin_[sweep_].used) remove(static_cast<std::int32_t>(sweep_));
    }
}

void CellCache::setRoots(const std::vector<Cell>& cells) {
    const bool same = cells.size() == roots_.size() &&
                      std::equal(cells.begin(), cells.end(), roots_.begin(),
                                 [](const Cell& cell, const Root& root) { return cell == root.cell; });
    if (same) return;
    for (const Root& root : roots_) {
        if (root.node.children >= 0) kin_[static_cast<std::size_t>(root.node.children)].parent = {kOrphan, kOrphan};
    }
    roots_.clear();
    for (const Cell& cell : cells)
        roots_.push_back({cell, {cell.window[5], heightBounds(shape_, cell), -1}});
    rootsDrawn_.assign(cells.size(), turn_ - 1U);
}

std::int32_t CellCache::add() {
    if (!free_.empty()) {
        const std::int32_t family = free_.back();
        free_.pop_back();
        return family;
    }
    families_.emplace_back();
    kin_.emplace_back();
    seen_.push_back(turn_);
    drawn_.emplace_back();
    return static_cast<std::int32_t>(families_.size()) - 1;
}

void CellCache::fill(std::int32_t family, const CellKey& parent, const std::array<std::int32_t, 25>& heights) {
    const auto at = static_cast<std::size_t>(family);
    kin_[at] = {parent, {kOrphan, kOrphan}, true, heights};
    drawn_[at].fill(turn_ - 1U);
    for (int digit = 0; digit < 4; ++digit) {
        const Cell cell = childOf(heights, digit, childKey(parent, digit));
        families_[at].nodes[static_cast<std::size_t>(digit)] = {cell.window[5], heightBounds(shape_, cell), -1};
    }
}

void CellCache::cutOff(std::int32_t family) {
    const auto at = static_cast<std::size_t>(family);
    if (const Place parent = kin_[at].parent; parent.digit != kOrphan) node(parent).children = -1;
    kin_[at].parent = {kOrphan, kOrphan};
    for (Node& node : families_[at].nodes) {
        if (node.children >= 0) kin_[static_cast<std::size_t>(node.children)].parent = {kOrphan, kOrphan};
        node.children = -1;
    }
}

void CellCache::remove(std::int32_t family) {
    cutOff(family);
    Kin& kin = kin_[static_cast<std::size_t>(family)];
    byParent_.erase(kin.parentKey);
    kin.used = false;
    free_.push_back(family);
}

std::int32_t CellCache::findChildren(Place place, const CellKey& key) {
    const std::array<std::int32_t, 25> heights = childrensHeights(shape_, cell(place, key));
    const auto [found, isNew] = byParent_.try_emplace(key, -1);
    if (isNew) {
        found->second = add();
        fill(found->second, key, heights);
    } else if (kin_[static_cast<std::size_t>(found->second)].heights != heights) {
        // Far away on another path there are cells of the same name: coordinates are known modulo 2^32.
        cutOff(found->second);
        fill(found->second, key, heights);
    }
    const std::int32_t family = found->second;
    seen_[static_cast<std::size_t>(family)] = turn_;
    // It may have been known to a node that is a root now, or was one.
    Kin& kin = kin_[static_cast<std::size_t>(family)];
    if (kin.parent.digit != kOrphan) node(kin.parent).children = -1;
    kin.parent = place;
    node(place).children = family;
    return family;
}

Cell CellCache::cell(Place place, const CellKey& key) const {
    if (place.family < 0) return roots_[static_cast<std::size_t>(place.digit)].cell;
    return childOf(kin_[static_cast<std::size_t>(place.family)].heights, place.digit, key);
}

} // namespace apeiron::terrain
