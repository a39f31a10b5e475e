#include "volume/bricked.hpp"

#include "volume/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace apeiron::volume {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void widen(ValueRange& range, const ValueRange& other) {
    range.low = std::min(range.low, other.low);
    range.high = std::max(range.high, other.high);
}

std::size_t indexIn(glm::ivec3 size, glm::ivec3 p) {
    return (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(p.x);
}

std::size_t volumeOf(glm::ivec3 size) {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

glm::ivec3 dividedUp(glm::ivec3 a, int b) {
    return (a + (b - 1)) / b;
}

/// Calls `use` for every place in a box, x fastest.
template <class Use> void forEach(glm::ivec3 first, glm::ivec3 end, const Use& use) {
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x)
                use(glm::ivec3(x, y, z));
}

} // namespace

bool BrickKey::operator<(const BrickKey& other) const {
    return std::tie(level, brick.z, brick.y, brick.x) <
           std::tie(other.level, other.brick.z, other.brick.y, other.brick.x);
}

BoxReader boxReader(std::shared_ptr<const Volume> volume, int channel, int time) {
    return [volume = std::move(volume), channel, time](const VoxelBox& box, float* to) {
        const auto slope = static_cast<float>(volume->slope);
        const auto intercept = static_cast<float>(volume->intercept);
        visitVoxels(*volume, channelOffset(*volume, channel, time), [&](const auto* voxels) {
            for (int z = 0; z < box.size.z; ++z)
                for (int y = 0; y < box.size.y; ++y) {
                    const auto* from = voxels + indexIn(volume->size, box.first + glm::ivec3(0, y, z));
                    for (int x = 0; x < box.size.x; ++x)
                        *to++ = slope * number(from[x]) + intercept;
                }
        });
    };
}

BrickPyramid::BrickPyramid(glm::ivec3 size, BoxReader read) : size_(size), read_(std::move(read)) {
    Blocks finest;
    finest.size = dividedUp(size_, kBlock);
    finest.ranges.assign(volumeOf(finest.size), {kInfinity, -kInfinity});
    std::vector<float> slab;
    for (int z = 0; z < size_.z; z += kBlock) {
        const VoxelBox box{{0, 0, z}, {size_.x, size_.y, std::min(kBlock, size_.z - z)}};
        slab.resize(volumeOf(box.size));
        read_(box, slab.data());
        std::size_t at = 0;
        forEach(glm::ivec3(0), box.size, [&](glm::ivec3 p) {
            const float value = slab[at++];
            widen(finest.ranges[indexIn(finest.size, {p.x / kBlock, p.y / kBlock, z / kBlock})], {value, value});
        });
    }
    blocks_.push_back(std::move(finest));
    while (glm::any(glm::greaterThan(sizeOf(levels() - 1), glm::ivec3(kEdge)))) {
        const Blocks& finer = blocks_.back();
        Blocks coarser;
        coarser.size = dividedUp(finer.size, 2);
        coarser.ranges.assign(volumeOf(coarser.size), {kInfinity, -kInfinity});
        forEach(glm::ivec3(0), finer.size, [&](glm::ivec3 p) {
            widen(coarser.ranges[indexIn(coarser.size, p / 2)], finer.ranges[indexIn(finer.size, p)]);
        });
        blocks_.push_back(std::move(coarser));
    }
}

glm::ivec3 BrickPyramid::sizeOf(int level) const {
    return dividedUp(size_, 1 << level);
}

glm::ivec3 BrickPyramid::bricksOf(int level) const {
    return dividedUp(sizeOf(level), kEdge);
}

ValueRange BrickPyramid::range(const BrickKey& key) const {
    const Blocks& blocks = blocks_[static_cast<std::size_t>(key.level)];
    constexpr int kPerBrick = kEdge / kBlock;
    // A block more on each side holds the voxel that interpolation looks at there.
    const glm::ivec3 first = glm::max(key.brick * kPerBrick - 1, glm::ivec3(0));
    const glm::ivec3 end = glm::min((key.brick + 1) * kPerBrick + 1, blocks.size);
    ValueRange range{kInfinity, -kInfinity};
    forEach(first, end, [&](glm::ivec3 p) { widen(range, blocks.ranges[indexIn(blocks.size, p)]); });
    return range;
}

std::vector<float> BrickPyramid::values(const BrickKey& key) const {
    const int scale = 1 << key.level;
    const glm::ivec3 levelSize = sizeOf(key.level);
    const glm::ivec3 origin = key.brick * kEdge - 1;
    const glm::ivec3 first = glm::max(origin, glm::ivec3(0));
    const glm::ivec3 end = glm::min(origin + kStored, levelSize);
    const glm::ivec3 extent = end - first;
    std::vector<float> means(volumeOf(extent));

    // Of the coarse levels a brick covers much: read no more of it at once than a layer of their voxels.
    std::vector<float> box;
    for (int z = 0; z < extent.z; ++z) {
        VoxelBox layer;
        layer.first = scale * (first + glm::ivec3(0, 0, z));
        layer.size = glm::min(scale * glm::ivec3(end.x, end.y, first.z + z + 1), size_) - layer.first;
        box.resize(volumeOf(layer.size));
        read_(layer, box.data());
        std::vector<double> sums(static_cast<std::size_t>(extent.x) * static_cast<std::size_t>(extent.y));
        std::vector<int> counts(sums.size());
        std::size_t at = 0;
        forEach(glm::ivec3(0), layer.size, [&](glm::ivec3 p) {
            const std::size_t cell = indexIn(extent, {p.x >> key.level, p.y >> key.level, 0});
            sums[cell] += static_cast<double>(box[at++]);
            ++counts[cell];
        });
        for (std::size_t i = 0; i < sums.size(); ++i)
            means[static_cast<std::size_t>(z) * sums.size() + i] = static_cast<float>(sums[i] / counts[i]);
    }

    std::vector<float> result;
    result.reserve(volumeOf(glm::ivec3(kStored)));
    forEach(origin, origin + kStored,
            [&](glm::ivec3 p) { result.push_back(means[indexIn(extent, glm::clamp(p, first, end - 1) - first)]); });
    return result;
}

int BrickPyramid::levelThatFits(std::size_t bytes) const {
    int level = 0;
    while (level + 1 < levels() && volumeOf(bricksOf(level)) > bytes / brickBytes())
        ++level;
    return level;
}

std::vector<BrickKey> BrickPyramid::bricksAlong(glm::dvec3 origin, glm::dvec3 direction, double spread) const {
    const glm::dvec3 d = glm::normalize(direction);
    // Where a ray is parallel to an axis, infinity does the right thing, except at 0 * infinity.
    const auto crossing = [&](glm::dvec3 low, glm::dvec3 high, double& near, double& far) {
        for (int axis = 0; axis < 3; ++axis) {
            if (d[axis] == 0) {
                if (origin[axis] < low[axis] || origin[axis] >= high[axis]) far = -1;
                continue;
            }
            const double a = (low[axis] - origin[axis]) / d[axis];
            const double b = (high[axis] - origin[axis]) / d[axis];
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
        }
    };
    double t = 0;
    double end = std::numeric_limits<double>::max();
    crossing(glm::dvec3(0), glm::dvec3(size_), t, end);

    std::vector<BrickKey> keys;
    // A step over a border lands behind it: a thousandth of a voxel is nothing to see, and far more than rounding.
    constexpr double kStep = 1e-3;
    t += kStep;
    while (t < end) {
        const double width = spread * t;
        const int level = std::clamp(width > 1 ? static_cast<int>(std::floor(std::log2(width))) : 0, 0, levels() - 1);
        const int edge = kEdge << level;
        const glm::ivec3 voxel = glm::clamp(glm::ivec3(glm::floor(origin + t * d)), glm::ivec3(0), size_ - 1);
        const BrickKey key{level, voxel / edge};
        if (keys.empty() || !(keys.back() == key)) keys.push_back(key);
        double near = 0;
        double far = end;
        crossing(glm::dvec3(key.brick * edge), glm::dvec3((key.brick + 1) * edge), near, far);
        t = std::max(t, far) + kStep;
    }
    return keys;
}

BrickCache::BrickCache(const BrickPyramid& pyramid, std::size_t memory)
    : pyramid_(pyramid), memory_(std::max(memory, BrickPyramid::brickBytes())),
      baseLevel_(pyramid.levelThatFits(memory_ / 2)) {
    request({});
}

void BrickCache::request(const std::vector<BrickKey>& wanted) {
    wishes_.clear();
    forEach(glm::ivec3(0), pyramid_.bricksOf(baseLevel_), [&](glm::ivec3 p) {
        if (bricks_.count({baseLevel_, p}) == 0) wishes_.push_back({baseLevel_, p});
    });
    for (const BrickKey& key : wanted)
        if (key.level < baseLevel_) wishes_.push_back(key);
}

bool BrickCache::makeRoom(const std::map<BrickKey, int>& keep) {
    while (bytes() + BrickPyramid::brickBytes() > memory_) {
        // What is wished for more urgently stays.
        if (uses_.empty() || keep.count(uses_.back()) != 0) return false;
        bricks_.erase(uses_.back());
        uses_.pop_back();
    }
    return true;
}

int BrickCache::load(int most) {
    int loaded = 0;
    std::map<BrickKey, int> keep;
    for (const BrickKey& key : wishes_) {
        if (loaded >= most) break;
        keep.emplace(key, 0);
        if (const auto found = bricks_.find(key); found != bricks_.end()) {
            if (!isBase(key)) uses_.splice(uses_.begin(), uses_, found->second.use);
            continue;
        }
        if (!makeRoom(keep)) break;
        Brick brick{pyramid_.values(key), uses_.end()};
        if (!isBase(key)) brick.use = uses_.insert(uses_.begin(), key);
        bricks_.emplace(key, std::move(brick));
        ++loaded;
    }
    return loaded;
}

BrickCache::Found BrickCache::find(const BrickKey& key) {
    for (BrickKey at = key; at.level < pyramid_.levels(); at = at.parent()) {
        const auto found = bricks_.find(at);
        if (found == bricks_.end()) continue;
        if (!isBase(at)) uses_.splice(uses_.begin(), uses_, found->second.use);
        return {at, &found->second.values};
    }
    return {};
}

} // namespace apeiron::volume
