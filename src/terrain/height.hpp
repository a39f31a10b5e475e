#pragma once

#include "core/math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Exact fractal heights: value noise on a quadtree of square cells, after Tunković 2018 ("Prikaz fraktalnog šuma
// višerezolucijskom kvadratnom rešetkom u stvarnom vremenu"), in integers modulo 2^32.
//
// Lattice points of level n are (X, Y); a cell of level n is the square between (X, Y) and (X + 1, Y + 1). The heights
// of level n are integers of 2^-kFractionBits of the level's cell size, so that they never leave their range however
// deep the level. All sums wrap around: differences of neighbours are right as signed 32-bit numbers, whatever the
// heights are. A height is a function of (shape, level, X, Y) alone: cells that share a point agree on it.
namespace apeiron::terrain {

/// One cell size is 2^kFractionBits units of height.
inline constexpr int kFractionBits = 12;

/// How a level's heights follow from those of the level before.
enum class Kernel {
    BSpline,  ///< subdivision of the bicubic B-spline: smooth at every depth
    Bilinear, ///< the thesis' linear interpolation: has creases
};

/// What decides all heights of a terrain.
struct Shape {
    Kernel kernel = Kernel::BSpline;
    std::uint32_t seed = 0;
    /// Hurst exponent in thousandths, 1 to 1000. 1000: each octave has half the amplitude of the one before, so that
    /// slope is a random walk over the octaves. Less: each octave has 2^-(hurst/1000) of the amplitude (self-affine
    /// terrain), and levels change their vertical unit such that slopes stay as they are at any depth (heightStep()).
    int hurst = 1000;

    bool operator==(const Shape&) const = default;
};

/// A cell and the heights that decide all heights in it.
struct Cell {
    std::int64_t level = 0;
    std::uint32_t x = 0; ///< modulo 2^32
    std::uint32_t y = 0;
    /// Heights of the level's lattice points: [4 * j + i] is that of (x - 1 + i, y - 1 + j). The cell's own corners are
    /// 5, 6, 9, 10.
    std::array<std::int32_t, 16> window{};

    bool operator==(const Cell&) const = default;
};

/// (a - b) of two heights of one level: right as long as the true difference fits into 32 bits.
constexpr std::int32_t heightDifference(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

/// Binary orders by which the unit of height shrinks from `level` - 1 to `level` (1, or 0 at the levels where a
/// self-affine terrain changes its vertical unit). A height h of the level before is 2^heightStep * h in units of
/// `level`. @pre level >= 1
int heightStep(const Shape& shape, std::int64_t level);

/// The sum of heightStep() over levels 1 to `level`: a unit of height of `level` is 2^-heightExponent(level) units of
/// level 0. Equals `level` where hurst is 1000.
std::int64_t heightExponent(const Shape& shape, std::int64_t level);

/// Amplitude of the noise that `level` adds [units of `level`]: it is in [-amplitude, amplitude). 2^kFractionBits to
/// twice that.
std::uint32_t amplitude(const Shape& shape, std::int64_t level);

/// The cell (x, y) of level 0, from which all others come. Its heights are noise alone.
Cell rootCell(const Shape& shape, std::uint32_t x = 0, std::uint32_t y = 0);

/// One of a cell's four children: digit = bx + 2 by, with bx = 1 the half of larger x, by = 1 that of larger y.
/// @pre 0 <= digit < 4
Cell childCell(const Shape& shape, const Cell& cell, int digit);

/// What no height within a cell, at any level, is outside of: relative to the cell's corner window[5] [units of the
/// cell's level]. Conservative: the hull of the window and the largest sum of all octaves that follow.
struct Bounds {
    std::int32_t least = 0;
    std::int32_t most = 0;
};
Bounds heightBounds(const Shape& shape, const Cell& cell);

/// Most levels below its own cell that a tile's vertices are at: 2^8 cells along a side.
inline constexpr int kMaxTileLevels = 8;

/// Heights of a vertex: of the mesh itself, and of the mesh with twice the spacing at the vertex that this one slides
/// to (geomorph()): its coordinates with the last bit cleared. Both in units of the vertices' level.
using VertexHeights = glm::ivec2;

/// The heights of all vertices of a tile: the lattice points of level cell.level + levels in the cell, and `margin`
/// more around it.
/// @param levels 1 to kMaxTileLevels: the tile has N = 2^levels cells along a side
/// @param margin 0 or 1
/// @param vertices (N + 1 + 2 margin)^2 of them, x fastest
/// The computation on the CPU; bit for bit what terrain/glsl/height.glsl computes.
void tileHeights(const Shape& shape, const Cell& cell, int levels, int margin, std::span<VertexHeights> vertices);

/// What the GLSL of terrain/glsl/height.glsl is told of the levels below a cell: element i is about level
/// cell.level + 1 + i.
struct LevelUniforms {
    std::array<std::int32_t, kMaxTileLevels> hash{};      ///< the bits of the level's part of the hash
    std::array<std::int32_t, kMaxTileLevels> amplitude{}; ///< amplitude()
    std::array<std::int32_t, kMaxTileLevels> step{};      ///< heightStep()
};
LevelUniforms levelUniforms(const Shape& shape, std::int64_t level);

} // namespace apeiron::terrain
