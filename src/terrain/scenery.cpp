#include "terrain/scenery.hpp"

#include "core/stopwatch.hpp"
#include "render/view.hpp"
#include "scene/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace apeiron::terrain {
namespace {

using parameter::Decimal3;

/// What subject.relief takes.
constexpr double kLeastRelief = 0.05;
constexpr double kMostRelief = 4.0;

/// The depth of a place between levels: where the ground is half as far, it is one more.
double zoomOf(const Place& place, double clearance) {
    return static_cast<double>(place.level()) - std::log2(std::max(clearance, 1e-6));
}

/// Choices of subject.debug.
constexpr int kBorders = 2;
constexpr int kWireframe = 3;
constexpr int kBoxes = 4;
constexpr int kCorners = 5;

/// Tiles reach this much beyond the picture, for the filter's reach.
constexpr double kWider = 1.02;

/// Most tiles that are made for one picture when there is an older one to go on from: some milliseconds.
constexpr std::int64_t kMostMade = 24;

/// How far ahead tiles are made before they are needed: where the ground is half as far, an octave deeper.
constexpr double kPrefetchReach = 0.5;

/// Of the autopilot: flown in one go, of the distance to the ground.
constexpr double kMostFlown = 0.35;

/// A camera stops where the ground is so much nearer than at the way's beginning.
constexpr double kNearest = 0.05;

template <class T> std::span<const std::byte> bytesOf(const std::vector<T>& values) {
    return std::as_bytes(std::span<const T>(values));
}

} // namespace

Site::Site(const scene::Scene& scene) {
    const parameter::Node& subject = scene.subject;
    shape.kernel = subject.text("kernel") == "bilinear" ? Kernel::Bilinear : Kernel::BSpline;
    shape.seed = static_cast<std::uint32_t>(subject.integer("seed"));
    shape.hurst = std::clamp(static_cast<int>(std::lround(1000.0 * subject.number("hurst"))), 1, 1000);
    try {
        address = Address::parse(subject.text("address"));
    } catch (const Error& error) {
        throw Error(ErrorKind::BadInput, error.what(), "subject.address");
    }
    const std::int64_t depth = subject.integer("depth");
    if (depth > address.levels()) address = flatSeekingAddress(shape, address, depth);
    relief = subject.number("relief");
}

Scenery::Scenery(const gpu::Context& context) : context_(context), clipmap_(context) {}

const Site& Scenery::site(const scene::Scene& scene) {
    if (!subject_ || *subject_ != scene.subject) {
        Site site(scene);
        if (!corner_ || corner_->shape() != site.shape || corner_->address() != site.address)
            corner_.emplace(site.shape, site.address);
        site_ = std::move(site);
        subject_ = scene.subject;
    }
    return *site_;
}

Place Scenery::placeOf(const scene::Scene& scene) {
    glm::dvec3 position = render::difference(scene.camera.get<Decimal3>("position"), {});
    position.z /= site(scene).relief;
    Place place = *corner_;
    constexpr double kFar = 200'000.0;
    const bool there = std::abs(position.x) < kFar && std::abs(position.y) < kFar && std::abs(position.z) < kFar;
    if (!there || !place.move(position)) {
        throw Error(ErrorKind::BadInput, "the camera is outside the terrain's root cell or very far from its address",
                    "camera.position", "positions are in cells of the address; choose a longer subject.address");
    }
    // Under the ground there is nothing to see: straight up until it is left.
    lifted_ = false;
    double step = 0.02;
    while (step < kFar && selection_.clearance(place, site_->relief, view_.octaves) <= 0.0) {
        lifted_ = true;
        place.move({0.0, 0.0, step / site_->relief});
        step *= 1.5;
    }
    return place;
}

void Scenery::put(scene::Scene& scene, const Place& place, double relief, double scale) {
    const scene::Camera camera(scene.camera);
    const glm::dvec3 ahead = scale * render::difference(camera.target(), camera.position());
    const glm::dvec3 position = place.position() * glm::dvec3(1.0, 1.0, relief);
    const auto decimals = [](const glm::dvec3& v) { return Decimal3{Decimal(v.x), Decimal(v.y), Decimal(v.z)}; };
    scene.camera.set("position", decimals(position));
    scene.camera.set("target", decimals(position + ahead));
    const double focus = scene.camera.number("focus") * scale;
    if (focus > 0.0) scene.camera.set("focus", std::min(focus, 1e6));
    scene.subject.set("address", place.address().toString());
    scene.subject.set("depth", std::int64_t{0});
    scene.subject.set("relief", std::clamp(relief, kLeastRelief, kMostRelief));
}

void Scenery::makeMesh(int cells) {
    if (meshCells_ == cells) return;
    std::vector<glm::ivec2> vertices;
    std::vector<std::uint16_t> indices;
    const auto at = [cells](int x, int y) { return static_cast<std::uint16_t>(y * (cells + 1) + x); };
    for (int y = 0; y <= cells; ++y) {
        for (int x = 0; x <= cells; ++x)
            vertices.emplace_back(x, y);
    }
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            // Diagonals alternate about even vertices, so that the mesh of twice the spacing has the same.
            const bool flip = (x + y) % 2 != 0;
            const std::uint16_t a = at(x, y);
            const std::uint16_t b = at(x + 1, y);
            const std::uint16_t c = at(x, y + 1);
            const std::uint16_t d = at(x + 1, y + 1);
            if (flip)
                indices.insert(indices.end(), {a, b, c, b, d, c});
            else
                indices.insert(indices.end(), {a, b, d, a, d, c});
        }
    }
    vertices_ = gpu::Buffer(context_, gpu::Buffer::Kind::Vertices, bytesOf(vertices), "tile mesh");
    indices_ = gpu::Buffer(context_, gpu::Buffer::Kind::Indices, bytesOf(indices), "tile mesh indices");
    indexCount_ = static_cast<int>(indices.size());
    meshCells_ = cells;
}

void Scenery::makeRasters() {
    if (!raster_) {
        gpu::ShaderSource vertex;
        vertex.addFile("terrain/glsl/tile_vertex.glsl");
        gpu::ShaderSource fragment;
        fragment.addFile("terrain/glsl/tile_fragment.glsl");
        raster_.emplace(context_, "terrain tiles", vertex, fragment, tileAttributes());
    }
    if (debug_ < kBoxes || lines_) return;
    gpu::ShaderSource vertex;
    vertex.addFile("terrain/glsl/box_vertex.glsl");
    gpu::ShaderSource fragment;
    fragment.addFile("terrain/glsl/box_fragment.glsl");
    lines_.emplace(context_, "terrain boxes", vertex, fragment,
                   std::vector<gpu::Raster::Attribute>{
                       {"corner", 3, true, false, 0},
                       {"box_least", 4, false, true, offsetof(Mark, least)},
                       {"box_most", 4, false, true, offsetof(Mark, most)},
                   });
    std::vector<glm::ivec3> corners;
    std::vector<std::uint16_t> edges;
    for (int i = 0; i < 8; ++i) {
        corners.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
        for (const int axis : {1, 2, 4}) {
            if ((i & axis) == 0)
                edges.insert(edges.end(), {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(i | axis)});
        }
    }
    boxVertices_ = gpu::Buffer(context_, gpu::Buffer::Kind::Vertices, bytesOf(corners), "box corners");
    boxIndices_ = gpu::Buffer(context_, gpu::Buffer::Kind::Indices, bytesOf(edges), "box edges");
}

void Scenery::mark(const Tile& tile, const Place& place) {
    const glm::vec3 eye(selection_.camera());
    const auto level = static_cast<float>(tile.level);
    const double edge = tile.spacing * (1 << cache_->tileLevels());
    if (debug_ == kBoxes) {
        const glm::vec3 least(glm::vec2(glm::dvec2(tile.offset) * tile.spacing) - glm::vec2(eye), tile.least);
        const glm::vec3 most(least.x + edge, least.y + edge, tile.most);
        marks_.push_back({glm::vec4(least, level), glm::vec4(most, 2.0F)});
    }
    if (debug_ == kCorners) {
        const int side = (1 << cache_->tileLevels()) + 1;
        std::vector<VertexHeights> heights(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
        tileHeights(site_->shape, place.cellNamed(tile.cell), cache_->tileLevels(), 0, heights);
        for (const glm::ivec2 vertex : {glm::ivec2(0, 0), {side - 1, 0}, {0, side - 1}, {side - 1, side - 1}}) {
            const auto at = static_cast<std::size_t>(vertex.y) * static_cast<std::size_t>(side) +
                            static_cast<std::size_t>(vertex.x);
            const auto clearance = static_cast<float>(selection_.lastClearance());
            const glm::vec3 p = morphed(tile, vertex, heights[at], eye, clearance) - eye;
            const auto half = static_cast<float>(0.025 * edge);
            marks_.push_back({glm::vec4(p - half, level), glm::vec4(p + half, 3.0F)});
        }
    }
}

void Scenery::prepare(gpu::KernelCache& kernels, gpu::Stage stage, const scene::Scene& scene, glm::ivec2 size) {
    const parameter::Node& subject = scene.subject;
    const Place place = placeOf(scene);
    const Site& site = *site_;
    const scene::Camera camera(scene.camera);
    orthographic_ = scene.camera.text("projection") == "orthographic";

    if (position_.size() != size) {
        position_ = gpu::Texture(context_, gpu::PixelFormat::RGBA32F, size, "terrain seen position");
        slope_ = gpu::Texture(context_, gpu::PixelFormat::RGBA32F, size, "terrain seen slope");
        targets_ = gpu::DepthTargets(context_, {&position_, &slope_});
    }
    const int tileLevels = 5 + subject.choice("tile");
    const std::int64_t bytes = subject.integer("memory") << 20U;
    if (!cache_ || cache_->tileLevels() != tileLevels || cache_->bytes() != bytes) {
        cache_.reset(); // the old one's memory is free before the new one's is taken
        cache_.emplace(context_, tileLevels, bytes);
    }
    stride_ = 1 << subject.choice("mesh");
    debug_ = subject.choice("debug");
    makeMesh((1 << tileLevels) / stride_);
    makeRasters();
    reversed_ = subject.text("depth_test") == "reversed" ||
                (subject.text("depth_test") == "automatic" && gpu::canReverseDepth(context_));

    basis_ = glm::mat3(glm::mat3_cast(camera.orientation()));
    const double tangent = std::tan(0.5 * camera.fov());
    const double aspect = static_cast<double>(size.x) / size.y;
    film_ = glm::vec2(1.0 / (tangent * aspect), 1.0 / tangent);
    focus_ = static_cast<float>(camera.focus());
    lens_ = static_cast<float>(0.5 * scene.camera.number("aperture") * camera.focus());

    view_.camera = glm::mat3_cast(camera.orientation());
    view_.tanHalfFov = tangent * kWider;
    view_.aspect = aspect;
    view_.relief = site.relief;
    view_.tileLevels = tileLevels;
    view_.octaves = static_cast<int>(std::min<std::int64_t>(subject.integer("octaves"), Place::kLiveLevels - 8));
    // Rays from the rim of a lens see a little farther.
    view_.cullHorizon = lens_ == 0.0F;
    const double pixels = subject.number("detail");
    maker_ = subject.text("heights") == "gpu" ||
                     (subject.text("heights") == "automatic" && !context_.capabilities().software)
                 ? TileCache::Maker::Gpu
                 : TileCache::Maker::Cpu;
    Stopwatch watch;
    const bool frozen = subject.flag("frozen") && chosen_ && chosen_->shape() == site.shape &&
                        chosen_->level() == place.level() && !records_.empty() && cache_->cached() > 0;
    const std::optional<glm::dvec3> moved = frozen ? offsetBetween(*chosen_, place) : std::nullopt;
    moved_ = glm::vec3(0.0F);
    apart_ = moved.has_value();
    const bool atRest = std::exchange(atRest_, false);
    if (background_) background_->leave();
    view_.behind = nullptr;
    if (moved) {
        moved_ = glm::vec3(*moved * glm::dvec3(1.0, 1.0, site.relief));
    } else {
        const Stopwatch looking;
        if (!atRest) lookBehind(place, size, pixels, subject);
        backgroundSeconds_ = looking.seconds();
        choose(place, size, pixels, kernels, stage);
    }

    watch = Stopwatch();
    // A ray's ground need not be finer than what is seen from the camera's height.
    const double pixel = 2.0 * tangent / size.y;
    const double height = std::max(selection_.lastClearance(), 1e-5);
    clipmap_.update(place, std::max(2.5 * pixel, 1.0 / 220.0) * height, site.relief);
    clipSeconds_ = watch.seconds();
    relief_ = site.relief;
    zoom_ = zoomOf(place, selection_.lastClearance());
    // Layers are counted from the terrain's own zero, whatever the address: in parts of the ring of heights.
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const auto bits = static_cast<unsigned>(32 + kFractionBits - 10) + static_cast<unsigned>(i);
        const std::uint64_t within = place.height() & ((std::uint64_t{1} << bits) - 1U);
        layers_[i] = static_cast<float>(std::ldexp(static_cast<double>(within), -static_cast<int>(bits)));
    }
}

void Scenery::lookBehind(const Place& place, glm::ivec2 size, double pixels, const parameter::Node& subject) {
    // Lines and marks are not kept in it; and where its texels would be coarser than the picture's pixels there is
    // none.
    constexpr double kMostSide = 2048.0;
    const double side = std::ceil(size.y / (view_.tanHalfFov / kWider));
    const bool wanted = subject.flag("background") && debug_ == 0 && !orthographic_ && side <= kMostSide;
    if (!wanted) {
        background_.reset();
        return;
    }
    if (!background_) background_.emplace(context_);
    view_.ratio = splitRatio(size.y, view_.tanHalfFov / kWider, pixels, view_.tileLevels);
    background_->look(place, view_, static_cast<int>(side), reversed_, cache_->capacity());
    view_.behind = background_->cells();
}

void Scenery::choose(const Place& place, glm::ivec2 size, double pixels, gpu::KernelCache& kernels, gpu::Stage stage) {
    cache_->begin(place.shape());
    Stopwatch watch;
    select(place, size, pixels);
    selectSeconds_ = watch.seconds();

    watch = Stopwatch();
    const std::int64_t generated = cache_->generated();
    // By levels, from coarse to fine or the other way around; near ones first within a level.
    std::vector<const Tile*> order;
    for (const Tile& tile : selection_.tiles())
        order.push_back(&tile);
    std::stable_sort(order.begin(), order.end(), [this](const Tile* a, const Tile* b) {
        return reversed_ ? a->level > b->level : a->level < b->level;
    });
    // What is there stays, before anything that is not takes its room.
    std::vector<glm::ivec2> places;
    places.reserve(order.size());
    for (const Tile* tile : order)
        places.push_back(cache_->find(*tile));
    std::vector<const Tile*> rest;
    for (const Tile& tile : later_) {
        if (cache_->find(tile).x < 0) rest.push_back(&tile);
    }
    records_.clear();
    groups_.clear();
    marks_.clear();
    const auto count = static_cast<int>(order.size());
    for (int i = 0; i < count; ++i) {
        const Tile& tile = *order[static_cast<std::size_t>(i)];
        glm::ivec2 at = places[static_cast<std::size_t>(i)];
        if (at.x < 0) at = cache_->place(tile, place, maker_, kernels, stage);
        if (at.x < 0) break; // more than there is room for: only with the least ratio
        const auto index = static_cast<int>(records_.size());
        const bool starts = groups_.empty() || order[static_cast<std::size_t>(i - 1)]->level != tile.level;
        if (starts) groups_.push_back({index, 0, {}});
        Group& group = groups_.back();
        ++group.count;
        const double edge = tile.spacing * (1 << view_.tileLevels);
        group.range.include(depthRangeOf(tile, edge, selection_.camera(), selection_.lastClearance()));
        records_.push_back(instanceOf(tile, at, place.level()));
        mark(tile, place);
    }
    if (!instances_)
        instances_ = gpu::Buffer(context_, gpu::Buffer::Kind::Vertices, bytesOf(records_), "tiles");
    else
        instances_.upload(bytesOf(records_));
    if (!marks_.empty()) boxInstances_ = gpu::Buffer(context_, gpu::Buffer::Kind::Vertices, bytesOf(marks_), "boxes");
    triangles_ = static_cast<std::int64_t>(records_.size()) * indexCount_ / 3;
    std::int64_t most = kMostMade - (cache_->generated() - generated);
    for (const Tile* tile : rest) {
        if (cache_->has(*tile)) continue; // it is drawn now
        if (most-- <= 0 || cache_->place(*tile, place, maker_, kernels, stage).x < 0) break;
    }
    if (background_) {
        if (view_.behind == nullptr && missing_ == 0) background_->learn(selection_.tiles(), place.level());
        const std::int64_t before = cache_->generated();
        background_->stage(*cache_, most, maker_, kernels, stage);
        most -= cache_->generated() - before;
    }
    if (missing_ == 0) prefetch(place, most, kernels, stage);
    made_ = cache_->generated() - generated;
    prepared_ = true;
    makeSeconds_ = watch.seconds();
    chosen_ = place;
}

void Scenery::select(const Place& place, glm::ivec2 size, double pixels) {
    const std::vector<Tile>& tiles = selection_.tiles();
    view_.deepest = std::numeric_limits<std::int64_t>::max();
    for (coarser_ = 1.0;; coarser_ *= 1.2) {
        view_.ratio = splitRatio(size.y, view_.tanHalfFov / kWider, pixels * coarser_, view_.tileLevels);
        selection_.select(place, view_);
        // Room for what is drawn while tiles are missing, too.
        const auto room = static_cast<std::size_t>(cache_->capacity()) * 7 / 8;
        if (tiles.size() <= room || view_.ratio <= kLeastRatio) break;
    }
    const auto isMissing = [this](const Tile& tile) { return !cache_->has(tile); };
    const auto missing = [&] { return std::count_if(tiles.begin(), tiles.end(), isMissing); };
    missing_ = 0;
    later_.clear();
    const std::int64_t heldBefore = std::exchange(held_, 0);
    // Not where there is nothing to go on from.
    if (cache_->cached() == 0) return;
    const std::int64_t wanted = missing();
    if (wanted <= kMostMade) return;
    missing_ = wanted;
    // The coarse ones first, and of a level the near ones.
    later_ = tiles;
    std::stable_sort(later_.begin(), later_.end(), [](const Tile& a, const Tile& b) { return a.level < b.level; });
    std::int64_t deepest = 0;
    for (const Tile& tile : tiles)
        deepest = std::max(deepest, tile.cell.level);
    const std::int64_t highest = selection_.originLevel() - view_.tileLevels;
    // What was held back last time is a good guess.
    const std::int64_t most = deepest - highest;
    for (held_ = std::clamp<std::int64_t>(heldBefore - 1, 1, std::max<std::int64_t>(most, 1)); held_ <= most; ++held_) {
        view_.deepest = deepest - held_;
        selection_.select(place, view_);
        if (missing() > kMostMade) continue;
        // Those of that level may be ancestors of tiles to come: the cache has to have both.
        const auto ancestors =
            std::count_if(tiles.begin(), tiles.end(), [this](const Tile& t) { return t.cell.level >= view_.deepest; });
        if (later_.size() + static_cast<std::size_t>(ancestors) <= static_cast<std::size_t>(cache_->capacity())) return;
        break;
    }
    // No room for that: all at once.
    view_.deepest = std::numeric_limits<std::int64_t>::max();
    selection_.select(place, view_);
    held_ = missing_ = 0;
    later_.clear();
}

void Scenery::prefetch(const Place& place, std::int64_t most, gpu::KernelCache& kernels, gpu::Stage stage) {
    if (!chosen_ || most <= 0) return;
    const std::optional<glm::dvec3> moved = offsetBetween(*chosen_, place);
    const double length = moved ? glm::length(*moved) : 0.0;
    if (length <= 0.0) return;
    const glm::dvec3 way =
        *moved * glm::dvec3(1.0, 1.0, view_.relief) * (kPrefetchReach * selection_.lastClearance() / length);
    for (const Tile& tile : selection_.prefetch(place, view_, way, static_cast<std::size_t>(cache_->capacity()))) {
        if (cache_->has(tile)) continue;
        if (most-- <= 0 || cache_->place(tile, place, maker_, kernels, stage).x < 0) break;
        ++prefetched_;
    }
}

bool Scenery::due() {
    if (std::exchange(prepared_, false)) return false;
    atRest_ = busy();
    return atRest_;
}

void Scenery::drawRange(int first, int count, glm::vec3 depth, gpu::Raster::Depth kind) {
    raster_->set("tile_depth", depth);
    raster_->draw(targets_, {vertices_, sizeof(glm::ivec2), indices_, indexCount_, instances_, sizeof(TileInstance)},
                  first, count, kind);
    if (marks_.empty()) return;
    const int each = static_cast<int>(marks_.size() / records_.size());
    lines_->set("tile_depth", depth);
    lines_->draw(targets_, {boxVertices_, sizeof(glm::ivec3), boxIndices_, 24, boxInstances_, sizeof(Mark), true},
                 each * first, each * count, kind);
}

void Scenery::draw(glm::vec2 shift, glm::vec2 lens) {
    if (orthographic_) return;
    const glm::vec2 size(targets_.size());
    const Background::Eye eye{basis_, film_, 2.0F * shift / size, glm::vec3(lens_ * lens, 1.0F / focus_)};
    const bool behind = background_ && background_->cells() != nullptr;
    if (background_) background_->work(*cache_, vertices_, indices_, indexCount_, stride_);
    raster_->set("tile_heights", cache_->heights());
    raster_->set("tile_slopes", cache_->slopes());
    raster_->set("tile_stride", stride_);
    raster_->set("tile_mesh", stride_);
    raster_->set("tile_cells", 1 << cache_->tileLevels());
    raster_->set("tile_lines", debug_ == kBorders ? 1 : debug_ == kWireframe ? 2 : 0);
    raster_->set("tile_camera", glm::vec3(selection_.camera()));
    raster_->set("tile_moved", moved_);
    raster_->set("tile_clearance", static_cast<float>(selection_.lastClearance()));
    for (gpu::Raster* raster : {&*raster_, marks_.empty() ? nullptr : &*lines_}) {
        if (raster == nullptr) continue;
        raster->set("tile_basis", eye.basis);
        raster->set("tile_film", eye.film);
        raster->set("tile_shift", eye.shift);
        raster->set("tile_lens", eye.lens);
    }
    targets_.clear(glm::vec4(0.0F), reversed_);
    if (reversed_) {
        const float nearest = nearestDrawn(selection_.lastClearance());
        drawRange(0, static_cast<int>(records_.size()), glm::vec3(0.0F, nearest, 0.0F), gpu::Raster::Depth::Reversed);
        if (behind) background_->show(targets_, eye);
        return;
    }
    if (apart_) {
        // From elsewhere no order of levels is right: slices of the distance, from far to near.
        constexpr float kSlice = 64.0F;
        const float least = nearestDrawn(selection_.lastClearance());
        DepthRange all;
        for (const Group& group : groups_)
            all.include(group.range);
        float far = all.farthest + glm::length(moved_);
        while (far > least) {
            targets_.clearDepth(false);
            drawRange(0, static_cast<int>(records_.size()), DepthRange{far / kSlice, far}.projection(),
                      gpu::Raster::Depth::Common);
            far /= kSlice;
        }
        return;
    }
    // Tiles of a level and of all finer ones fill a rectangle about the camera: a ray that has left it never enters it
    // again. So each level hides all coarser ones, and each has all digits of the depth for itself.
    if (behind) background_->show(targets_, eye);
    for (const Group& group : groups_) {
        targets_.clearDepth(false);
        drawRange(group.first, group.count, group.range.projection(), gpu::Raster::Depth::Common);
    }
}

void Scenery::bind(gpu::Kernel& kernel, const scene::Scene& scene) const {
    kernel.setParameters("subject", scene.subject);
    kernel.set("terrain_seen_position", position_);
    kernel.set("terrain_seen_slope", slope_);
    kernel.set("terrain_drawn", !orthographic_);
    kernel.set("terrain_relief", static_cast<float>(relief_));
    kernel.set("terrain_layers[0]", std::span<const float>(layers_));
    clipmap_.bind(kernel);
}

render::Surroundings Scenery::lookAround(const scene::Scene& scene, const glm::dvec3& way) {
    const Place start = placeOf(scene);
    const double relief = site_->relief;
    render::Surroundings seen;
    seen.distance = selection_.clearance(start, relief, view_.octaves);
    const double length = glm::length(way);
    // Who is under ground gets out wherever they like.
    if (length == 0.0 || seen.distance <= 0.0) return seen;
    // From bound to bound: within each there is nothing.
    double gone = 0.0;
    double free = seen.distance;
    for (int i = 0; i < 300 && gone < length; ++i) {
        const double next = std::min(gone + 0.9 * free, length);
        Place place = start;
        if (!place.move(way * (next / length) / glm::dvec3(1.0, 1.0, relief))) break;
        free = selection_.clearance(place, relief, view_.octaves);
        if (free < kNearest * seen.distance) break;
        gone = next;
    }
    seen.freePart = gone / length;
    return seen;
}

std::optional<double> Scenery::rebase(scene::Scene& scene) {
    if (scene.subject.flag("frozen")) return std::nullopt; // its tiles are in the present units
    Place place = placeOf(scene);
    const std::int64_t level = place.level();
    double relief = site_->relief;
    double clearance = selection_.clearance(place, relief, view_.octaves);
    double scale = 1.0;
    while (clearance > 0.0 && clearance < 1.0 && scale < 1e6 && place.level() < Address::kMaxLevels) {
        place.descend();
        clearance *= 2.0;
        scale *= 2.0;
    }
    while (clearance > 4.0 && scale > 1e-6 && place.level() > view_.octaves) {
        place.ascend();
        clearance *= 0.5;
        scale *= 0.5;
    }
    // Self-affine ground is rougher the nearer one comes: heights follow the depth.
    const Shape& shape = place.shape();
    const bool follows = shape.hurst < 1000 && clearance > 0.0;
    if (follows) {
        const double zoom = zoomOf(place, clearance);
        relief *= verticalScale(shape, place.level(), zoom) / verticalScale(shape, level, zoom_);
        zoom_ = zoom;
    }
    if (scale == 1.0 && !follows) return std::nullopt;
    put(scene, place, relief, scale);
    return scale;
}

render::Flown Scenery::autopilot(scene::Scene& scene, render::Autopilot way, double speed, double seconds) {
    const scene::Camera camera(scene.camera);
    if (!flight_ || flownCamera_ != scene.camera || flownSubject_ != scene.subject) {
        Place place = placeOf(scene);
        flight_.emplace(std::move(place), camera.orientation(), site_->relief);
    }
    const Place before = flight_->place();
    const double clearance = flight_->clearance();
    const double most = -std::log1p(-kMostFlown);
    const auto steps = static_cast<std::int64_t>(std::ceil(std::clamp(speed * seconds / most, 1.0, 1e6)));
    for (std::int64_t i = 0; i < steps; ++i) {
        const double part = seconds / static_cast<double>(steps);
        if (way == render::Autopilot::Dive) {
            if (flight_->place().level() >= Address::kMaxLevels) break;
            flight_->dive(speed, part);
        } else {
            if (flight_->place().level() <= view_.octaves) break;
            flight_->rise(speed, part);
        }
    }
    const Place& place = flight_->place();
    render::Flown flown;
    const double relief = std::clamp(flight_->relief(), kLeastRelief, kMostRelief);
    if (const auto offset = offsetBetween(before, place)) flown.back = -*offset * glm::dvec3(1.0, 1.0, relief);
    const auto levels = static_cast<int>(std::clamp<std::int64_t>(place.level() - before.level(), -1000, 1000));
    flown.scale = std::ldexp(1.0, levels);
    // What the camera looks at lies as far ahead as the ground is away: moves by hand go on from there.
    scene.camera.set("mode", std::string("free"));
    const glm::dquat& view = flight_->orientation();
    scene.camera.set("orientation", glm::dvec4(view.x, view.y, view.z, view.w));
    const glm::dvec3 ahead = view * glm::dvec3(0, 0, -2.0 * std::max(clearance, 1e-3));
    put(scene, place, relief, flown.scale);
    const glm::dvec3 target = place.position() * glm::dvec3(1.0, 1.0, relief) + ahead;
    scene.camera.set("target", Decimal3{Decimal(target.x), Decimal(target.y), Decimal(target.z)});
    flownCamera_ = scene.camera;
    flownSubject_ = scene.subject;
    return flown;
}

std::vector<std::pair<std::string, double>> Scenery::counters() const {
    return {{"tiles drawn", static_cast<double>(records_.size())},
            {"tiles missing", static_cast<double>(missing_)},
            {"tiles made", static_cast<double>(made_)},
            {"tiles prefetched", static_cast<double>(prefetched_)},
            {"tiles generated", cache_ ? static_cast<double>(cache_->generated()) : 0.0},
            {"tiles cached", cache_ ? static_cast<double>(cache_->cached()) : 0.0},
            {"tiles' room", cache_ ? static_cast<double>(cache_->capacity()) : 0.0},
            {"tiles in the background", background_ ? static_cast<double>(background_->tiles()) : 0.0},
            {"background progress", background_ ? background_->progress() : 1.0},
            {"background tiles drawn", background_ ? static_cast<double>(background_->drawn()) : 0.0},
            {"triangles", static_cast<double>(triangles_)},
            {"selection [ms]", 1e3 * selectSeconds_},
            {"tile making [ms]", 1e3 * makeSeconds_},
            {"background [ms]", 1e3 * backgroundSeconds_},
            {"clipmap [ms]", 1e3 * clipSeconds_}};
}

std::vector<std::string> Scenery::notes() const {
    std::vector<std::string> notes;
    if (coarser_ > 1.0) {
        notes.push_back(fmt::format("subject.memory holds {} tiles: vertices are {:.1f} times as far apart as "
                                    "subject.detail says",
                                    cache_ ? cache_->capacity() : 0, coarser_));
    }
    if (lifted_)
        notes.emplace_back("the camera is under the ground and is shown right above it: raise camera.position");
    return notes;
}

} // namespace apeiron::terrain
