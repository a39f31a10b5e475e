#include "terrain/cell_cache.hpp"

namespace apeiron::terrain {

void CellCache::forgetAll() {
    nodes_.clear();
    windows_.clear();
    free_.clear();
    byKey_.clear();
    sweep_ = 0;
}

void CellCache::begin(const Shape& shape, std::uint32_t turn) {
    constexpr std::size_t kMost = 16384;
    constexpr std::size_t kSwept = 128;    // nodes looked at in a turn
    constexpr std::uint32_t kMemory = 128; // turns
    turn_ = turn;
    if (shape != shape_ || byKey_.size() > kMost) {
        forgetAll();
        shape_ = shape;
    }
    for (std::size_t i = 0; i < kSwept && !nodes_.empty(); ++i) {
        sweep_ = (sweep_ + 1) % nodes_.size();
        if (nodes_[sweep_].used && turn_ - nodes_[sweep_].seen > kMemory) remove(static_cast<std::int32_t>(sweep_));
    }
}

std::int32_t CellCache::add(const Shape& shape, const Cell& cell) {
    std::int32_t index = 0;
    if (free_.empty()) {
        index = static_cast<std::int32_t>(nodes_.size());
        nodes_.emplace_back();
        windows_.emplace_back();
    } else {
        index = free_.back();
        free_.pop_back();
    }
    Node& node = nodes_[static_cast<std::size_t>(index)];
    node = Node{};
    node.key = {cell.level, cell.x, cell.y};
    node.corner = cell.window[5];
    windows_[static_cast<std::size_t>(index)] = cell.window;
    node.bounds = heightBounds(shape, cell);
    node.seen = turn_;
    node.used = true;
    byKey_[node.key] = index;
    return index;
}

void CellCache::remove(std::int32_t index) {
    Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.parent >= 0)
        nodes_[static_cast<std::size_t>(node.parent)].children[static_cast<std::size_t>(node.digit)] = -1;
    for (const std::int32_t child : node.children) {
        if (child >= 0) nodes_[static_cast<std::size_t>(child)].parent = -1;
    }
    byKey_.erase(node.key);
    node.used = false;
    free_.push_back(index);
}

std::int32_t CellCache::node(const Shape& shape, const Cell& cell) {
    const auto found = byKey_.find({cell.level, cell.x, cell.y});
    if (found == byKey_.end()) return add(shape, cell);
    // Far away on another path there are cells of the same name: coordinates are known modulo 2^32.
    if (this->cell(found->second) == cell) return found->second;
    forgetAll();
    return add(shape, cell);
}

std::int32_t CellCache::child(const Shape& shape, std::int32_t parent, int digit) {
    const std::int32_t known = (*this)[parent].children[static_cast<std::size_t>(digit)];
    if (known >= 0) return known;
    const CellKey above = (*this)[parent].key;
    const auto found = byKey_.find({above.level + 1, 2U * above.x + static_cast<std::uint32_t>(digit & 1),
                                    2U * above.y + static_cast<std::uint32_t>(digit >> 1)});
    const std::int32_t index =
        found != byKey_.end() ? found->second : add(shape, childCell(shape, cell(parent), digit));
    nodes_[static_cast<std::size_t>(parent)].children[static_cast<std::size_t>(digit)] = index;
    nodes_[static_cast<std::size_t>(index)].parent = parent;
    nodes_[static_cast<std::size_t>(index)].digit = static_cast<std::int8_t>(digit);
    return index;
}

} // namespace apeiron::terrain
