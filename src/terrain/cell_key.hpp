#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>

namespace apeiron::terrain {

/// The name of a lattice point or cell, for hash maps. Coordinates are known modulo 2^32: far away on another path
/// there are others of the same name.
struct CellKey {
    std::int64_t level = 0;
    std::uint32_t x = 0;
    std::uint32_t y = 0;

    bool operator==(const CellKey&) const = default;
};

/// The name of a cell's child. @param digit 0 to 3: x in its first bit, y in the second
constexpr CellKey childKey(const CellKey& parent, int digit) {
    return {parent.level + 1, 2U * parent.x + static_cast<std::uint32_t>(digit & 1),
            2U * parent.y + static_cast<std::uint32_t>(digit >> 1)};
}

struct CellKeyHash {
    std::size_t operator()(const CellKey& key) const {
        // Fibonacci hashing of all three.
        const std::uint64_t cell = (static_cast<std::uint64_t>(key.y) << 32U) | key.x;
        std::uint64_t hash =
            (cell ^ (static_cast<std::uint64_t>(key.level) * 0xD6E8FEB86659FD93U)) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 32U;
        return static_cast<std::size_t>(hash);
    }
};

using CellSet = std::unordered_set<CellKey, CellKeyHash>;

} // namespace apeiron::terrain
