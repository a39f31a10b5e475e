#include "volume/brick_choice.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <queue>

namespace apeiron::volume {
namespace {

/// Bricks outside the picture are seen in shadows, reflections and scattered light only.
constexpr double kOutOfPicture = 0.25;

std::size_t indexIn(glm::ivec3 size, glm::ivec3 p) {
    return (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(p.x);
}

template <class Use> void forEach(glm::ivec3 first, glm::ivec3 end, const Use& use) {
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x)
                use(glm::ivec3(x, y, z));
}

/// Where something is needed, on every level up to the base.
using Needs = std::vector<std::vector<std::uint8_t>>;

Needs needsOf(const BrickPyramid& pyramid, int base, std::span<const std::uint8_t> needed) {
    Needs needs{{needed.begin(), needed.end()}};
    for (int level = 1; level <= base; ++level) {
        std::vector<std::uint8_t> coarser(pyramid.brickCount(level), 0);
        const glm::ivec3 size = pyramid.bricksOf(level);
        const glm::ivec3 finer = pyramid.bricksOf(level - 1);
        forEach(glm::ivec3(0), finer, [&](glm::ivec3 p) {
            if (needs.back()[indexIn(finer, p)] != 0) coarser[indexIn(size, p / 2)] = 1;
        });
        needs.push_back(std::move(coarser));
    }
    return needs;
}

/// A brick and how urgent it is.
struct Candidate {
    BrickKey key;
    double size = 0.0; ///< of its voxels [px], less where it is outside the picture
    double distance = 0.0;
};

Candidate candidate(const BrickView& view, const BrickKey& key) {
    const BrickSight sight = sightOf(view, key);
    return {key, std::ldexp(sight.pixels, key.level) * (sight.inPicture ? 1.0 : kOutOfPicture), sight.distance};
}

/// Less urgent: smaller, then farther; keys make an order of what is alike.
bool operator<(const Candidate& a, const Candidate& b) {
    if (a.size != b.size) return a.size < b.size;
    if (a.distance != b.distance) return a.distance > b.distance;
    return b.key < a.key;
}

std::vector<BrickKey> inOrder(std::vector<Candidate> all) {
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return b < a; });
    std::vector<BrickKey> keys;
    keys.reserve(all.size());
    for (const Candidate& one : all)
        keys.push_back(one.key);
    return keys;
}

/// All bricks of level 0 for which `wanted` says so.
template <class Wanted>
std::vector<BrickKey> finest(const BrickPyramid& pyramid, const BrickView& view, const Wanted& wanted) {
    std::vector<Candidate> all;
    std::size_t i = 0;
    forEach(glm::ivec3(0), pyramid.bricksOf(0), [&](glm::ivec3 p) {
        if (wanted(i++)) all.push_back(candidate(view, {0, p}));
    });
    return inOrder(std::move(all));
}

} // namespace

BrickSight sightOf(const BrickView& view, const BrickKey& key) {
    const double edge = BrickPyramid::kEdge << key.level;
    const glm::dvec3 centre(view.toCamera * glm::dvec4((glm::dvec3(key.brick) + 0.5) * edge, 1.0));
    glm::dvec3 half(0.0);
    for (int axis = 0; axis < 3; ++axis)
        half += 0.5 * edge * glm::abs(glm::dvec3(view.toCamera[axis]));
    const double radius = glm::length(half);
    BrickSight sight;
    sight.distance = std::max(glm::length(centre) - radius, 0.0);
    const double height = 0.5 * view.extent;
    const double width = height * view.aspect;
    if (view.orthographic) {
        sight.inPicture =
            std::abs(centre.y) <= height + radius && std::abs(centre.x) <= width + radius && -centre.z >= -radius;
        sight.pixels = view.voxel * view.height / view.extent;
    } else {
        const auto inside = [&](double aside, double side) {
            return std::abs(aside) <= -centre.z * side + radius * std::sqrt(1.0 + side * side);
        };
        sight.inPicture = inside(centre.y, height) && inside(centre.x, width) && -centre.z >= -radius;
        // (From within a brick its nearest voxel is as near as the next one.)
        sight.pixels = view.voxel * view.height / (view.extent * std::max(sight.distance, view.voxel));
    }
    return sight;
}

std::vector<std::uint8_t> neededBricks(const BrickPyramid& pyramid, const BrickRanges& ranges,
                                       std::span<const float> seen) {
    assert(BrickPyramid::kEdge % ranges.side == 0);
    const int perBrick = BrickPyramid::kEdge / ranges.side;
    const glm::ivec3 size = pyramid.bricksOf(0);
    std::vector<std::uint8_t> needed(pyramid.brickCount(0), 0);
    std::size_t i = 0;
    forEach(glm::ivec3(0), ranges.size, [&](glm::ivec3 p) {
        if (!(seen[i++] > 0.0F)) return;
        const glm::ivec3 first = glm::max(p - 1, glm::ivec3(0)) / perBrick;
        const glm::ivec3 last = glm::min((p + 1) / perBrick, size - 1);
        forEach(first, last + 1, [&](glm::ivec3 brick) { needed[indexIn(size, brick)] = 1; });
    });
    return needed;
}

std::vector<BrickKey> chooseBricks(const BrickPyramid& pyramid, int base, std::span<const std::uint8_t> needed,
                                   const BrickView& view, std::size_t capacity) {
    if (base == 0) return {};
    const auto wanted = static_cast<std::size_t>(std::count(needed.begin(), needed.end(), 1));
    if (wanted <= capacity) {
        std::vector<BrickKey> keys = finest(pyramid, view, [&](std::size_t i) { return needed[i] != 0; });
        if (needed.size() <= capacity) {
            const std::vector<BrickKey> rest = finest(pyramid, view, [&](std::size_t i) { return needed[i] == 0; });
            keys.insert(keys.end(), rest.begin(), rest.end());
        }
        return keys;
    }
    const Needs needs = needsOf(pyramid, base, needed);
    std::priority_queue<Candidate> queue;
    std::vector<Candidate> chosen;
    std::size_t used = 0;
    const glm::ivec3 coarsest = pyramid.bricksOf(base);
    forEach(glm::ivec3(0), coarsest, [&](glm::ivec3 p) {
        if (needs.back()[indexIn(coarsest, p)] != 0) queue.push(candidate(view, {base, p}));
    });
    while (!queue.empty() && queue.top().size > 1.0) {
        const Candidate top = queue.top();
        const int level = top.key.level - 1;
        if (level < 0) {
            chosen.push_back(top);
            queue.pop();
            continue;
        }
        const glm::ivec3 size = pyramid.bricksOf(level);
        std::vector<BrickKey> finer;
        const glm::ivec3 first = top.key.brick * 2;
        forEach(first, glm::min(first + 2, size), [&](glm::ivec3 p) {
            if (needs[static_cast<std::size_t>(level)][indexIn(size, p)] != 0) finer.push_back({level, p});
        });
        const std::size_t freed = top.key.level == base ? 0 : 1;
        if (used - freed + finer.size() > capacity) break;
        queue.pop();
        used += finer.size() - freed;
        for (const BrickKey& key : finer)
            queue.push(candidate(view, key));
    }
    for (; !queue.empty(); queue.pop())
        if (queue.top().key.level < base) chosen.push_back(queue.top());
    return inOrder(std::move(chosen));
}

} // namespace apeiron::volume
