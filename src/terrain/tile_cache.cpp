#include "terrain/tile_cache.hpp"

#include "terrain/tile_kernel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace apeiron::terrain {
namespace {

/// Of heights and slopes.
constexpr int kBytesPerVertex = 16;
constexpr int kFewest = 16;

int tilesAcross(const gpu::Context& context, int side, std::int64_t bytes) {
    const double texels = std::sqrt(static_cast<double>(bytes) / kBytesPerVertex);
    const int across = static_cast<int>(std::min<double>(texels, context.capabilities().maxTextureSize)) / side;
    if (across * across >= kFewest) return across;
    throw Error(ErrorKind::BadInput,
                fmt::format("there is no room for {} tiles of {} cells in {} bytes", kFewest, side - 1, bytes),
                "subject.memory", "allow more memory or choose smaller tiles");
}

} // namespace

TileCache::TileCache(const gpu::Context& context, int tileLevels, std::int64_t bytes)
    : tileLevels_(tileLevels), bytes_(bytes), side_((1 << tileLevels) + 1), across_(tilesAcross(context, side_, bytes)),
      heights_(context, gpu::PixelFormat::RG32I, {across_ * side_, across_ * side_}, "tile heights"),
      slopes_(context, gpu::PixelFormat::RGBA16F, {across_ * side_, across_ * side_}, "tile slopes"),
      heightTargets_(context, {&heights_}), index_(std::bit_ceil(2U * static_cast<unsigned>(capacity())), -1) {
    entries_.reserve(static_cast<std::size_t>(capacity()));
}

void TileCache::begin(const Shape& shape) {
    ++turn_;
    if (shape == shape_) return;
    shape_ = shape;
    entries_.clear();
    newest_ = -1;
    std::fill(index_.begin(), index_.end(), -1);
}

std::size_t TileCache::position(const CellKey& key) const {
    const std::size_t mask = index_.size() - 1;
    std::size_t at = CellKeyHash{}(key)&mask;
    while (index_[at] >= 0 && entries_[static_cast<std::size_t>(index_[at])].key != key)
        at = (at + 1) & mask;
    return at;
}

std::int32_t TileCache::slotOf(const CellKey& key) const {
    return index_[position(key)];
}

void TileCache::forget(const CellKey& key) {
    const std::size_t mask = index_.size() - 1;
    std::size_t hole = position(key);
    // Those behind move up, unless they stood before their own place then.
    for (std::size_t at = (hole + 1) & mask; index_[at] >= 0; at = (at + 1) & mask) {
        const std::size_t own = CellKeyHash{}(entries_[static_cast<std::size_t>(index_[at])].key) & mask;
        if (((at - own) & mask) < ((at - hole) & mask)) continue;
        index_[hole] = index_[at];
        hole = at;
    }
    index_[hole] = -1;
}

void TileCache::unlink(std::int32_t slot) {
    const Entry& entry = entries_[static_cast<std::size_t>(slot)];
    if (newest_ == slot) newest_ = entry.older == slot ? -1 : entry.older;
    entries_[static_cast<std::size_t>(entry.newer)].older = entry.older;
    entries_[static_cast<std::size_t>(entry.older)].newer = entry.newer;
}

void TileCache::link(std::int32_t slot) {
    Entry& entry = entries_[static_cast<std::size_t>(slot)];
    if (newest_ < 0) newest_ = entry.newer = slot;
    entry.older = newest_;
    entry.newer = entries_[static_cast<std::size_t>(newest_)].newer;
    entries_[static_cast<std::size_t>(entry.newer)].older = slot;
    entries_[static_cast<std::size_t>(entry.older)].newer = slot;
    newest_ = slot;
}

glm::ivec2 TileCache::find(const Tile& tile) {
    const std::int32_t slot = slotOf({tile.level, tile.x, tile.y});
    if (slot < 0) return {-1, -1};
    if (slot != newest_) {
        unlink(slot);
        link(slot);
    }
    entries_[static_cast<std::size_t>(slot)].turn = turn_;
    return squareAt(slot);
}

glm::ivec2 TileCache::place(const Tile& tile, const Place& where, Maker maker, gpu::KernelCache& kernels,
                            gpu::Stage stage) {
    if (const glm::ivec2 there = find(tile); there.x >= 0) return there;
    const CellKey key{tile.level, tile.x, tile.y};
    auto slot = static_cast<std::int32_t>(entries_.size());
    if (slot >= capacity()) {
        slot = entries_[static_cast<std::size_t>(newest_)].newer; // the ring's end: the oldest
        Entry& oldest = entries_[static_cast<std::size_t>(slot)];
        if (oldest.turn == turn_) return {-1, -1};
        forget(oldest.key);
        unlink(slot);
        oldest = {key, turn_, slot, slot};
    } else {
        entries_.push_back({key, turn_, slot, slot});
    }
    link(slot);
    index_[position(key)] = slot;
    make(where.cellNamed(tile.cell), squareAt(slot), maker, kernels, stage);
    ++generated_;
    return squareAt(slot);
}

void TileCache::make(const Cell& cell, glm::ivec2 at, Maker maker, gpu::KernelCache& kernels, gpu::Stage stage) {
    const int n = side_;
    const int wide = n + 2;
    vertices_.resize(static_cast<std::size_t>(wide) * static_cast<std::size_t>(wide));
    tileHeights(shape_, cell, tileLevels_, 1, vertices_);
    const auto vertex = [&](int x, int y) -> const VertexHeights& {
        return vertices_[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(wide) +
                         static_cast<std::size_t>(x + 1)];
    };
    const auto texels = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    constexpr float kUnit = 1.0F / static_cast<float>(1 << kFractionBits);
    slopeTexels_.resize(4 * texels);
    // Differences over two spacings; of the coarse heights over four, where the rim's are extrapolated to second order.
    const auto fine = [](std::int32_t after, std::int32_t before) {
        return 0.5F * kUnit * static_cast<float>(heightDifference(after, before));
    };
    const auto coarse = [&](int i, const auto& height) {
        const std::int32_t here = height(i);
        const auto from = [&](int j) { return static_cast<float>(heightDifference(height(j), here)); };
        if (i >= n - 1) return kUnit * 0.25F * (from(i - 4) - 4.0F * from(i - 2));
        if (i <= 0) return kUnit * 0.25F * (4.0F * from(i + 2) - from(i + 4));
        return kUnit * 0.25F * (from(i + 2) - from(i - 2));
    };
    for (int y = 0; y < n; ++y) {
        float* row = &slopeTexels_[4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(n)];
        const bool evenRow = y % 2 == 0;
        for (int x = 0; x < n; ++x, row += 4) {
            row[0] = fine(vertex(x + 1, y).x, vertex(x - 1, y).x);
            row[1] = fine(vertex(x, y + 1).x, vertex(x, y - 1).x);
            if (!evenRow || x % 2 != 0) continue;
            row[2] = coarse(x, [&](int i) { return vertex(i, y).y; });
            row[3] = coarse(y, [&](int j) { return vertex(x, j).y; });
        }
    }
    // Between the vertices of the coarse mesh its slopes are interpolated.
    const auto texel = [&](int x, int y) {
        return &slopeTexels_[4 *
                             (static_cast<std::size_t>(y) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x))];
    };
    for (int y = 0; y < n; y += 2) {
        for (int x = 1; x < n; x += 2) {
            for (int c = 2; c < 4; ++c)
                texel(x, y)[c] = 0.5F * (texel(x - 1, y)[c] + texel(x + 1, y)[c]);
        }
    }
    for (int y = 1; y < n; y += 2) {
        for (int x = 0; x < n; ++x) {
            for (int c = 2; c < 4; ++c)
                texel(x, y)[c] = 0.5F * (texel(x, y - 1)[c] + texel(x, y + 1)[c]);
        }
    }
    slopes_.upload(at, {n, n}, std::span<const float>(slopeTexels_));
    if (maker == Maker::Gpu) {
        gpu::ShaderSource source;
        addHeightSource(source);
        source.addText("tile heights", "uniform ivec2 terrain_first;\n"
                                       "void kernel_main(ivec2 pixel, out ivec4 heights) {\n"
                                       "    heights = ivec4(terrain_height(pixel - terrain_first), 0, 0);\n}\n");
        const auto kernel = kernels.get("tile heights", source, stage, {gpu::PixelFormat::RG32I});
        setTile(*kernel, shape_, cell, tileLevels_);
        kernel->set("terrain_first", at);
        kernel->run(heightTargets_, {at, {n, n}}, heights_.size());
        return;
    }
    heightTexels_.resize(2 * texels);
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const std::size_t i =
                2 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x));
            heightTexels_[i] = vertex(x, y).x;
            heightTexels_[i + 1] = vertex(x, y).y;
        }
    }
    heights_.upload(at, {n, n}, std::span<const std::int32_t>(heightTexels_));
}

} // namespace apeiron::terrain
