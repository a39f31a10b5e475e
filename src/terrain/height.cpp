#include "terrain/height.hpp"

#include "terrain/height_detail.hpp"

#include <algorithm>
#include <cassert>

namespace apeiron::terrain {
namespace {

/// floor(sqrt(x)), bit by bit: the same on every machine.
constexpr std::uint64_t integerRoot(std::uint64_t x) {
    std::uint64_t root = 0;
    for (std::uint64_t bit = std::uint64_t{1} << 31U; bit != 0; bit >>= 1U) {
        if ((root + bit) * (root + bit) <= x) root += bit;
    }
    return root;
}

/// 2^(thousandths / 1000) in units of 2^-31, for 0 to 1000, in integers alone: the product of 2^(2^-i) over the bits of
/// the exponent.
constexpr std::uint64_t computedPower(int thousandths) {
    constexpr unsigned kBits = 24;
    if (thousandths == 1000) return std::uint64_t{1} << 32U;
    const std::uint64_t exponent = ((static_cast<std::uint64_t>(thousandths) << kBits) + 500) / 1000;
    std::uint64_t factor = std::uint64_t{1} << 32U;
    std::uint64_t power = std::uint64_t{1} << 31U;
    for (unsigned i = 1; i <= kBits; ++i) {
        factor = integerRoot(factor << 31U);
        if (((exponent >> (kBits - i)) & 1U) != 0) power = power * factor >> 31U;
    }
    return power;
}

std::uint64_t powerOfTwo(int thousandths) {
    static const auto kPowers = [] {
        std::array<std::uint64_t, 1001> all{};
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] = computedPower(static_cast<int>(i));
        return all;
    }();
    return kPowers[static_cast<std::size_t>(thousandths)];
}

/// By how many thousandths of a binary order the unit of height has to grow a level.
std::int64_t growth(const Shape& shape) {
    assert(shape.hurst >= 1 && shape.hurst <= 1000);
    return 1000 - shape.hurst;
}

/// The largest sum of what follows, in units of the level, rounded up.
std::int64_t remainingOctaves(const Shape& shape, const detail::Octave& octave) {
    // The k-th next octave has amplitude a 2^(-k h): a geometric series, a / (2^h - 1); and rounding, at most one unit.
    const std::uint64_t ratio = powerOfTwo(shape.hurst) - (std::uint64_t{1} << 31U);
    const std::uint64_t sum = ((static_cast<std::uint64_t>(octave.amplitude) + 1) << 31U) / ratio;
    return static_cast<std::int64_t>(std::min<std::uint64_t>(sum, std::uint64_t{1} << 30U)) + 2;
}

} // namespace

namespace detail {

Octave octave(const Shape& shape, std::int64_t level) {
    const auto n = static_cast<std::uint32_t>(static_cast<std::uint64_t>(level));
    return {lowBias((n * 0x9E3779B9U) ^ shape.seed), amplitude(shape, level), level > 0 ? heightStep(shape, level) : 1};
}

void rootHeights(const Shape& shape, std::uint32_t x, std::uint32_t y, int count, std::int32_t* heights) {
    const Octave octave = detail::octave(shape, 0);
    const auto side = static_cast<std::uint32_t>(count);
    for (std::uint32_t j = 0; j < side; ++j) {
        const std::uint32_t row = octave.row(y + j);
        for (std::uint32_t i = 0; i < side; ++i)
            *heights++ = static_cast<std::int32_t>(octave.noise(row, x + i));
    }
}

void subdivide(const Octave& octave, Kernel kernel, const std::uint32_t* parents, std::size_t stride, std::uint32_t x,
               std::uint32_t y, int firstX, int firstY, int count, std::uint32_t* children) {
    // A row of parents' weighted sums along y, then each child's along x: 64 h in all.
    const std::uint32_t outer = outerWeight(kernel);
    const std::uint32_t inner = 8U - 2U * outer;
    constexpr std::size_t kMost = (std::size_t{1} << kMaxTileLevels) + 8;
    std::array<std::uint32_t, kMost> sums; // not cleared: that would take longer than a small block
    const int halves = (firstX + count - 1) / 2 + 2;
    const auto columns = static_cast<std::size_t>(halves);
    assert(columns <= kMost && firstX >= 1 && firstY >= 1);
    for (int j = 0; j < count; ++j) {
        const int down = firstY + j;
        const auto jj = static_cast<std::size_t>(down);
        const std::uint32_t* middle = parents + stride * (jj / 2);
        if (jj % 2 == 0) {
            const std::uint32_t* before = middle - stride;
            const std::uint32_t* after = middle + stride;
            for (std::size_t i = 0; i < columns; ++i)
                sums[i] = inner * middle[i] + outer * (before[i] + after[i]);
        } else {
            const std::uint32_t* after = middle + stride;
            for (std::size_t i = 0; i < columns; ++i)
                sums[i] = 4U * (middle[i] + after[i]);
        }
        const std::uint32_t row = octave.row(2U * y + static_cast<std::uint32_t>(jj));
        const std::uint32_t firstColumn = 2U * x;
        for (int i = 0; i < count; ++i) {
            const int across = firstX + i;
            const auto ii = static_cast<std::size_t>(across);
            const std::size_t m = ii / 2;
            const std::uint32_t sum =
                ii % 2 == 0 ? inner * sums[m] + outer * (sums[m - 1] + sums[m + 1]) : 4U * (sums[m] + sums[m + 1]);
            children[static_cast<std::size_t>(j) * static_cast<std::size_t>(count) + static_cast<std::size_t>(i)] =
                childHeight(sum, middle[m], octave.step) +
                octave.noise(row, firstColumn + static_cast<std::uint32_t>(ii));
        }
    }
}

} // namespace detail

std::int64_t heightExponent(const Shape& shape, std::int64_t level) {
    return level - level * growth(shape) / 1000;
}

int heightStep(const Shape& shape, std::int64_t level) {
    assert(level >= 1);
    return static_cast<int>(heightExponent(shape, level) - heightExponent(shape, level - 1));
}

std::uint32_t amplitude(const Shape& shape, std::int64_t level) {
    const auto thousandths = static_cast<int>(level * growth(shape) % 1000);
    return static_cast<std::uint32_t>((powerOfTwo(thousandths) + (1U << 18U)) >> (31U - kFractionBits));
}

Cell rootCell(const Shape& shape, std::uint32_t x, std::uint32_t y) {
    Cell cell{0, x, y, {}};
    detail::rootHeights(shape, x - 1U, y - 1U, 4, cell.window.data());
    return cell;
}

Cell childCell(const Shape& shape, const Cell& cell, int digit) {
    assert(digit >= 0 && digit < 4);
    const int bx = digit & 1;
    const int by = digit >> 1;
    const detail::Octave octave = detail::octave(shape, cell.level + 1);
    std::array<std::uint32_t, 16> parents{};
    std::array<std::uint32_t, 16> children{};
    for (std::size_t i = 0; i < 16; ++i)
        parents[i] = static_cast<std::uint32_t>(cell.window[i]);
    // Counted from the window's first point, the child's window begins at 2 (x - 1) + 1 + bx.
    detail::subdivide(octave, shape.kernel, parents.data(), 4, cell.x - 1U, cell.y - 1U, 1 + bx, 1 + by, 4,
                      children.data());
    Cell child{
        cell.level + 1, 2U * cell.x + static_cast<std::uint32_t>(bx), 2U * cell.y + static_cast<std::uint32_t>(by), {}};
    for (std::size_t i = 0; i < 16; ++i)
        child.window[i] = static_cast<std::int32_t>(children[i]);
    return child;
}

Bounds heightBounds(const Shape& shape, const Cell& cell) {
    std::int64_t least = 0;
    std::int64_t most = 0;
    const bool bilinear = shape.kernel == Kernel::Bilinear;
    for (std::size_t i = 0; i < 16; ++i) {
        if (bilinear && i != 5 && i != 6 && i != 9 && i != 10) continue;
        const std::int64_t difference = heightDifference(cell.window[i], cell.window[5]);
        least = std::min(least, difference);
        most = std::max(most, difference);
    }
    const std::int64_t rest = remainingOctaves(shape, detail::octave(shape, cell.level));
    constexpr std::int64_t kMost = std::int64_t{1} << 30U;
    return {static_cast<std::int32_t>(std::max(least - rest, -kMost)),
            static_cast<std::int32_t>(std::min(most + rest, kMost))};
}

void tileHeights(const Shape& shape, const Cell& cell, int levels, int margin, std::span<VertexHeights> vertices) {
    assert(levels >= 1 && levels <= kMaxTileLevels && (margin == 0 || margin == 1));
    // Lattice points of each level from one before the cell to one behind it: 2^m + 3 along a side.
    std::vector<std::uint32_t> parents(16);
    std::vector<std::uint32_t> children;
    for (std::size_t i = 0; i < 16; ++i)
        parents[i] = static_cast<std::uint32_t>(cell.window[i]);
    int step = 1;
    std::size_t parentSide = 4;
    for (int m = 1; m <= levels; ++m) {
        if (m > 1) {
            parents.swap(children);
            parentSide = (std::size_t{1} << static_cast<unsigned>(m - 1)) + 3;
        }
        const std::size_t side = (std::size_t{1} << static_cast<unsigned>(m)) + 3;
        children.resize(side * side);
        const detail::Octave octave = detail::octave(shape, cell.level + m);
        step = octave.step;
        detail::subdivide(octave, shape.kernel, parents.data(), parentSide,
                          (cell.x << static_cast<unsigned>(m - 1)) - 1U, (cell.y << static_cast<unsigned>(m - 1)) - 1U,
                          1, 1, static_cast<int>(side), children.data());
    }
    const int cells = 1 << levels;
    const auto side = static_cast<std::size_t>(cells) + 3;
    assert(vertices.size() >= static_cast<std::size_t>((cells + 1 + 2 * margin) * (cells + 1 + 2 * margin)));
    std::size_t at = 0;
    for (int j = -margin; j <= cells + margin; ++j) {
        const std::uint32_t* fine = children.data() + static_cast<std::size_t>(j + 1) * side;
        // Two's complement: -1 >> 1 is -1.
        const std::uint32_t* coarse = parents.data() + static_cast<std::size_t>((j >> 1) + 1) * parentSide;
        for (int i = -margin; i <= cells + margin; ++i) {
            const std::uint32_t slid = coarse[(i >> 1) + 1] << static_cast<unsigned>(step);
            vertices[at++] = {static_cast<std::int32_t>(fine[i + 1]), static_cast<std::int32_t>(slid)};
        }
    }
}

LevelUniforms levelUniforms(const Shape& shape, std::int64_t level) {
    LevelUniforms uniforms;
    for (std::size_t i = 0; i < uniforms.hash.size(); ++i) {
        const detail::Octave octave = detail::octave(shape, level + 1 + static_cast<std::int64_t>(i));
        uniforms.hash[i] = static_cast<std::int32_t>(octave.hash);
        uniforms.amplitude[i] = static_cast<std::int32_t>(octave.amplitude);
        uniforms.step[i] = octave.step;
    }
    return uniforms;
}

} // namespace apeiron::terrain
