#include "terrain/background.hpp"

#include "terrain/frustum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace apeiron::terrain {
namespace {

/// Faces: forward, right, backward, left at the side, then above and below.
constexpr int kAbove = 4;
constexpr int kBelow = 5;

/// Right, up and backward of a face in the world.
glm::dmat3 faceBasis(int face) {
    if (face == kAbove) return {glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, -1)};
    if (face == kBelow) return {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
    constexpr std::array<glm::dvec2, 4> kRight{glm::dvec2(1, 0), {0, 1}, {-1, 0}, {0, -1}};
    const glm::dvec2 right = kRight[static_cast<std::size_t>(face)];
    return {glm::dvec3(right, 0.0), glm::dvec3(0, 0, 1), glm::dvec3(right.y, -right.x, 0.0)};
}

const Frustum& faceFrustum(std::size_t face) {
    static const std::array<Frustum, 6> kFrustums{Frustum(faceBasis(0), 1.0, 1.0), Frustum(faceBasis(1), 1.0, 1.0),
                                                  Frustum(faceBasis(2), 1.0, 1.0), Frustum(faceBasis(3), 1.0, 1.0),
                                                  Frustum(faceBasis(4), 1.0, 1.0), Frustum(faceBasis(5), 1.0, 1.0)};
    return kFrustums[face];
}

/// Faces are begun when the view is so near to them: a part of its own width.
constexpr double kNear = 1.15;

/// What showing the cube costs, in tiles that could be drawn meanwhile.
constexpr double kShowing = 20.0;
/// A cube must save so much of a picture's tiles.
constexpr double kWorthwhile = 0.08;
/// It is to be complete after this part of the pictures that it will do for.
constexpr double kHurry = 0.4;
/// Tiles drawn into it in a picture.
constexpr double kFewestTiles = 6.0;
constexpr double kMostTiles = 48.0;

/// Of the tiles that there is room for, those in a cube.
constexpr double kRoom = 0.4;
/// Pictures to wait after a cube that was out of date before it was complete; twice as many each time.
constexpr int kLeastWait = 16;
constexpr int kMostWait = 256;
/// ... and after so many in any case.
constexpr double kLongest = 40.0;

/// What a speed counts in the mean of the pictures' before.
constexpr double kFresh = 0.3;

gpu::Raster makeTileRaster(const gpu::Context& context) {
    gpu::ShaderSource vertex;
    vertex.addFile("terrain/glsl/tile_vertex.glsl");
    gpu::ShaderSource fragment;
    fragment.addFile("terrain/glsl/face_fragment.glsl");
    return {context, "terrain background tiles", vertex, fragment, tileAttributes()};
}

gpu::Raster makeFaceRaster(const gpu::Context& context) {
    gpu::ShaderSource vertex;
    vertex.addFile("terrain/glsl/background_vertex.glsl");
    gpu::ShaderSource fragment;
    fragment.addFile("terrain/glsl/background_fragment.glsl");
    return {context, "terrain background", vertex, fragment, {{"corner", 2, true, false, 0}}};
}

gpu::Buffer makeBuffer(const gpu::Context& context, gpu::Buffer::Kind kind, std::span<const std::byte> bytes) {
    return {context, kind, bytes, "background face"};
}

} // namespace

Background::Background(const gpu::Context& context)
    : context_(context), tileRaster_(makeTileRaster(context)), faceRaster_(makeFaceRaster(context)) {
    const std::array<glm::ivec2, 4> corners{glm::ivec2(-1, -1), {1, -1}, {-1, 1}, {1, 1}};
    const std::array<std::uint16_t, 6> indices{0, 1, 2, 2, 1, 3};
    faceVertices_ = makeBuffer(context, gpu::Buffer::Kind::Vertices, std::as_bytes(std::span(corners)));
    faceIndices_ = makeBuffer(context, gpu::Buffer::Kind::Indices, std::as_bytes(std::span(indices)));
}

void Background::learn(const std::vector<Tile>& tiles, std::int64_t level) {
    seen_.assign(seen_.size(), 0.0);
    for (const Tile& tile : tiles) {
        const std::int64_t up = std::max<std::int64_t>(level - tile.cell.level, 0);
        if (up >= static_cast<std::int64_t>(seen_.size())) seen_.resize(static_cast<std::size_t>(up) + 1);
        seen_[static_cast<std::size_t>(up)] += 1.0;
    }
}

std::optional<Background::Standing> Background::standing(const Cube& cube, const Place& place,
                                                         const SelectionView& view, int side) const {
    if (!cube.place || cube.side != side || cube.view.relief != view.relief || cube.view.ratio != view.ratio ||
        cube.view.tileLevels != view.tileLevels || cube.view.octaves != view.octaves) {
        return std::nullopt;
    }
    const std::optional<glm::dvec3> offset = offsetBetween(*cube.place, place);
    if (!offset) return std::nullopt;
    Standing standing;
    standing.way = *offset * glm::dvec3(1.0, 1.0, view.relief);
    standing.scale = std::ldexp(1.0, static_cast<int>(place.level() - cube.place->level()));
    standing.left = cube.reach * standing.scale - glm::length(standing.way);
    if (standing.left < 0.0) return std::nullopt;
    return standing;
}

Background::Plan Background::plan(const SelectionView& view, int side, double room) const {
    Plan best;
    double saved = 0.0;
    double all = 0.0;
    for (const double tiles : seen_)
        all += tiles;
    for (auto up = static_cast<int>(seen_.size()) - 1; up >= 1; --up) {
        saved += seen_[static_cast<std::size_t>(up)];
        const double reach = view.ratio * std::ldexp(1.0, up) / side;
        const double pictures = std::min(reach / std::max(speed_, 1e-12), 1e6);
        const double drawn = perTile_ * saved;
        const double each =
            std::clamp(std::ceil(drawn / (kHurry * std::min(pictures, kLongest))), kFewestTiles, kMostTiles);
        const double makes = drawn / each;
        if (makes > kHurry * pictures || drawn > kRoom * room) continue;
        // The next one is begun so that it is complete when this one has had its time.
        const double gain = saved - drawn / std::max(pictures - makes, 1.0) - kShowing;
        if (gain > std::max(best.gain, kWorthwhile * all)) best = {up, gain, static_cast<int>(each), makes};
    }
    return best;
}

void Background::want(Cube& cube, const SelectionView& view) {
    const Frustum wide(view.camera, kNear * view.tanHalfFov, view.aspect);
    for (std::size_t i = 0; i < cube.faces.size(); ++i)
        cube.faces[i].wanted = cube.faces[i].wanted || faceFrustum(i).meets(wide);
}

bool Background::complete(const Cube& cube, const Frustum& seen) {
    for (std::size_t i = 0; i < cube.faces.size(); ++i) {
        if (faceFrustum(i).meets(seen) && !cube.faces[i].complete()) return false;
    }
    return true;
}

void Background::begin(const Place& place, const SelectionView& view, int side, bool reversed, const Plan& plan) {
    if (back_.side != side) back_ = Cube{};
    back_.place = place;
    back_.view = view;
    back_.view.behind = nullptr;
    back_.view.deepest = std::numeric_limits<std::int64_t>::max();
    back_.view.finest = place.level() - plan.up;
    back_.view.cullFrustum = false;
    back_.side = side;
    back_.reversed = reversed;
    back_.reach = view.ratio * std::ldexp(1.0, plan.up) / side;
    back_.cells.clear();
    back_.ranges.clear();
    for (Face& face : back_.faces) {
        face.wanted = false;
        face.done = 0;
        face.tiles.clear();
    }
    selection_.select(place, back_.view);
    back_.eye = selection_.camera();
    back_.clearance = selection_.lastClearance();
    std::vector<Tile> tiles = selection_.tiles();
    std::stable_sort(tiles.begin(), tiles.end(), [reversed](const Tile& a, const Tile& b) {
        return reversed ? a.level > b.level : a.level < b.level;
    });
    for (const Tile& tile : tiles) {
        back_.cells.insert({tile.cell.level, tile.cell.x, tile.cell.y});
        const double edge = tile.spacing * (1 << view.tileLevels);
        back_.ranges[tile.level].include(depthRangeOf(tile, edge, back_.eye, back_.clearance));
        const glm::dvec2 least = glm::dvec2(tile.offset) * tile.spacing - glm::dvec2(back_.eye);
        const Box box{{least, tile.least}, {least + edge, tile.most}};
        for (std::size_t i = 0; i < back_.faces.size(); ++i) {
            if (faceFrustum(i).sees(box, Frustum::kAll) != Frustum::kOutside) back_.faces[i].tiles.push_back(tile);
        }
    }
    want(back_, view);
    double saved = 0.0;
    for (auto up = static_cast<std::size_t>(plan.up); up < seen_.size(); ++up)
        saved += seen_[up];
    double drawn = 0.0;
    for (const Face& face : back_.faces)
        drawn += face.wanted ? static_cast<double>(face.tiles.size()) : 0.0;
    if (saved > 0.0) perTile_ = std::clamp(drawn / saved, 1.0, 10.0);
    each_ = plan.each;
}

void Background::look(const Place& place, const SelectionView& view, int side, bool reversed, int room) {
    staged_.clear();
    shown_ = false;
    const std::optional<glm::dvec3> moved = last_ ? offsetBetween(*last_, place) : std::nullopt;
    const bool steady = moved && relief_ == view.relief; // the relief of self-affine ground changes on the way
    if (moved) {
        const double scale = std::ldexp(1.0, static_cast<int>(place.level() - last_->level()));
        speed_ = (1.0 - kFresh) * scale * speed_ + kFresh * glm::length(*moved * glm::dvec3(1.0, 1.0, view.relief));
    }
    last_ = place;
    relief_ = view.relief;

    const Frustum seen(view.camera, view.tanHalfFov, view.aspect);
    std::optional<Standing> front = standing(front_, place, view, side);
    std::optional<Standing> back = standing(back_, place, view, side);
    if (back) want(back_, view);
    if (back && complete(back_, seen)) {
        std::swap(front_, back_);
        std::swap(front, back);
        back.reset(); // what it was replaced by is better
        back_.place.reset();
        wait_ = 0;
    }
    if (!back && back_.place) {
        back_.place.reset();
        wait_ = std::clamp(2 * wait_, kLeastWait, kMostWait);
        waited_ = 0;
    }
    if (front) {
        want(front_, view);
        standing_ = *front;
        shown_ = complete(front_, seen);
    } else {
        front_.place.reset();
    }
    if (back || !steady || ++waited_ < wait_) return;
    const Plan best = plan(view, side, room);
    if (best.gain <= 0.0) return;
    if (front) {
        const bool runsOut = front->left < 1.2 * (best.makes + 2.0) * speed_;
        const auto nearest = static_cast<int>(place.level() - front_.view.finest);
        if (!runsOut && best.up + 2 > nearest) return;
    }
    begin(place, view, side, reversed, best);
}

void Background::stage(TileCache& cache, std::int64_t most, TileCache::Maker maker, gpu::KernelCache& kernels,
                       gpu::Stage stage) {
    staged_.clear();
    most /= 2; // the rest is for what lies ahead
    const auto isOpen = [](const Face& face) { return face.wanted && !face.complete(); };
    Cube* cube = nullptr;
    for (Cube* one : {&front_, &back_}) {
        if (cube == nullptr && one->place && std::any_of(one->faces.begin(), one->faces.end(), isOpen)) cube = one;
    }
    if (cube == nullptr) return;
    stagedFor_ = cube;
    for (Face& face : cube->faces) {
        if (!isOpen(face)) continue;
        if (face.seen.size().x != cube->side) {
            face.seen = gpu::Texture(context_, gpu::PixelFormat::RGBA32F, glm::ivec2(cube->side), "terrain background");
            face.targets = gpu::DepthTargets(context_, {&face.seen});
        }
        // (A face without a tile is cleared all the same.)
        if (face.done == 0) face.targets.clear(glm::vec4(0.0F), cube->reversed);
        for (std::size_t i = face.done; i < face.tiles.size(); ++i) {
            if (static_cast<int>(staged_.size()) >= each_) return;
            const Tile& tile = face.tiles[i];
            glm::ivec2 at = cache.find(tile);
            if (at.x < 0 && most-- > 0) at = cache.place(tile, *cube->place, maker, kernels, stage);
            if (at.x < 0) return;
            staged_.push_back({&face, instanceOf(tile, at, cube->place->level()), tile.level});
        }
    }
}

void Background::work(const TileCache& cache, const gpu::Buffer& vertices, const gpu::Buffer& indices, int indexCount,
                      int stride) {
    if (staged_.empty()) return;
    const Cube& cube = *stagedFor_;
    std::vector<TileInstance> instances;
    for (const Staged& staged : staged_)
        instances.push_back(staged.instance);
    const auto bytes = std::as_bytes(std::span<const TileInstance>(instances));
    if (!instances_)
        instances_ = gpu::Buffer(context_, gpu::Buffer::Kind::Vertices, bytes, "background tiles");
    else
        instances_.upload(bytes);
    tileRaster_.set("tile_heights", cache.heights());
    tileRaster_.set("tile_slopes", cache.slopes());
    tileRaster_.set("tile_stride", stride);
    tileRaster_.set("tile_cells", 1 << cache.tileLevels());
    tileRaster_.set("tile_camera", glm::vec3(cube.eye));
    tileRaster_.set("tile_moved", glm::vec3(0.0F));
    tileRaster_.set("tile_clearance", static_cast<float>(cube.clearance));
    tileRaster_.set("tile_film", glm::vec2(1.0F));
    tileRaster_.set("tile_shift", glm::vec2(0.0F));
    tileRaster_.set("tile_lens", glm::vec3(0.0F));
    // Without a reversed depth level by level, from far to near: see Scenery::draw().
    std::size_t first = 0;
    while (first < staged_.size()) {
        Face& face = *staged_[first].face;
        const std::int64_t level = staged_[first].level;
        std::size_t end = first;
        while (end < staged_.size() && staged_[end].face == &face && (cube.reversed || staged_[end].level == level))
            ++end;
        const auto index = static_cast<int>(&face - cube.faces.data());
        tileRaster_.set("tile_basis", glm::mat3(faceBasis(index)));
        if (!cube.reversed && (face.done == 0 || face.tiles[face.done - 1].level != level))
            face.targets.clearDepth(false);
        tileRaster_.set("tile_depth", cube.reversed ? glm::vec3(0.0F, nearestDrawn(cube.clearance), 0.0F)
                                                    : cube.ranges.at(level).projection());
        tileRaster_.draw(face.targets,
                         {vertices, sizeof(glm::ivec2), indices, indexCount, instances_, sizeof(TileInstance)},
                         static_cast<int>(first), static_cast<int>(end - first),
                         cube.reversed ? gpu::Raster::Depth::Reversed : gpu::Raster::Depth::Common);
        face.done += end - first;
        drawn_ += static_cast<std::int64_t>(end - first);
        first = end;
    }
    staged_.clear();
}

void Background::show(const gpu::DepthTargets& targets, const Eye& eye) {
    faceRaster_.set("tile_basis", eye.basis);
    faceRaster_.set("tile_film", eye.film);
    faceRaster_.set("tile_shift", eye.shift);
    faceRaster_.set("tile_lens", eye.lens);
    faceRaster_.set("tile_depth", glm::vec3(front_.reversed ? 0.0F : 1.0F, 0.0F, 0.0F));
    faceRaster_.set("background_side", front_.side);
    faceRaster_.set("background_way", glm::vec3(standing_.way));
    faceRaster_.set("background_scale", static_cast<float>(standing_.scale));
    for (std::size_t i = 0; i < front_.faces.size(); ++i) {
        const Face& face = front_.faces[i];
        if (!face.complete() || face.tiles.empty()) continue;
        const auto index = static_cast<int>(i);
        faceRaster_.set("background_seen", face.seen);
        faceRaster_.set("background_face", glm::mat3(faceBasis(index)));
        faceRaster_.set("background_kind", index == kBelow ? 1.0F : index == kAbove ? -1.0F : 0.0F);
        faceRaster_.draw(targets, {faceVertices_, sizeof(glm::ivec2), faceIndices_, 6, faceVertices_, 0}, 0, 1,
                         front_.reversed ? gpu::Raster::Depth::Reversed : gpu::Raster::Depth::Common);
    }
}

double Background::progress() const {
    if (!back_.place) return 1.0;
    double all = 0.0;
    double done = 0.0;
    for (const Face& face : back_.faces) {
        if (!face.wanted) continue;
        all += static_cast<double>(face.tiles.size());
        done += static_cast<double>(face.done);
    }
    return all > 0.0 ? done / all : 1.0;
}

} // namespace apeiron::terrain
