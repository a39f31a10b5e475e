#pragma once

#include "terrain/height.hpp"

// The recurrence itself, for the files of this folder.
namespace apeiron::terrain::detail {

/// A 32-bit integer hash of low bias (Wellons 2018, "hash-prospector").
constexpr std::uint32_t lowBias(std::uint32_t x) {
    x ^= x >> 16U;
    x *= 0x7feb352dU;
    x ^= x >> 15U;
    x *= 0x846ca68bU;
    x ^= x >> 16U;
    return x;
}

/// A level's noise: of point (x, y) it is noise(rows(y), x).
struct Octave {
    std::uint32_t hash = 0; ///< of level and seed
    std::uint32_t amplitude = 0;
    int step = 1; ///< heightStep()

    constexpr std::uint32_t row(std::uint32_t y) const { return lowBias(y ^ hash); }
    /// In [-amplitude, amplitude), modulo 2^32.
    constexpr std::uint32_t noise(std::uint32_t rowHash, std::uint32_t x) const {
        return (((lowBias(x ^ rowHash) >> 16U) * amplitude) >> 15U) - amplitude;
    }
};

Octave octave(const Shape& shape, std::int64_t level);

/// Outer weight of an even point's three parents along an axis, of 8 in all: (w, 8 - 2w, w). Odd points have (4, 4).
constexpr std::uint32_t outerWeight(Kernel kernel) {
    return kernel == Kernel::BSpline ? 1U : 0U;
}

/// A child's height from the weighted sum of its parents (weights sum to 64), with one of them as reference: the
/// result does not depend on which. Rounds once, down.
constexpr std::uint32_t childHeight(std::uint32_t weightedSum, std::uint32_t reference, int step) {
    const auto difference = static_cast<std::int32_t>(weightedSum - 64U * reference);
    return (reference << static_cast<unsigned>(step)) + static_cast<std::uint32_t>(difference >> (6 - step));
}

/// A height as the camera's is kept: in 2^-32 units, modulo 2^64.
constexpr std::uint64_t ringHeight(std::int32_t height) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(height)) << 32U;
}

/// Such a height in units of the level before. @param near a height of that level not far away, since the height is
/// known but for a multiple of half the ring @param step heightStep() of the level of `height`
constexpr std::uint64_t parentHeight(std::uint64_t height, std::int32_t near, int step) {
    const std::uint64_t reference = ringHeight(near);
    const auto difference = static_cast<std::int64_t>(height - (reference << static_cast<unsigned>(step)));
    return reference + static_cast<std::uint64_t>(difference >> static_cast<unsigned>(step));
}

/// The heights of a square block of lattice points of level 0: `count` along a side from (x, y). Noise alone.
void rootHeights(const Shape& shape, std::uint32_t x, std::uint32_t y, int count, std::int32_t* heights);

/// The heights of a square block of lattice points of level + 1 from one of level: `count` points along a side from
/// (2 x + firstX, 2 y + firstY), of parents that begin at (x, y), `stride` of them in a row.
/// @pre firstX, firstY >= 1, and parents reach to (firstX + count) / 2 + 1 along each axis
void subdivide(const Octave& octave, Kernel kernel, const std::uint32_t* parents, std::size_t stride, std::uint32_t x,
               std::uint32_t y, int firstX, int firstY, int count, std::uint32_t* children);

} // namespace apeiron::terrain::detail
