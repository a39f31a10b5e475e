#include "terrain/selection.hpp"

#include "terrain/cell_cache.hpp"
#include "terrain/frustum.hpp"
#include "terrain/height_detail.hpp"
#include "terrain/horizon.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace apeiron::terrain {
namespace {

constexpr std::int64_t kDeepest = 20; ///< levels below the place's that clearances are looked for at most
/// The same of tiles, which matters under ground only: offsets from the origin have 14 + 8 + 8 bits then.
constexpr std::int64_t kDeepestTile = 6;

/// The camera as one level's cells see it.
struct Level {
    std::uint32_t x = 0; ///< the cell that holds the camera
    std::uint32_t y = 0;
    glm::dvec2 fraction{0.0}; ///< the camera in it [cells]
    double edge = 0.0;        ///< of a cell [world]
    std::uint64_t height = 0; ///< the camera's [2^-32 units]
    double unit = 0.0;        ///< of height [world]
};

/// One turn's camera on all levels from the roots' on.
class Levels {
  public:
    Levels(const Place& place, double relief, int octaves)
        : first_(std::max<std::int64_t>(0, place.level() - octaves)), place_(place.level()) {
        const Shape& shape = place.shape();
        const auto count = static_cast<std::size_t>(place_ - first_ + kDeepest + 1);
        levels_.resize(count);
        const std::int64_t exponent = heightExponent(shape, place_);
        const auto unitOf = [&](std::int64_t n) {
            return relief * std::ldexp(1.0, static_cast<int>(exponent - heightExponent(shape, n)) - kFractionBits);
        };
        Level level;
        level.x = place.block().x;
        level.y = place.block().y;
        level.fraction = {std::ldexp(static_cast<double>(place.x() >> 11U), -53),
                          std::ldexp(static_cast<double>(place.y() >> 11U), -53)};
        level.edge = 1.0;
        level.height = place.height();
        level.unit = unitOf(place_);
        at(place_) = level;
        std::uint64_t x = place.x();
        std::uint64_t y = place.y();
        for (std::int64_t n = place_ + 1; n < first_ + static_cast<std::int64_t>(count); ++n) {
            level.x = 2U * level.x + static_cast<std::uint32_t>(x >> 63U);
            level.y = 2U * level.y + static_cast<std::uint32_t>(y >> 63U);
            x <<= 1U;
            y <<= 1U;
            level.fraction = {std::ldexp(static_cast<double>(x >> 11U), -53),
                              std::ldexp(static_cast<double>(y >> 11U), -53)};
            level.edge *= 0.5;
            level.height <<= static_cast<unsigned>(heightStep(shape, n));
            level.unit = unitOf(n);
            at(n) = level;
        }
        level = at(place_);
        for (std::int64_t n = place_ - 1; n >= first_; --n) {
            const glm::dvec2 bit(static_cast<double>(level.x & 1U), static_cast<double>(level.y & 1U));
            level.x = place.block(n).x;
            level.y = place.block(n).y;
            level.fraction = 0.5 * (level.fraction + bit);
            level.edge *= 2.0;
            level.unit = unitOf(n);
            at(n) = level;
        }
        // The heights in one go: each level's follows from the one below.
        std::uint64_t height = place.height();
        for (std::int64_t n = place_; n > first_; --n) {
            height = detail::parentHeight(height, place.block(n - 1).heights[14], heightStep(shape, n));
            at(n - 1).height = height;
        }
    }

    /// Moves the camera, on all levels, by an offset [world].
    void shift(const glm::dvec3& offset) {
        for (Level& level : levels_) {
            level.fraction += glm::dvec2(offset) / level.edge;
            const double units = std::ldexp(offset.z / level.unit, 32);
            if (std::abs(units) < 9e18) level.height += static_cast<std::uint64_t>(std::llround(units));
        }
    }

    std::int64_t first() const { return first_; }
    std::int64_t place() const { return place_; }
    std::int64_t last() const { return first_ + static_cast<std::int64_t>(levels_.size()) - 1; }
    Level& at(std::int64_t level) { return levels_[static_cast<std::size_t>(level - first_)]; }
    const Level& at(std::int64_t level) const { return levels_[static_cast<std::size_t>(level - first_)]; }

    Box box(const CellCache::Node& node) const {
        const Level& level = at(node.key.level);
        const double x = static_cast<double>(static_cast<std::int32_t>(node.key.x - level.x)) - level.fraction.x;
        const double y = static_cast<double>(static_cast<std::int32_t>(node.key.y - level.y)) - level.fraction.y;
        const auto corner = static_cast<std::int64_t>(detail::ringHeight(node.corner) - level.height);
        const double z = static_cast<double>(corner) * 0x1p-32;
        return {{x * level.edge, y * level.edge, (z + node.bounds.least) * level.unit},
                {(x + 1.0) * level.edge, (y + 1.0) * level.edge, (z + node.bounds.most) * level.unit}};
    }

  private:
    std::int64_t first_;
    std::int64_t place_;
    std::vector<Level> levels_;
};

double outside(double least, double most) {
    return std::max({0.0, least, -most});
}

/// max(|dx|, |dy|) of the box's nearest point.
double groundDistance(const Box& box) {
    return std::max(outside(box.least.x, box.most.x), outside(box.least.y, box.most.y));
}

/// To the box and everything under it.
double distanceTo(const Box& box) {
    return glm::length(
        glm::dvec3(outside(box.least.x, box.most.x), outside(box.least.y, box.most.y), std::max(0.0, -box.most.z)));
}

/// Children from the one that is nearest to the camera on: of two cells, one that can hide the other comes first.
std::array<int, 4> nearFirst(const Box& box) {
    const int x = box.least.x + box.most.x > 0.0 ? 0 : 1;
    const int y = box.least.y + box.most.y > 0.0 ? 0 : 1;
    const int first = x + 2 * y;
    return {first, first ^ 1, first ^ 2, first ^ 3};
}

/// The nine cells about the camera's, likewise; more at level 0, where the lattice needs no parents.
std::vector<std::int32_t> rootsOf(CellCache& cache, const Place& place, std::int64_t level) {
    const int radius = level == 0 ? 3 : 1;
    std::vector<glm::ivec2> offsets;
    for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x)
            offsets.emplace_back(x, y);
    }
    const auto key = [](glm::ivec2 o) { return std::abs(o.x) + std::abs(o.y); };
    std::stable_sort(offsets.begin(), offsets.end(), [&](glm::ivec2 a, glm::ivec2 b) { return key(a) < key(b); });
    std::vector<std::int32_t> roots;
    for (const glm::ivec2 offset : offsets) {
        const Cell cell = level == 0 ? rootCell(place.shape(), static_cast<std::uint32_t>(offset.x),
                                                static_cast<std::uint32_t>(offset.y))
                                     : place.block(level).cell(offset.x, offset.y);
        roots.push_back(cache.node(place.shape(), cell));
    }
    return roots;
}

/// Whether the cell or one of its next ancestors is in the set.
bool isWithin(const CellSet& cells, CellKey key) {
    constexpr int kLevels = 8;
    for (int i = 0; i <= kLevels; ++i, key = {key.level - 1, key.x >> 1U, key.y >> 1U}) {
        if (cells.contains(key)) return true;
    }
    return false;
}

} // namespace

double splitRatio(double pictureHeight, double tanHalfFov, double pixels, int tileLevels) {
    const double perPixel = 2.0 * tanHalfFov / pictureHeight;
    return std::max(kLeastRatio, 1.0 / (pixels * perPixel * std::ldexp(1.0, tileLevels)));
}

glm::vec3 morphed(const Tile& tile, glm::ivec2 vertex, VertexHeights heights, const glm::vec3& camera,
                  float clearance) {
    const auto spacing = static_cast<float>(tile.spacing);
    const auto unit = static_cast<float>(tile.heightUnit);
    const glm::vec2 at(tile.offset + vertex);
    const float distance =
        std::max(std::max(std::abs(at.x * spacing - camera.x), std::abs(at.y * spacing - camera.y)), clearance);
    const float m = std::min(std::max(distance * tile.morphScale - tile.morphOffset, 0.0F), 1.0F);
    const float fine = static_cast<float>(heightDifference(heights.x, tile.originHeight)) * unit;
    const float coarse = static_cast<float>(heightDifference(heights.y, tile.originHeight)) * unit;
    const glm::vec2 odd(vertex & 1);
    return {(at.x - m * odd.x) * spacing, (at.y - m * odd.y) * spacing, (1.0F - m) * fine + m * coarse};
}

namespace {

/// What one walk down the tree needs.
struct Walk {
    const Place& place;
    const Levels& levels;
    double ratio;
    double clearance;
    std::int64_t deepest;
    std::int64_t finest;
    const Frustum* frustum;
    Horizon* horizon;
    const CellSet* behind;
};

} // namespace

struct Selection::State {
    CellCache cache;
    std::uint32_t turn = 0;
    std::vector<std::pair<std::int32_t, Box>> found; ///< by the last walk; kept for its memory

    /// From the nine roots down.
    void walk(const Walk& w);
    /// @param inside the camera is over the parent @param planes of the frustum that the parent is not inside of
    void walk(const Walk& w, std::int32_t index, bool inside, unsigned planes);
    double clearance(const Place& place, const Levels& levels);
    void clearanceBelow(const Place& place, const Levels& levels, std::int32_t index, double& best);
    void begin(const Place& place) {
        ++turn;
        cache.begin(place.shape(), turn);
    }
};

void Selection::State::walk(const Walk& w) {
    found.clear();
    for (const std::int32_t root : rootsOf(cache, w.place, w.levels.first())) {
        if (w.behind != nullptr && isWithin(*w.behind, cache[root].key)) continue;
        walk(w, root, false, w.frustum != nullptr ? Frustum::kAll : 0U);
    }
}

void Selection::State::walk(const Walk& w, std::int32_t index, bool inside, unsigned planes) {
    cache.see(index);
    const std::int64_t level = cache[index].key.level;
    const Box box = w.levels.box(cache[index]);
    if (planes != 0) planes = w.frustum->sees(box, planes);
    if (planes == Frustum::kOutside) return;
    if (w.horizon != nullptr && !inside && w.horizon->hides(box.least, box.most)) return;
    if (w.behind != nullptr && w.behind->contains(cache[index].key)) {
        if (w.horizon != nullptr) w.horizon->add(box.least, box.most);
        return;
    }
    const double edge = w.levels.at(level).edge;
    const double distance = groundDistance(box);
    if (std::max(distance, w.clearance) >= w.ratio * edge || level >= w.deepest) {
        found.emplace_back(index, box);
        if (w.horizon != nullptr) w.horizon->add(box.least, box.most);
        return;
    }
    if (level >= w.finest) return;
    for (const int digit : nearFirst(box))
        walk(w, cache.child(w.place.shape(), index, digit), distance == 0.0, planes);
}

void Selection::State::clearanceBelow(const Place& place, const Levels& levels, std::int32_t index, double& best) {
    cache.see(index);
    const std::int64_t level = cache[index].key.level;
    const Box box = levels.box(cache[index]);
    const double distance = distanceTo(box);
    if (distance >= best) return;
    if (box.least.z >= 0.0 && groundDistance(box) == 0.0) {
        // All ground here is above the camera. (Looking further, heights would leave their range.)
        best = 0.0;
        return;
    }
    if (levels.at(level).edge <= 0.25 * distance || level >= levels.last()) {
        best = distance;
        return;
    }
    for (const int digit : nearFirst(box))
        clearanceBelow(place, levels, cache.child(place.shape(), index, digit), best);
}

double Selection::State::clearance(const Place& place, const Levels& levels) {
    double best = std::numeric_limits<double>::infinity();
    for (const std::int32_t root : rootsOf(cache, place, levels.first()))
        clearanceBelow(place, levels, root, best);
    // Nothing is known of what is beyond the roots: they reach a cell beyond the camera's.
    return std::min(best, levels.at(levels.first()).edge);
}

Selection::Selection() : state_(std::make_unique<State>()) {}
Selection::~Selection() = default;
Selection::Selection(Selection&&) noexcept = default;
Selection& Selection::operator=(Selection&&) noexcept = default;

std::size_t Selection::cachedCells() const {
    return state_->cache.size();
}

namespace {

/// Puts tiles together from cells.
class TileMaker {
  public:
    /// @param deepest level of the tiles' cells
    TileMaker(const Place& place, const Levels& levels, const SelectionView& view, std::int64_t deepest)
        : levels_(levels), view_(view), shape_(place.shape()), originLevel_(levels.first() + view.tileLevels) {
        const Level& root = levels.at(levels.first());
        const double cells = std::ldexp(1.0, view.tileLevels);
        origin_ = {std::llround(root.fraction.x * cells), std::llround(root.fraction.y * cells)};
        // Heights of the origin: the camera's, to a whole vertex spacing of the coarsest tiles.
        const std::uint64_t height = originLevel_ <= levels.last()
                                         ? levels.at(originLevel_).height
                                         : heightBelow(levels.at(levels.last()).height, levels.last());
        constexpr std::uint32_t kSpacing = 1U << static_cast<unsigned>(kFractionBits);
        originHeight_ = (static_cast<std::uint32_t>(height >> 32U) + kSpacing / 2) & ~(kSpacing - 1U);
        const double unit = root.unit * std::ldexp(1.0, -exponentTo(originLevel_, levels.first()));
        const auto above = static_cast<std::int64_t>(height - (static_cast<std::uint64_t>(originHeight_) << 32U));
        camera_ = {(root.fraction.x - static_cast<double>(origin_.x) / cells) * root.edge,
                   (root.fraction.y - static_cast<double>(origin_.y) / cells) * root.edge,
                   std::ldexp(static_cast<double>(above), -32) * unit};
        for (std::int64_t n = levels.first(); n <= deepest; ++n)
            ofLevel_.push_back(ofLevel(n));
    }

    const glm::dvec3& camera() const { return camera_; }
    std::int64_t originLevel() const { return originLevel_; }

    Tile make(const Cell& cell, const Box& box, double clearance) const {
        Tile tile = ofLevel_[static_cast<std::size_t>(cell.level - levels_.first())];
        const auto shift = static_cast<unsigned>(view_.tileLevels);
        tile.cell = cell;
        tile.x = cell.x << shift;
        tile.y = cell.y << shift;
        // The origin in cells of the vertices' level, from the camera's root cell.
        const auto down = static_cast<unsigned>(cell.level - levels_.first());
        const Level& root = levels_.at(levels_.first());
        const auto offset = [&](std::uint32_t x, std::uint32_t rootX, std::int64_t origin) {
            const auto fromRoot = static_cast<std::int32_t>(x - (rootX << down)); // [cells]
            return static_cast<std::int32_t>((static_cast<std::int64_t>(fromRoot) << shift) - (origin << down));
        };
        tile.offset = {offset(cell.x, root.x, origin_.x), offset(cell.y, root.y, origin_.y)};
        tile.least = box.least.z;
        tile.most = box.most.z;
        tile.distance = std::max(groundDistance(box), clearance);
        return tile;
    }

  private:
    /// What all tiles have in common whose cells are of that level.
    Tile ofLevel(std::int64_t cellLevel) const {
        Tile tile;
        const Level& level = levels_.at(cellLevel);
        tile.level = cellLevel + view_.tileLevels;
        tile.originHeight =
            static_cast<std::int32_t>(originHeight_ << static_cast<unsigned>(exponentTo(tile.level, originLevel_)));
        tile.spacing = level.edge * std::ldexp(1.0, -view_.tileLevels);
        tile.heightUnit = level.unit * std::ldexp(1.0, -exponentTo(tile.level, cellLevel));
        // Morphing begins where no coarser neighbour's finer one can be, and ends before the next coarser tile.
        const double sigma = 1.01 + 1.0 / view_.ratio;
        tile.morphScale = static_cast<float>(1.0 / ((1.98 - sigma) * view_.ratio * level.edge));
        tile.morphOffset = static_cast<float>(sigma / (1.98 - sigma));
        return tile;
    }
    int exponentTo(std::int64_t level, std::int64_t from) const {
        return static_cast<int>(heightExponent(shape_, level) - heightExponent(shape_, from));
    }
    std::uint64_t heightBelow(std::uint64_t height, std::int64_t from) const {
        return height << static_cast<unsigned>(exponentTo(originLevel_, from));
    }

    const Levels& levels_;
    const SelectionView& view_;
    Shape shape_;
    std::int64_t originLevel_;
    glm::i64vec2 origin_{0}; ///< in vertices of the coarsest tiles, from the corner of the camera's root cell
    std::uint32_t originHeight_ = 0;
    glm::dvec3 camera_{0.0};
    std::vector<Tile> ofLevel_;
};

std::int64_t deepestOf(const Levels& levels, const SelectionView& view) {
    return std::max(std::min(levels.place() + kDeepestTile, view.deepest), levels.first());
}

} // namespace

const std::vector<Tile>& Selection::select(const Place& place, const SelectionView& view) {
    assert(view.ratio >= kLeastRatio && view.tileLevels >= 1 && view.tileLevels <= kMaxTileLevels);
    state_->begin(place);
    const Levels levels(place, view.relief, view.octaves);
    clearance_ = state_->clearance(place, levels);
    const Frustum frustum(view.camera, view.tanHalfFov, view.aspect);
    Horizon horizon;
    const std::int64_t deepest = deepestOf(levels, view);
    state_->walk({place, levels, view.ratio, clearance_, deepest, view.finest, view.cullFrustum ? &frustum : nullptr,
                  view.cullHorizon ? &horizon : nullptr, view.behind});
    const TileMaker maker(place, levels, view, deepest);
    tiles_.clear();
    for (const auto& [index, box] : state_->found) {
        state_->cache.draw(index);
        tiles_.push_back(maker.make(state_->cache.cell(index), box, clearance_));
    }
    camera_ = maker.camera();
    originLevel_ = maker.originLevel();
    return tiles_;
}

std::vector<Tile> Selection::prefetch(const Place& place, const SelectionView& view, const glm::dvec3& travel,
                                      std::size_t most) {
    Levels levels(place, view.relief, view.octaves);
    levels.shift(travel);
    const double clearance = state_->clearance(place, levels);
    const Frustum frustum(view.camera, view.tanHalfFov, view.aspect);
    const std::int64_t deepest = deepestOf(levels, view);
    state_->walk({place, levels, view.ratio, clearance, deepest, view.finest, view.cullFrustum ? &frustum : nullptr,
                  nullptr, view.behind});
    const TileMaker maker(place, levels, view, deepest);
    std::vector<Tile> tiles;
    for (const auto& [index, box] : state_->found) {
        if (!state_->cache.drawnInTurn(index, state_->turn))
            tiles.push_back(maker.make(state_->cache.cell(index), box, clearance));
    }
    // The finest are the nearest: what is missed first.
    std::stable_sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.distance < b.distance; });
    if (tiles.size() > most) tiles.resize(most);
    return tiles;
}

double Selection::clearance(const Place& place, double relief, int octaves) {
    state_->begin(place);
    return state_->clearance(place, Levels(place, relief, octaves));
}

} // namespace apeiron::terrain
