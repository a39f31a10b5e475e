#include "volume/brick_stream.hpp"

#include "core/error.hpp"
#include "core/stopwatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace apeiron::volume {
namespace {

/// Parts of the memory that these have at most: the overview, its bricks, the ranges with all that is made of them.
constexpr std::size_t kOverviewPart = 8;
constexpr std::size_t kBasePart = 4;
constexpr std::size_t kRangesPart = 8;
/// What is kept for each brick of ranges and channel [bytes]: ranges of up to four levels and those that are shown;
/// and for each brick: two textures of majorants, and what these were made of.
constexpr std::size_t kBytesPerRange = 40;
constexpr std::size_t kBytesPerRangeBrick = 20;
/// For each brick of level 0: its page, levels, and place.
constexpr std::size_t kBytesPerPage = 48;
/// Finer bricks that there must be room for.
constexpr std::size_t kLeastBricks = 8;
/// What came in is shown when it is so many bricks at least, and so large a part of those that were there before.
constexpr std::size_t kLeastBatch = 32;
constexpr std::size_t kBatchPart = 2;

/// How a limit of memory is divided up.
struct Plan {
    int base = 0; ///< level of the overview
    int side = 8; ///< of the bricks of ranges
    std::size_t beside = 0;
    std::size_t brick = 0; ///< bytes of one
    std::size_t slots = 0;
};

std::size_t rangeBytes(glm::ivec3 size, int channels, int side) {
    return voxelsIn((size + side - 1) / side) *
           (static_cast<std::size_t>(channels) * kBytesPerRange + kBytesPerRangeBrick);
}

Plan makePlan(const Volume& form, const BrickPyramid& pyramid, std::size_t memory, int side, std::size_t texel) {
    Plan plan;
    const auto channels = static_cast<std::size_t>(form.channels);
    const auto overview = [&](int level) {
        return voxelsIn(pyramid.sizeOf(level)) * bytesPerVoxel(form.type) * channels;
    };
    plan.brick = BrickPyramid::kStoredVoxels * texel;
    while (plan.base + 1 < pyramid.levels() && (overview(plan.base) > memory / kOverviewPart ||
                                                pyramid.brickCount(plan.base) * plan.brick > memory / kBasePart))
        ++plan.base;
    plan.side = std::min(side, BrickPyramid::kEdge);
    while (plan.side < BrickPyramid::kEdge && rangeBytes(form.size, form.channels, plan.side) > memory / kRangesPart)
        plan.side *= 2;
    plan.beside =
        overview(plan.base) + rangeBytes(form.size, form.channels, plan.side) + pyramid.brickCount(0) * kBytesPerPage;
    const std::size_t least = pyramid.brickCount(plan.base) + (plan.base > 0 ? kLeastBricks : 0);
    if (memory < plan.beside + least * plan.brick) {
        throw Error(ErrorKind::BadInput,
                    fmt::format("{}x{}x{} voxels cannot be shown with {:.4g} MB of memory", form.size.x, form.size.y,
                                form.size.z, static_cast<double>(memory) / 1e6),
                    form.name,
                    fmt::format("allow {:.4g} MB at least",
                                std::ceil(static_cast<double>(plan.beside + least * plan.brick) / 1e5) / 10.0));
    }
    plan.slots = (memory - plan.beside) / plan.brick;
    // More than everything is not needed.
    plan.slots = std::min(plan.slots, pyramid.brickCount(plan.base) + (plan.base > 0 ? pyramid.brickCount(0) : 0));
    return plan;
}

/// Places of an atlas along its axes: as many of `slots` as a box can have, and of such boxes the one most like a cube.
glm::ivec3 atlasGrid(std::size_t slots, int most) {
    const auto limit = static_cast<std::size_t>(most);
    const auto side = static_cast<std::size_t>(std::ceil(2.0 * std::cbrt(static_cast<double>(slots))));
    glm::ivec3 best(1);
    for (std::size_t x = 1; x <= std::min(side, limit); ++x)
        for (std::size_t y = x; y <= std::min(side, limit) && x * y <= slots; ++y) {
            const glm::ivec3 grid(x, y, std::min(slots / (x * y), limit));
            const auto longest = [](glm::ivec3 v) { return std::max({v.x, v.y, v.z}); };
            if (voxelsIn(grid) > voxelsIn(best) || (voxelsIn(grid) == voxelsIn(best) && longest(grid) < longest(best)))
                best = grid;
        }
    return best;
}

/// Bytes of one texel of the shortest form that voxels of that type may have on the GPU.
std::size_t leastTexelBytes(const Volume& form) {
    const std::size_t channels = form.channels == 3 ? 4 : static_cast<std::size_t>(form.channels);
    return channels * bytesPerVoxel(form.type);
}

} // namespace

BrickStream::BrickStream(const gpu::Context& context, LargeVolume volume, int time, std::size_t memory, int side)
    : context_(context), volume_(std::move(volume)), time_(time), pyramid_(volume_.form.size) {
    // Before everything is read, what values there are is not known; they may need longer texels.
    const Plan first = makePlan(volume_.form, pyramid_, memory, side, leastTexelBytes(volume_.form));
    Survey seen = survey(volume_, time, first.base, first.side);
    form_ = texelForm(volume_.form.type, seen.ranges);
    const Plan plan = makePlan(volume_.form, pyramid_, memory, first.side,
                               static_cast<std::size_t>(gpu::bytesPerTexel(form_.format)));
    base_ = seen.level;
    ranges_ = std::move(seen.ranges);
    overview_ = std::make_shared<const Volume>(std::move(seen.overview));
    coarse_ = inParts(overview_);

    grid_ = atlasGrid(plan.slots, context.capabilities().maxTextureSize3D / BrickPyramid::kStored);
    slots_ = BrickSlots(voxelsIn(grid_));
    if (slots_.size() < pyramid_.brickCount(base_) + (base_ > 0 ? kLeastBricks : 0)) {
        throw Error(ErrorKind::BadInput,
                    fmt::format("{}x{}x{} voxels are too many for the device's 3D textures", volume_.form.size.x,
                                volume_.form.size.y, volume_.form.size.z),
                    volume_.form.name);
    }
    atlas_ = gpu::Texture3D(context, form_.format, grid_ * BrickPyramid::kStored, "bricks of " + volume_.form.name);
    pages_ = gpu::Texture3D(context, gpu::GridFormat::RGBA32F, pyramid_.bricksOf(0), "pages of " + volume_.form.name);
    bytes_ = plan.beside + slots_.size() * plan.brick;

    const glm::ivec3 base = pyramid_.bricksOf(base_);
    for (int z = 0; z < base.z; ++z)
        for (int y = 0; y < base.y; ++y)
            for (int x = 0; x < base.x; ++x) {
                const BrickKey key{base_, {x, y, z}};
                upload(key, slots_.pin(key));
            }
    targets_.assign(pyramid_.brickCount(0), static_cast<std::uint8_t>(base_));
    publish();
    context.check("uploading the volume's bricks");
}

glm::ivec3 BrickStream::placeOf(std::size_t slot) const {
    const auto i = static_cast<int>(slot);
    return glm::ivec3(i % grid_.x, i / grid_.x % grid_.y, i / (grid_.x * grid_.y)) * BrickPyramid::kStored;
}

void BrickStream::upload(const BrickKey& key, std::size_t slot) {
    const auto stride = static_cast<std::size_t>(gpu::channelsOf(form_.format));
    std::vector<float> values(BrickPyramid::kStoredVoxels * stride, 0.0F);
    // The base level was made when everything was read.
    const bool made = key.level == base_;
    for (int channel = 0; channel < volume_.form.channels; ++channel) {
        std::vector<float> one =
            made ? brickValues(coarse_, {0, key.brick}, channel, 0) : brickValues(volume_, key, channel, time_);
        if (stride == 1) {
            values = std::move(one);
            break;
        }
        for (std::size_t i = 0; i < one.size(); ++i)
            values[i * stride + static_cast<std::size_t>(channel)] = one[i];
    }
    std::vector<std::byte> texels(BrickPyramid::kStoredVoxels *
                                  static_cast<std::size_t>(gpu::bytesPerTexel(form_.format)));
    encodeTexels(form_, values, texels);
    atlas_.upload(texels, placeOf(slot), glm::ivec3(BrickPyramid::kStored));
}

bool BrickStream::want(const BrickView& view, std::vector<std::uint8_t> needed) {
    const std::vector<BrickKey> wanted =
        chooseBricks(pyramid_, base_, needed, view, slots_.size() - pyramid_.brickCount(base_));
    slots_.want(wanted);
    wanted_ = wanted.size();
    std::fill(targets_.begin(), targets_.end(), static_cast<std::uint8_t>(base_));
    const glm::ivec3 size = pyramid_.bricksOf(0);
    for (const BrickKey& key : wanted) {
        const glm::ivec3 first = key.brick << key.level;
        const glm::ivec3 end = glm::min((key.brick + 1) << key.level, size);
        for (int z = first.z; z < end.z; ++z)
            for (int y = first.y; y < end.y; ++y)
                for (int x = first.x; x < end.x; ++x)
                    targets_[(static_cast<std::size_t>(z) * size.y + y) * size.x + x] =
                        static_cast<std::uint8_t>(key.level);
    }
    return publish();
}

bool BrickStream::load(double seconds) {
    const Stopwatch watch;
    while (const std::optional<BrickSlots::Next> next = slots_.next()) {
        upload(next->key, next->slot);
        slots_.arrived();
        ++arrived_;
        ++loaded_;
        if (watch.seconds() >= seconds) break;
    }
    if (arrived_ == 0) return false;
    const std::size_t before = slots_.used() - arrived_;
    if (busy() && arrived_ < std::max(kLeastBatch, before / kBatchPart)) return false;
    context_.check("uploading the volume's bricks");
    return publish();
}

bool BrickStream::publish() {
    arrived_ = 0;
    const glm::ivec3 size = pyramid_.bricksOf(0);
    std::vector<std::uint8_t> levels(targets_.size());
    std::vector<std::size_t> places(targets_.size());
    std::vector<glm::vec4> pages(targets_.size());
    std::size_t i = 0;
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x, ++i) {
                // What is wanted; until it is there, what is finer, or else coarser.
                const BrickKey finest{0, {x, y, z}};
                const int target = targets_[i];
                BrickKey key = finest;
                std::optional<std::size_t> slot;
                for (int level = target; level >= 0 && !slot; --level) {
                    key = finest.ancestor(level);
                    slot = slots_.find(key);
                }
                for (int level = target + 1; level <= base_ && !slot; ++level) {
                    key = finest.ancestor(level);
                    slot = slots_.find(key);
                }
                levels[i] = static_cast<std::uint8_t>(key.level);
                places[i] = slot.value();
                // Voxel 0 of the brick is behind its border.
                const glm::vec3 origin(placeOf(*slot) + 1 - key.brick * BrickPyramid::kEdge);
                pages[i] = glm::vec4(origin, std::ldexp(1.0F, -key.level));
            }
    if (levels == shown_ && places == shownSlots_) return false;
    shown_ = std::move(levels);
    shownSlots_ = std::move(places);
    pages_.upload(std::as_bytes(std::span(pages)), 0, size.z);
    for (const std::uint8_t level : shown_)
        if (coarserRanges_.count(level) == 0 && level > 0) coarserRanges_[level] = coarserRanges(ranges_, level);
    return true;
}

BrickRanges BrickStream::shownRanges(std::span<const float> seen) const {
    BrickRanges result = ranges_;
    const int perBrick = BrickPyramid::kEdge / ranges_.side;
    const glm::ivec3 size = pyramid_.bricksOf(0);
    const std::size_t bricks = seen.size();
    std::size_t i = 0;
    for (int z = 0; z < ranges_.size.z; ++z)
        for (int y = 0; y < ranges_.size.y; ++y)
            for (int x = 0; x < ranges_.size.x; ++x, ++i) {
                if (!(seen[i] > 0.0F)) continue;
                const glm::ivec3 page = glm::ivec3(x, y, z) / perBrick;
                const int level = shown_[(static_cast<std::size_t>(page.z) * size.y + page.y) * size.x + page.x];
                if (level == 0) continue;
                const BrickRanges& coarser = coarserRanges_.at(level);
                for (std::size_t channel = 0; channel < static_cast<std::size_t>(ranges_.channels); ++channel)
                    result.ranges[channel * bricks + i] = coarser.ranges[channel * bricks + i];
            }
    return result;
}

std::vector<std::pair<std::string, double>> BrickStream::counters() const {
    const std::size_t base = pyramid_.brickCount(base_);
    const auto brick = static_cast<double>(BrickPyramid::kStoredVoxels) * gpu::bytesPerTexel(form_.format);
    return {{"bricks_base", static_cast<double>(base)},
            {"bricks_wanted", static_cast<double>(wanted_)},
            {"bricks_missing", static_cast<double>(slots_.missing())},
            {"bricks_resident", static_cast<double>(slots_.used())},
            {"bricks_room", static_cast<double>(slots_.size())},
            {"bricks_loaded", static_cast<double>(loaded_)},
            {"bricks_loaded_bytes", static_cast<double>(loaded_) * brick},
            {"volume_memory_bytes", static_cast<double>(bytes_)}};
}

} // namespace apeiron::volume
