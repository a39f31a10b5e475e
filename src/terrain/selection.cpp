#include "terrain/selection.hpp"

#include "terrain/cell_cache.hpp"
#include "terrain/frustum.hpp"
#include "terrain/height_detail.hpp"
#include "terrain/horizon.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

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
        : first_(std::max<std::int64_t>(0, place.level() - octaves)), place_(place.level()), last_(place_ + kDeepest) {
        const Shape& shape = place.shape();
        assert(place_ - first_ <= Place::kLiveLevels);
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
        for (std::int64_t n = place_ + 1; n <= last_; ++n) {
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
        for (std::int64_t n = first_; n <= last_; ++n) {
            Level& level = at(n);
            level.fraction += glm::dvec2(offset) / level.edge;
            const double units = std::ldexp(offset.z / level.unit, 32);
            if (std::abs(units) < 9e18) level.height += static_cast<std::uint64_t>(std::llround(units));
        }
    }

    std::int64_t first() const { return first_; }
    std::int64_t place() const { return place_; }
    std::int64_t last() const { return last_; }
    Level& at(std::int64_t level) { return levels_[static_cast<std::size_t>(level - first_)]; }
    const Level& at(std::int64_t level) const { return levels_[static_cast<std::size_t>(level - first_)]; }

    Box box(const CellKey& key, const CellCache::Node& node) const {
        const Level& level = at(key.level);
        const double x = static_cast<double>(static_cast<std::int32_t>(key.x - level.x)) - level.fraction.x;
        const double y = static_cast<double>(static_cast<std::int32_t>(key.y - level.y)) - level.fraction.y;
        const auto corner = static_cast<std::int64_t>(detail::ringHeight(node.corner) - level.height);
        const double z = static_cast<double>(corner) * 0x1p-32;
        return {{x * level.edge, y * level.edge, (z + node.bounds.least) * level.unit},
                {(x + 1.0) * level.edge, (y + 1.0) * level.edge, (z + node.bounds.most) * level.unit}};
    }

    /// The same of all children of a cell.
    Boxes boxes(const CellKey& parent, const CellCache::Family& family) const {
        const Level& level = at(parent.level + 1);
        const auto x = static_cast<std::int32_t>(2U * parent.x - level.x);
        const auto y = static_cast<std::int32_t>(2U * parent.y - level.y);
        Boxes boxes;
        for (std::size_t i = 0; i < 4; ++i) {
            boxes.least[0][i] = static_cast<double>(x + static_cast<std::int32_t>(i & 1U)) - level.fraction.x;
            boxes.least[1][i] = static_cast<double>(y + static_cast<std::int32_t>(i >> 1U)) - level.fraction.y;
            const auto corner = static_cast<std::int64_t>(detail::ringHeight(family[i].corner) - level.height);
            const double z = static_cast<double>(corner) * 0x1p-32;
            boxes.least[2][i] = z + family[i].bounds.least;
            boxes.most[2][i] = z + family[i].bounds.most;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            boxes.most[0][i] = (boxes.least[0][i] + 1.0) * level.edge;
            boxes.most[1][i] = (boxes.least[1][i] + 1.0) * level.edge;
            boxes.least[0][i] *= level.edge;
            boxes.least[1][i] *= level.edge;
            boxes.least[2][i] *= level.unit;
            boxes.most[2][i] *= level.unit;
        }
        return boxes;
    }

  private:
    std::int64_t first_;
    std::int64_t place_;
    std::int64_t last_;
    std::array<Level, Place::kLiveLevels + kDeepest + 1> levels_;
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
std::vector<Cell> rootsOf(const Place& place, std::int64_t level) {
    const int radius = level == 0 ? 3 : 1;
    std::vector<glm::ivec2> offsets;
    for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x)
            offsets.emplace_back(x, y);
    }
    const auto key = [](glm::ivec2 o) { return std::abs(o.x) + std::abs(o.y); };
    std::stable_sort(offsets.begin(), offsets.end(), [&](glm::ivec2 a, glm::ivec2 b) { return key(a) < key(b); });
    std::vector<Cell> roots;
    roots.reserve(offsets.size());
    for (const glm::ivec2 offset : offsets) {
        roots.push_back(level == 0 ? rootCell(place.shape(), static_cast<std::uint32_t>(offset.x),
                                              static_cast<std::uint32_t>(offset.y))
                                   : place.block(level).cell(offset.x, offset.y));
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

    /// Appends one. @param least of heights, as in a Tile @param distance D of its nearest point
    void make(std::vector<Tile>& tiles, const CellKey& cell, double least, double most, double distance) const {
        Tile& tile = tiles.emplace_back(ofLevel_[static_cast<std::size_t>(cell.level - levels_.first())]);
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
        tile.least = least;
        tile.most = most;
        tile.distance = distance;
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

/// What one walk down the tree needs.
struct Walk {
    const Levels& levels;
    double ratio;
    double clearance;
    std::int64_t deepest;
    std::int64_t finest;
    const Frustum* frustum;
    Horizon* horizon;
    const CellSet* behind;
    const TileMaker& maker;
    std::vector<Tile>& found; ///< the tiles to draw
    bool others;              ///< but those that this turn drew already
};

/// Four cells that a walk looks at, and all that it can know of them before it does.
struct Four {
    Boxes boxes;
    std::array<unsigned, 4> planes{}; ///< of the frustum that each is not inside of; Frustum::kOutside
    Boxes::Row distance;              ///< along the ground, the greater coordinate's
    Horizon::Footprints footprints;   ///< where there is a horizon
};

/// @param planes of the frustum that all four are not inside of as one
Four lookAt(const Walk& w, const Boxes& boxes, unsigned planes) {
    Four four;
    four.boxes = boxes;
    if (planes != 0) {
        four.planes = w.frustum->sees(boxes, planes);
        if (std::count(four.planes.begin(), four.planes.end(), Frustum::kOutside) == 4) return four;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const double x = larger(boxes.least[0][i], -boxes.most[0][i]);
        const double y = larger(boxes.least[1][i], -boxes.most[1][i]);
        four.distance[i] = larger(larger(x, y), 0.0);
    }
    if (w.horizon != nullptr) four.footprints = Horizon::footprints(boxes);
    return four;
}

} // namespace

struct Selection::State {
    CellCache cache;
    std::uint32_t turn = 0;
    std::optional<Block> rootBlock; ///< about which the cache's roots are

    /// From the nine roots down.
    void walk(const Walk& w);
    /// One of the four and what is below. @param inside the camera is over the parent
    void visit(const Walk& w, const Four& four, std::size_t i, const CellKey& key, CellCache::Place place, bool inside);
    double clearance(const Levels& levels);
    void clearanceBelow(const Levels& levels, const CellKey& key, CellCache::Place place, const Box& box, double& best);
    void begin(const Place& place, int octaves);
};

void Selection::State::begin(const Place& place, int octaves) {
    ++turn;
    cache.begin(place.shape(), turn);
    const std::int64_t level = std::max<std::int64_t>(0, place.level() - octaves);
    const Block& block = place.block(level);
    if (!cache.roots().empty() && rootBlock == block) return;
    cache.setRoots(rootsOf(place, level));
    rootBlock = block;
}

void Selection::State::walk(const Walk& w) {
    for (std::size_t first = 0; first < cache.roots().size(); first += 4) {
        const std::size_t count = std::min<std::size_t>(cache.roots().size() - first, 4);
        std::array<CellKey, 4> keys;
        Boxes boxes;
        for (std::size_t i = 0; i < 4; ++i) {
            const CellCache::Root& root = cache.roots()[first + std::min(i, count - 1)];
            keys[i] = {root.cell.level, root.cell.x, root.cell.y};
            boxes.set(i, w.levels.box(keys[i], root.node));
        }
        const Four four = lookAt(w, boxes, w.frustum != nullptr ? Frustum::kAll : 0U);
        for (std::size_t i = 0; i < count; ++i) {
            if (w.behind != nullptr && isWithin(*w.behind, keys[i])) continue;
            visit(w, four, i, keys[i], {-1, static_cast<std::int32_t>(first + i)}, false);
        }
    }
}

void Selection::State::visit(const Walk& w, const Four& four, std::size_t i, const CellKey& key, CellCache::Place place,
                             bool inside) {
    if (four.planes[i] == Frustum::kOutside) return;
    const double distance = four.distance[i];
    const bool horizon = w.horizon != nullptr && Horizon::isOutside(four.boxes, i);
    if (horizon && !inside && w.horizon->hides(four.footprints, i)) return;
    if (w.behind != nullptr && w.behind->contains(key)) {
        if (horizon) w.horizon->add(four.footprints, i);
        return;
    }
    if (larger(distance, w.clearance) >= w.ratio * w.levels.at(key.level).edge || key.level >= w.deepest) {
        if (!w.others) cache.draw(place);
        if (!w.others || !cache.drawnInTurn(place, turn))
            w.maker.make(w.found, key, four.boxes.least[2][i], four.boxes.most[2][i], larger(distance, w.clearance));
        if (horizon) w.horizon->add(four.footprints, i);
        return;
    }
    if (key.level >= w.finest) return;
    const std::int32_t family = cache.children(place, key);
    cache.see(family);
    const CellCache::Family& nodes = cache[family];
    const Four children = lookAt(w, w.levels.boxes(key, nodes), four.planes[i]);
    for (std::size_t k = 0; k < 4; ++k) {
        if (children.planes[k] != Frustum::kOutside) cache.fetch(nodes[k].children);
    }
    for (const int digit : nearFirst(four.boxes[i])) {
        visit(w, children, static_cast<std::size_t>(digit), childKey(key, digit), {family, digit}, distance == 0.0);
    }
}

void Selection::State::clearanceBelow(const Levels& levels, const CellKey& key, CellCache::Place place, const Box& box,
                                      double& best) {
    const double distance = distanceTo(box);
    if (distance >= best) return;
    if (box.least.z >= 0.0 && groundDistance(box) == 0.0) {
        // All ground here is above the camera. (Looking further, heights would leave their range.)
        best = 0.0;
        return;
    }
    if (levels.at(key.level).edge <= 0.25 * distance || key.level >= levels.last()) {
        best = distance;
        return;
    }
    const std::int32_t family = cache.children(place, key);
    cache.see(family);
    const Boxes boxes = levels.boxes(key, cache[family]);
    for (const int digit : nearFirst(box))
        clearanceBelow(levels, childKey(key, digit), {family, digit}, boxes[static_cast<std::size_t>(digit)], best);
}

double Selection::State::clearance(const Levels& levels) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cache.roots().size(); ++i) {
        const CellCache::Root& root = cache.roots()[i];
        const CellKey key{root.cell.level, root.cell.x, root.cell.y};
        clearanceBelow(levels, key, {-1, static_cast<std::int32_t>(i)}, levels.box(key, root.node), best);
    }
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

std::int64_t deepestOf(const Levels& levels, const SelectionView& view) {
    return std::max(std::min(levels.place() + kDeepestTile, view.deepest), levels.first());
}

} // namespace

const std::vector<Tile>& Selection::select(const Place& place, const SelectionView& view) {
    assert(view.ratio >= kLeastRatio && view.tileLevels >= 1 && view.tileLevels <= kMaxTileLevels);
    state_->begin(place, view.octaves);
    const Levels levels(place, view.relief, view.octaves);
    clearance_ = state_->clearance(levels);
    const Frustum frustum(view.camera, view.tanHalfFov, view.aspect);
    Horizon horizon;
    const std::int64_t deepest = deepestOf(levels, view);
    const TileMaker maker(place, levels, view, deepest);
    tiles_.clear();
    state_->walk({levels, view.ratio, clearance_, deepest, view.finest, view.cullFrustum ? &frustum : nullptr,
                  view.cullHorizon ? &horizon : nullptr, view.behind, maker, tiles_, false});
    camera_ = maker.camera();
    originLevel_ = maker.originLevel();
    return tiles_;
}

std::vector<Tile> Selection::prefetch(const Place& place, const SelectionView& view, const glm::dvec3& travel,
                                      std::size_t most) {
    Levels levels(place, view.relief, view.octaves);
    levels.shift(travel);
    const double clearance = state_->clearance(levels);
    const Frustum frustum(view.camera, view.tanHalfFov, view.aspect);
    const std::int64_t deepest = deepestOf(levels, view);
    const TileMaker maker(place, levels, view, deepest);
    std::vector<Tile> tiles;
    state_->walk({levels, view.ratio, clearance, deepest, view.finest, view.cullFrustum ? &frustum : nullptr, nullptr,
                  view.behind, maker, tiles, true});
    // The finest are the nearest: what is missed first.
    std::stable_sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.distance < b.distance; });
    if (tiles.size() > most) tiles.resize(most);
    return tiles;
}

double Selection::clearance(const Place& place, double relief, int octaves) {
    state_->begin(place, octaves);
    return state_->clearance(Levels(place, relief, octaves));
}

} // namespace apeiron::terrain
