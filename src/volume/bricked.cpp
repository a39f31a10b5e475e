#include "volume/bricked.hpp"

#include "volume/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace apeiron::volume {
namespace {

glm::ivec3 dividedUp(glm::ivec3 a, int b) {
    return (a + (b - 1)) / b;
}

/// Adds up rows of voxels to those of a coarser level.
class Coarser {
  public:
    /// @param first of the row in voxels of level 0 @param count of voxels of level 0
    Coarser(int level, int first, int count) {
        for (int x = 0; x < count;) {
            const int end = std::min((((first + x) >> level) + 1) << level, first + count) - first;
            lengths_.push_back(end - x);
            x = end;
        }
    }
    int width() const { return static_cast<int>(lengths_.size()); }
    /// @param sums of width() voxels
    void addRow(const float* row, double* sums) const {
        for (const int length : lengths_) {
            // Few values: single precision holds their sum.
            float sum = 0.0F;
            for (int i = 0; i < length; ++i)
                sum += row[i];
            row += length;
            *sums++ += static_cast<double>(sum);
        }
    }
    /// @param voxels of level 0 that were added in every column
    void divide(const double* sums, int rows, float* means) const {
        for (std::size_t x = 0; x < lengths_.size(); ++x)
            means[x] = static_cast<float>(sums[x] / (static_cast<double>(rows) * lengths_[x]));
    }

  private:
    std::vector<int> lengths_; ///< of what a voxel of the level covers
};

/// In pieces of a fixed length: of those, compilers make vectors.
void addUp(const float* __restrict values, std::size_t count, float* __restrict sums) {
    constexpr std::size_t kPiece = 16;
    std::size_t i = 0;
    for (; i + kPiece <= count; i += kPiece)
        for (std::size_t k = i; k < i + kPiece; ++k)
            sums[k] += values[k];
    for (; i < count; ++i)
        sums[i] += values[i];
}

/// Stores values in a volume's own type, rounded where that has whole numbers.
void store(Volume& volume, std::size_t first, const std::vector<float>& values) {
    const auto put = [&](auto* to, const auto& convert) {
        for (const float value : values)
            *to++ = convert(value);
    };
    const auto whole = [&]<class Word>(Word* to) {
        put(to, [](float value) { return static_cast<Word>(std::floor(value + 0.5F)); });
    };
    switch (volume.type) {
    case VoxelType::UInt8:
        return whole(mutableVoxels<std::uint8_t>(volume, first));
    case VoxelType::Int8:
        return whole(mutableVoxels<std::int8_t>(volume, first));
    case VoxelType::UInt16:
        return whole(mutableVoxels<std::uint16_t>(volume, first));
    case VoxelType::Int16:
        return whole(mutableVoxels<std::int16_t>(volume, first));
    case VoxelType::Float16:
        return put(mutableVoxels<Half>(volume, first), toHalf);
    case VoxelType::Float32:
        return put(mutableVoxels<float>(volume, first), [](float value) { return value; });
    }
}

} // namespace

bool BrickKey::operator<(const BrickKey& other) const {
    return std::tie(level, brick.z, brick.y, brick.x) <
           std::tie(other.level, other.brick.z, other.brick.y, other.brick.x);
}

int BrickPyramid::levels() const {
    int count = 1;
    while (glm::any(glm::greaterThan(sizeOf(count - 1), glm::ivec3(kEdge))))
        ++count;
    return count;
}

glm::ivec3 BrickPyramid::sizeOf(int level) const {
    return dividedUp(size_, 1 << level);
}

glm::ivec3 BrickPyramid::bricksOf(int level) const {
    return dividedUp(sizeOf(level), kEdge);
}

std::size_t BrickPyramid::brickCount(int level) const {
    return voxelsIn(bricksOf(level));
}

std::vector<float> brickValues(const LargeVolume& volume, const BrickKey& key, int channel, int time) {
    constexpr int kStored = BrickPyramid::kStored;
    const glm::ivec3 size = volume.form.size;
    const int scale = 1 << key.level;
    const glm::ivec3 origin = key.brick * BrickPyramid::kEdge - 1;
    const glm::ivec3 first = glm::max(origin, glm::ivec3(0));
    const glm::ivec3 end = glm::min(origin + kStored, dividedUp(size, scale));
    const glm::ivec3 extent = end - first;
    std::vector<float> means(voxelsIn(extent));
    if (key.level == 0) {
        volume.read({first, extent}, channel, time, means.data());
    } else {
        // Of the coarse levels a brick covers much: no more of it is read at once than a layer of their voxels.
        std::vector<float> box;
        std::vector<double> sums(static_cast<std::size_t>(extent.x) * static_cast<std::size_t>(extent.y));
        for (int z = 0; z < extent.z; ++z) {
            VoxelBox layer;
            layer.first = scale * (first + glm::ivec3(0, 0, z));
            layer.size = glm::min(scale * glm::ivec3(end.x, end.y, first.z + z + 1), size) - layer.first;
            box.resize(voxelsIn(layer.size));
            volume.read(layer, channel, time, box.data());
            std::fill(sums.begin(), sums.end(), 0.0);
            const Coarser coarser(key.level, layer.first.x, layer.size.x);
            const float* row = box.data();
            for (int k = 0; k < layer.size.z; ++k)
                for (int y = 0; y < layer.size.y; ++y, row += layer.size.x)
                    coarser.addRow(row, &sums[static_cast<std::size_t>(y >> key.level) * extent.x]);
            for (int y = 0; y < extent.y; ++y) {
                const int rows = std::min(scale, layer.size.y - y * scale) * layer.size.z;
                const auto at = static_cast<std::size_t>(y) * extent.x;
                coarser.divide(&sums[at], rows, &means[static_cast<std::size_t>(z) * sums.size() + at]);
            }
        }
    }

    std::vector<float> result;
    result.reserve(BrickPyramid::kStoredVoxels);
    for (int z = 0; z < kStored; ++z)
        for (int y = 0; y < kStored; ++y)
            for (int x = 0; x < kStored; ++x) {
                const glm::ivec3 at = glm::clamp(origin + glm::ivec3(x, y, z), first, end - 1) - first;
                result.push_back(means[(static_cast<std::size_t>(at.z) * extent.y + at.y) * extent.x + at.x]);
            }
    return result;
}

Survey survey(const LargeVolume& volume, int time, int level, int side) {
    const glm::ivec3 size = volume.form.size;
    const glm::ivec3 coarse = BrickPyramid(size).sizeOf(level);
    Survey result;
    result.level = level;
    Volume& overview = result.overview;
    overview = volume.form;
    overview.size = coarse;
    overview.timePoints = 1;
    overview.indexToWorld = coarserIndexToWorld(volume.form.indexToWorld, level);
    overview.voxels.resize(
        byteSize(coarse, overview.type, overview.channels, 1, std::numeric_limits<std::size_t>::max()));
    const Coarser coarser(level, 0, size.x);
    const std::size_t plane = static_cast<std::size_t>(coarse.x) * static_cast<std::size_t>(coarse.y);
    std::vector<double> sums(plane, 0.0);
    std::vector<float> means(plane);
    std::vector<float> rowSums(static_cast<std::size_t>(size.x));
    const auto read = [&](int channel, int z, std::span<float> out) {
        volume.read({{0, 0, z}, {size.x, size.y, 1}}, channel, time, out.data());
        // Rows of the same coarse voxels first: along them there is less to do.
        for (int y = 0; y < coarse.y; ++y) {
            std::fill(rowSums.begin(), rowSums.end(), 0.0F);
            for (int k = y << level; k < std::min((y + 1) << level, size.y); ++k)
                addUp(&out[static_cast<std::size_t>(k) * rowSums.size()], rowSums.size(), rowSums.data());
            coarser.addRow(rowSums.data(), &sums[static_cast<std::size_t>(y) * coarse.x]);
        }
        const int layer = z >> level;
        if (z + 1 < size.z && (z + 1) >> level == layer) return;
        const int slices = z + 1 - (layer << level);
        for (int y = 0; y < coarse.y; ++y) {
            const auto at = static_cast<std::size_t>(y) * coarse.x;
            coarser.divide(&sums[at], std::min(1 << level, size.y - (y << level)) * slices, &means[at]);
        }
        store(overview, channelOffset(overview, channel, 0) + static_cast<std::size_t>(layer) * plane, means);
        std::fill(sums.begin(), sums.end(), 0.0);
    };
    result.ranges = brickRanges(size, overview.channels, side, read);
    return result;
}

BrickRanges coarserRanges(const BrickRanges& ranges, int level) {
    if (level == 0) return ranges;
    // Interpolated between voxels of the level, of which each covers 2^l: at most 1.5 * 2^l to each side, of which a
    // range holds one voxel already.
    const int reach = (3 << level) / 2 - 1;
    const int bricks = (reach + ranges.side - 1) / ranges.side;
    BrickRanges result = ranges;
    const std::array<std::size_t, 3> strides{1, static_cast<std::size_t>(ranges.size.x),
                                             static_cast<std::size_t>(ranges.size.x) *
                                                 static_cast<std::size_t>(ranges.size.y)};
    std::vector<glm::vec2> line;
    for (int axis = 0; axis < 3; ++axis) {
        const int count = ranges.size[axis];
        const std::size_t stride = strides[static_cast<std::size_t>(axis)];
        line.resize(static_cast<std::size_t>(count));
        for (std::size_t start = 0; start < result.ranges.size(); ++start) {
            if (start / stride % static_cast<std::size_t>(count) != 0) continue;
            for (int i = 0; i < count; ++i)
                line[static_cast<std::size_t>(i)] = result.ranges[start + static_cast<std::size_t>(i) * stride];
            for (int i = 0; i < count; ++i) {
                glm::vec2& to = result.ranges[start + static_cast<std::size_t>(i) * stride];
                for (int k = std::max(i - bricks, 0); k <= std::min(i + bricks, count - 1); ++k) {
                    const glm::vec2 other = line[static_cast<std::size_t>(k)];
                    to = {std::min(to.x, other.x), std::max(to.y, other.y)};
                }
            }
        }
    }
    return result;
}

} // namespace apeiron::volume
