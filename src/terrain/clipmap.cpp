#include "terrain/clipmap.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace apeiron::terrain {
namespace {

constexpr int kBlockLevels = 5; ///< squares consist of blocks of 32 x 32
constexpr int kBlock = 1 << kBlockLevels;
constexpr int kBlocks = Clipmap::kSide / kBlock;
constexpr int kAcross = 4; ///< squares along the texture's side

} // namespace

Clipmap::Clipmap(const gpu::Context& context)
    : texture_(context, gpu::PixelFormat::RGBA32F, {kAcross * kSide, kMostLevels / kAcross * kSide}, "clipmap") {}

void Clipmap::update(const Place& place, double spacing, double relief) {
    if (place.shape() != shape_) {
        shape_ = place.shape();
        levels_.fill({});
    }
    const std::int64_t deepest = place.level() + 20 + kBlockLevels;
    const auto wanted = place.level() + static_cast<std::int64_t>(std::ceil(-std::log2(spacing)));
    const std::int64_t finest = std::clamp<std::int64_t>(wanted, kBlockLevels, deepest);
    finest_ = static_cast<float>(spacing);
    const std::int64_t highest = std::max<std::int64_t>(0, place.level() - Place::kLiveLevels + 2) + kBlockLevels;
    count_ = static_cast<int>(std::clamp<std::int64_t>(finest - highest + 1, 1, kMostLevels));
    slot_ = static_cast<int>(finest % kMostLevels);
    const std::int64_t exponent = heightExponent(shape_, place.level());
    const glm::dvec2 position(place.position());
    for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
        const std::int64_t level = finest - static_cast<std::int64_t>(k);
        const std::int64_t cellLevel = level - kBlockLevels;
        const Cell middle = place.cellNear(cellLevel, 0, 0);
        // The camera within its block, from the path's bits: exact enough for any level.
        const double edge = std::ldexp(1.0, static_cast<int>(place.level() - cellLevel)); // [world]
        glm::dvec2 within;
        if (cellLevel >= place.level()) {
            within = glm::fract(position / edge);
        } else {
            const auto bits = static_cast<unsigned>(place.level() - cellLevel);
            const std::uint32_t mask = (1U << bits) - 1U;
            within = (glm::dvec2(place.block().x & mask, place.block().y & mask) + position) / edge;
        }
        const glm::ivec2 first(within.x < 0.5 ? -kBlocks / 2 : 1 - kBlocks / 2,
                               within.y < 0.5 ? -kBlocks / 2 : 1 - kBlocks / 2);
        const std::uint32_t x = middle.x + static_cast<std::uint32_t>(first.x);
        const std::uint32_t y = middle.y + static_cast<std::uint32_t>(first.y);
        // A level has its own slot: when the finest one changes, the others stay where they are.
        const auto slot = static_cast<std::size_t>(level % kMostLevels);
        Level& square = levels_[slot];
        if (square.level != level || square.x != x || square.y != y) {
            // The reference depends on the square alone: rounding is then the same whichever way the camera came.
            const Cell reference = place.cellNear(cellLevel, first.x + kBlocks / 2, first.y + kBlocks / 2);
            square = {level, x, y, reference.window[5]};
            fill(place, slot, cellLevel, first);
        }
        const double point = edge / kBlock;
        const double unit =
            relief * std::ldexp(1.0, static_cast<int>(exponent - heightExponent(shape_, level)) - kFractionBits);
        // The reference is a height of the cells' level.
        const int step = static_cast<int>(heightExponent(shape_, level) - heightExponent(shape_, cellLevel));
        const auto zero =
            static_cast<std::uint64_t>(static_cast<std::uint32_t>(square.reference) << static_cast<unsigned>(step))
            << 32U;
        const auto above = static_cast<std::int64_t>(zero - place.heightAt(level));
        places_[k] = glm::vec4((static_cast<double>(first.x) - within.x) * edge,
                               (static_cast<double>(first.y) - within.y) * edge,
                               std::ldexp(static_cast<double>(above), -32) * unit, 1.0 / point);
        units_[k] = static_cast<float>(unit);
    }
}

void Clipmap::fill(const Place& place, std::size_t slot, std::int64_t cellLevel, glm::ivec2 first) {
    const Level& square = levels_[slot];
    constexpr int kPoints = kBlock + 1;
    vertices_.resize(static_cast<std::size_t>(kPoints) * kPoints);
    texels_.resize(static_cast<std::size_t>(kSide) * kSide * 4);
    const int step = static_cast<int>(heightExponent(shape_, square.level) - heightExponent(shape_, cellLevel));
    const auto reference =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(square.reference) << static_cast<unsigned>(step));
    for (int by = 0; by < kBlocks; ++by) {
        for (int bx = 0; bx < kBlocks; ++bx) {
            tileHeights(shape_, place.cellNear(cellLevel, first.x + bx, first.y + by), kBlockLevels, 0, vertices_);
            for (int y = 0; y < kBlock; ++y) {
                float* texel = &texels_[4 * (static_cast<std::size_t>(by * kBlock + y) * kSide +
                                             static_cast<std::size_t>(bx) * kBlock)];
                for (int x = 0; x < kBlock; ++x, texel += 4) {
                    for (int c = 0; c < 4; ++c) {
                        const int at = (y + (c >> 1)) * kPoints + x + (c & 1);
                        texel[c] =
                            static_cast<float>(heightDifference(vertices_[static_cast<std::size_t>(at)].x, reference));
                    }
                }
            }
        }
    }
    const auto i = static_cast<int>(slot);
    texture_.upload(glm::ivec2(i % kAcross, i / kAcross) * kSide, {kSide, kSide}, std::span<const float>(texels_));
}

void Clipmap::addConstants(gpu::ShaderSource& source) {
    source.addText("clipmap constants", "const int terrain_clip_most = " + std::to_string(kMostLevels) + ";\n");
}

void Clipmap::bind(gpu::Kernel& kernel) const {
    kernel.set("terrain_clip", texture_);
    kernel.set("terrain_clip_count", count_);
    kernel.set("terrain_clip_slot", slot_);
    kernel.set("terrain_clip_finest", finest_);
    kernel.set("terrain_clip_place[0]", std::span<const glm::vec4>(places_));
    kernel.set("terrain_clip_unit[0]", std::span<const float>(units_));
}

} // namespace apeiron::terrain
