#include "volume/volume_subject.hpp"

#include "core/error.hpp"
#include "gpu/texture3d.hpp"
#include "render/view.hpp"
#include "scene/camera.hpp"
#include "volume/brick_stream.hpp"
#include "volume/declare.hpp"
#include "volume/defaults.hpp"
#include "volume/generators.hpp"
#include "volume/grid.hpp"
#include "volume/histogram.hpp"
#include "volume/slices.hpp"
#include "volume/source.hpp"
#include "volume/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace apeiron::volume {
namespace {

constexpr const char* kFile = "volume/volume.glsl";
constexpr const char* kClipFile = "volume/volume_clip.glsl";
constexpr const char* kSlicesFile = "volume/volume_slices.glsl";
constexpr const char* kSurfaceFile = "volume/volume_surface.glsl";
constexpr const char* kSampledFile = "volume/values_sampled.glsl";
constexpr const char* kCornersFile = "volume/values_corners.glsl";
constexpr const char* kBrickedFile = "volume/values_bricked.glsl";

/// Copies for faster interpolation do not take more than this [bytes]: a volume of 320³ bytes has one.
constexpr std::size_t kMostForCorners = std::size_t{288} << 20;

/// What bricks of volumes that are larger than the device's textures take, where nobody says [bytes].
#ifdef __EMSCRIPTEN__
constexpr std::size_t kMemoryForBricks = std::size_t{256} << 20;
#else
constexpr std::size_t kMemoryForBricks = std::size_t{1} << 30;
#endif

/// What decides which voxels are shown, and how they are kept.
struct Choice {
    std::string source;
    std::string raw;
    GeneratorOptions generator;
    int time = 0;
    int brick = 8;
    std::size_t memory = 0; ///< for the voxels [bytes]; 0: as much as they need

    bool operator==(const Choice& other) const {
        const GeneratorOptions& a = generator;
        const GeneratorOptions& b = other.generator;
        return source == other.source && raw == other.raw && a.size == b.size && a.orbital.n == b.orbital.n &&
               a.orbital.l == b.orbital.l && a.orbital.m == b.orbital.m && a.phases == b.phases && a.seed == b.seed &&
               time == other.time && brick == other.brick && memory == other.memory;
    }
};

Choice choiceOf(const scene::Scene& scene) {
    const parameter::Node& subject = scene.subject;
    const auto integer = [&](const char* name) { return static_cast<int>(subject.integer(name)); };
    Choice choice;
    choice.source = subject.text("source");
    choice.raw = subject.text("raw");
    choice.generator.size = integer("resolution");
    choice.generator.orbital = {integer("orbital_n"), integer("orbital_l"), integer("orbital_m")};
    choice.generator.phases = subject.flag("orbital_phases");
    choice.generator.seed = static_cast<std::uint32_t>(subject.integer("seed"));
    choice.time = integer("time");
    choice.brick = 4 << subject.choice("brick");
    choice.memory = static_cast<std::size_t>(std::ldexp(subject.number("memory"), 20));
    return choice;
}

bool isGenerator(const std::string& name) {
    const std::vector<Generator>& all = generators();
    return std::any_of(all.begin(), all.end(), [&](const Generator& generator) { return generator.name == name; });
}

/// The voxels of a volume, in memory or where they can be read in parts.
struct Data {
    std::shared_ptr<const Volume> volume; ///< or ...
    std::optional<LargeVolume> large;     ///< ... one that is larger than the memory
};

Data load(const Choice& choice) {
    const auto generated = [&] {
        return Data{std::make_shared<const Volume>(generate(choice.source, choice.generator)), {}};
    };
    if (choice.raw.empty() && isGenerator(choice.source)) return generated();
    // A word that looks like a name was meant as one: let the list of generators answer.
    if (choice.raw.empty() && choice.source.find_first_of("./\\") == std::string::npos) {
        try {
            return {loadVolume({choice.source, {}, {}, 0}), {}};
        } catch (const Error&) {
            return generated();
        }
    }
    if (auto large = openVolume({choice.source, choice.raw, {}, choice.memory})) return {nullptr, std::move(large)};
    return {loadVolume({choice.source, choice.raw, {}, 0}), {}};
}

/// A grid on the GPU and where it is in the world.
struct Grid {
    Choice choice;
    std::shared_ptr<const Volume> volume; ///< of a large one a coarser level
    glm::ivec3 size{0};                   ///< voxels
    glm::dmat4 indexToWorld{1.0};
    std::vector<DataRange> data; ///< of each channel
    Modality modality = Modality::Unknown;
    Json automatic; ///< the transfer function that "auto" stands for
    TexelForm form;
    gpu::Texture3D texture;                ///< all of it, or ...
    std::unique_ptr<BrickStream> stream;   ///< ... of a large volume what there is room for
    std::optional<gpu::Texture3D> corners; ///< on devices that are software
    BrickRanges ranges;
    glm::dmat3 toGrid{1.0}; ///< world -> grid, whose voxel (0, 0, 0) is the box from 0 to 1
    glm::dvec3 origin{0.0}; ///< grid coordinates of the world's origin
    double longest = 1.0;   ///< side of the box [world units]
    double spacing = 1.0;   ///< of neighbouring voxels, at least [world units]
    bool turned = false;    ///< upright: half a turn about the world's y
};

/// @param toWorld of the grid, or of another one at the same place
glm::dmat4 indexToScene(const Grid& grid, const glm::dmat4& toWorld) {
    return grid.turned ? glm::dmat4(glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1)) * toWorld : toWorld;
}

void place(Grid& grid) {
    const glm::dmat4 toWorld = indexToScene(grid, grid.indexToWorld);
    const glm::dmat3 axes(toWorld);
    if (!(std::abs(glm::determinant(axes)) > 0.0))
        throw Error(ErrorKind::BadInput, "the voxels have no size: the axes of the grid lie in a plane",
                    grid.volume->name);
    grid.toGrid = glm::inverse(axes);
    grid.origin = grid.toGrid * -glm::dvec3(toWorld[3]) + 0.5;
    const glm::dvec3 size(grid.size);
    grid.longest = 0.0;
    grid.spacing = std::numeric_limits<double>::max();
    for (int i = 0; i < 3; ++i) {
        grid.longest = std::max(grid.longest, size[i] * glm::length(axes[i]));
        grid.spacing = std::min(grid.spacing, glm::length(axes[i]));
    }
}

/// What a first picture shows: the bricks of which something is seen.
render::Bounds boundsOf(const Grid& grid, const std::vector<float>& opacities) {
    const BrickRanges& bricks = grid.ranges;
    const float most = *std::max_element(opacities.begin(), opacities.end());
    const float seen = 0.02F * most;
    // From the first to the last of each row: in between there is nothing that would be farther out.
    struct Row {
        glm::ivec3 first;
        glm::ivec3 last;
    };
    std::vector<Row> rows;
    std::size_t i = 0;
    for (int z = 0; z < bricks.size.z; ++z)
        for (int y = 0; y < bricks.size.y; ++y) {
            bool begun = false;
            for (int x = 0; x < bricks.size.x; ++x, ++i) {
                if (!(opacities[i] > seen)) continue;
                if (!begun) rows.push_back({{x, y, z}, {}});
                rows.back().last = {x, y, z};
                begun = true;
            }
        }
    if (rows.empty()) rows.push_back({glm::ivec3(0), bricks.size - 1});
    glm::ivec3 low = rows.front().first;
    glm::ivec3 high = low;
    for (const Row& row : rows) {
        low = glm::min(low, row.first);
        high = glm::max(high, row.last);
    }
    const auto begin = [&](const glm::ivec3& brick) { return glm::dvec3(brick * bricks.side); };
    const auto end = [&](const glm::ivec3& brick) {
        return glm::dvec3(glm::min((brick + 1) * bricks.side, grid.size));
    };
    const auto cornerOf = [](std::size_t corner, const glm::dvec3& first, const glm::dvec3& last) {
        return glm::mix(first, last, glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2));
    };
    const glm::dmat3 axes = glm::inverse(grid.toGrid);
    const glm::dvec3 middle = 0.5 * (begin(low) + end(high));
    render::Bounds bounds;
    glm::dvec3 extent(0.0);
    for (std::size_t corner = 0; corner < 8; ++corner)
        extent = glm::max(extent, 2.0 * glm::abs(axes * (cornerOf(corner, begin(low), end(high)) - middle)));
    for (const Row& row : rows)
        for (std::size_t corner = 0; corner < 8; ++corner)
            bounds.corners.push_back(axes * (cornerOf(corner, begin(row.first), end(row.last)) - middle));
    bounds.center = axes * (middle - grid.origin);
    bounds.front = frontDirection(grid.modality, extent);
    bounds.radius = glm::length(0.5 * extent);
    return bounds;
}

/// Bytes of a volume in the form that the GPU has it in, and whether its textures are large enough.
bool fitsWhole(const gpu::Context& context, const Volume& volume, const TexelForm& form, std::size_t memory) {
    const glm::ivec3 size = volume.size;
    if (std::max({size.x, size.y, size.z}) > context.capabilities().maxTextureSize3D) return false;
    return memory == 0 ||
           voxelsPerChannel(volume) * static_cast<std::size_t>(gpu::bytesPerTexel(form.format)) <= memory;
}

void requireTime(const Volume& volume, int time) {
    if (time < volume.timePoints) return;
    throw Error(ErrorKind::BadInput,
                fmt::format("{} has {} point{} of time, counted from 0", volume.name, volume.timePoints,
                            volume.timePoints == 1 ? "" : "s"),
                "subject.time");
}

/// Puts the voxels on the GPU, all of them where there is room.
void putVoxels(const gpu::Context& context, Grid& grid, Data data) {
    const Choice& choice = grid.choice;
    const std::size_t memory = choice.memory;
    if (!data.large) {
        requireTime(*data.volume, choice.time);
        grid.ranges = brickRanges(*data.volume, choice.time, choice.brick);
        grid.form = texelForm(data.volume->type, grid.ranges);
        if (fitsWhole(context, *data.volume, grid.form, memory)) {
            grid.volume = std::move(data.volume);
            grid.size = grid.volume->size;
            grid.indexToWorld = grid.volume->indexToWorld;
            grid.texture = uploadGrid(context, *grid.volume, choice.time, grid.form);
            if (!context.capabilities().software) return;
            const std::size_t most = memory == 0 ? kMostForCorners : std::min(memory, kMostForCorners);
            grid.corners = uploadCorners(context, *grid.volume, choice.time, grid.ranges, most);
            return;
        }
        data.large = inParts(std::move(data.volume));
    }
    requireTime(data.large->form, choice.time);
    grid.stream = std::make_unique<BrickStream>(context, std::move(*data.large), choice.time,
                                                memory == 0 ? kMemoryForBricks : memory, choice.brick);
    grid.volume = grid.stream->overview();
    grid.size = grid.stream->volume().form.size;
    grid.indexToWorld = grid.stream->volume().form.indexToWorld;
    grid.ranges = grid.stream->ranges();
    grid.form = grid.stream->form();
}

/// Means have lost the smallest and the largest values; ranges have them.
void takeExtremes(Grid& grid) {
    const BrickRanges& all = grid.ranges;
    const std::size_t bricks = all.ranges.size() / static_cast<std::size_t>(all.channels);
    for (std::size_t channel = 0; channel < grid.data.size(); ++channel) {
        glm::vec2 range = all.ranges[channel * bricks];
        for (std::size_t i = 0; i < bricks; ++i) {
            const glm::vec2 one = all.ranges[channel * bricks + i];
            range = {std::min(range.x, one.x), std::max(range.y, one.y)};
        }
        const double a = grid.volume->slope * static_cast<double>(range.x) + grid.volume->intercept;
        const double b = grid.volume->slope * static_cast<double>(range.y) + grid.volume->intercept;
        grid.data[channel].minimum = std::min(a, b);
        grid.data[channel].maximum = a != b ? std::max(a, b) : a + 1.0;
    }
}

std::shared_ptr<Grid> makeGrid(const gpu::Context& context, const Choice& choice) {
    auto grid = std::make_shared<Grid>();
    grid->choice = choice;
    putVoxels(context, *grid, load(choice));
    const Volume& volume = *grid->volume;
    // Of a large volume only the point of time that is shown was read.
    const int time = grid->stream ? 0 : choice.time;
    grid->data = dataRanges(volume, time);
    if (grid->stream) takeExtremes(*grid);
    grid->turned = !isGenerator(choice.source) && isUpsideDown(volume, grid->data, time);
    grid->modality = guessModality(volume, statistics(volume));
    grid->automatic = automaticTransfer(volume, grid->data);
    place(*grid);
    return grid;
}

/// Place in a table = x * stored value + y, for each channel.
std::vector<glm::dvec2> lookupOf(const Volume& volume, const std::vector<TransferTable>& tables) {
    std::vector<glm::dvec2> lookup;
    for (const TransferTable& table : tables) {
        // Where all values are the same, all have the table's first entry.
        const double scale = table.high > table.low ? 1.0 / (table.high - table.low) : 0.0;
        lookup.emplace_back(volume.slope * scale, (volume.intercept - table.low) * scale);
    }
    return lookup;
}

/// The transfer functions of all channels on the GPU, and what follows from them.
struct Transfer {
    Json json; ///< what it was made of
    std::vector<glm::dvec2> lookup;
    std::vector<double> gradient; ///< place in the table for a gradient of one place per world unit, of each channel
    int rows = 1;                 ///< of each channel
    gpu::Texture table;
    gpu::Texture glow;
    bool glows = false;
    std::vector<float> opacities; ///< for each value, the most of all gradients: one table for each channel ...
    std::size_t width = 0;        ///< ... of so many entries
    std::vector<float> seen;      ///< majorants() of all voxels
    gpu::Texture3D bricks;        ///< of what is shown
    gpu::Texture3D ranges;        ///< likewise: lowest and highest place in the transfer function
    render::Bounds bounds;        ///< of what is seen
};

gpu::Texture3D brickTexture(const gpu::Context& context, const BrickRanges& ranges, const std::vector<float>& values) {
    gpu::Texture3D texture(context, gpu::GridFormat::R32F, ranges.size, "bricks");
    texture.upload(std::as_bytes(std::span(values)), 0, ranges.size.z);
    return texture;
}

/// What the lowest and highest values of bricks are in the transfer function; of channels, those of the one that is
/// shown by renderers of values: the largest.
gpu::Texture3D rangeTexture(const gpu::Context& context, const BrickRanges& ranges,
                            std::span<const glm::dvec2> lookup) {
    const std::size_t bricks = voxelsIn(ranges.size);
    std::vector<glm::vec2> places(bricks, glm::vec2(0.0F));
    for (std::size_t channel = 0; channel < lookup.size(); ++channel) {
        for (std::size_t i = 0; i < bricks; ++i) {
            const glm::dvec2 range(ranges.ranges[channel * bricks + i]);
            const glm::dvec2 ends = lookup[channel].x * range + lookup[channel].y;
            // With some room for single precision.
            const glm::dvec2 place(std::min(ends.x, ends.y) - 1e-5, std::max(ends.x, ends.y) + 1e-5);
            places[i] = glm::max(places[i], glm::vec2(glm::clamp(place, 0.0, 1.0)));
        }
    }
    gpu::Texture3D texture(context, gpu::GridFormat::RG32F, ranges.size, "ranges of bricks");
    texture.upload(std::as_bytes(std::span(places)), 0, ranges.size.z);
    return texture;
}

Transfer makeTransfer(const gpu::Context& context, const Grid& grid, const Json& json) {
    const std::vector<TransferFunction> functions = transferFunctions(json, grid.automatic);
    const std::vector<TransferTable> tables = transferTables(functions, grid.data);
    Transfer transfer;
    transfer.json = json;
    transfer.rows = tables.front().height;
    transfer.lookup = lookupOf(*grid.volume, tables);
    const auto width = transfer.width = static_cast<std::size_t>(tables.front().width);
    const glm::ivec2 size(tables.front().width, tables.front().height * static_cast<int>(tables.size()));
    std::vector<float> rgba;
    std::vector<float> glow;
    std::vector<float>& opacities = transfer.opacities;
    for (const TransferTable& table : tables) {
        transfer.gradient.push_back((table.high - table.low) / std::max(table.gradientHigh, 1e-30));
        rgba.insert(rgba.end(), table.rgba.begin(), table.rgba.end());
        transfer.glows = transfer.glows || !table.emission.empty();
        std::vector<float> most(width, 0.0F);
        for (std::size_t i = 0; i < table.rgba.size() / 4; ++i) {
            most[i % width] = std::max(most[i % width], table.rgba[4 * i + 3]);
            for (std::size_t k = 0; k < 4; ++k)
                glow.push_back(table.emission.empty() || k == 3 ? 0.0F : table.emission[3 * i + k]);
        }
        opacities.insert(opacities.end(), most.begin(), most.end());
    }
    transfer.table = gpu::Texture(context, gpu::PixelFormat::RGBA32F, size, "transfer function");
    transfer.table.upload(rgba);
    transfer.glow = gpu::Texture(context, gpu::PixelFormat::RGBA32F, transfer.glows ? size : glm::ivec2(1), "glow");
    if (transfer.glows) transfer.glow.upload(glow);
    transfer.seen = majorants(grid.ranges, opacities, width, transfer.lookup);
    transfer.bricks = brickTexture(context, grid.ranges, transfer.seen);
    transfer.ranges = rangeTexture(context, grid.ranges, transfer.lookup);
    transfer.bounds = boundsOf(grid, transfer.seen);
    return transfer;
}

/// Where the isosurface is.
struct Iso {
    double place = 0.5;      ///< in the transfer function
    std::vector<float> seen; ///< crossings() of all voxels
    gpu::Texture3D bricks;   ///< of what is shown
};

/// The place of a value of the first channel in the transfer function, 0 to 1.
double placeOf(double value, const Grid& grid, const Transfer& transfer) {
    const glm::dvec2 lookup = transfer.lookup.front();
    const double slope = grid.volume->slope != 0.0 ? grid.volume->slope : 1.0;
    return lookup.x * (value - grid.volume->intercept) / slope + lookup.y;
}

double isoPlace(const scene::Scene& scene, const Grid& grid, const Transfer& transfer) {
    double value = scene.subject.number("isovalue");
    if (scene.subject.choice("iso_units") == 0) value = glm::mix(grid.data.front().low, grid.data.front().high, value);
    return placeOf(value, grid, transfer);
}

Iso makeIso(const gpu::Context& context, const Grid& grid, double place, const Transfer& transfer) {
    Iso iso{place, crossings(grid.ranges, place, transfer.lookup), {}};
    iso.bricks = brickTexture(context, grid.ranges, iso.seen);
    return iso;
}

/// From where a scene's camera sees a grid.
BrickView viewOf(const scene::Scene& scene, const Grid& grid) {
    const scene::Camera camera(scene.camera);
    const glm::dmat3 axes = glm::inverse(grid.toGrid);
    const glm::dmat3 turn = glm::transpose(glm::mat3_cast(camera.orientation()));
    BrickView view;
    view.toCamera = glm::dmat4(turn * axes);
    view.toCamera[3] = glm::dvec4(turn * (-(axes * grid.origin) - render::difference(camera.position(), {})), 1.0);
    view.voxel = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
    view.extent = camera.extent();
    view.height = static_cast<int>(scene.output.integer("height"));
    view.aspect = static_cast<double>(scene.output.integer("width")) / view.height;
    view.orthographic = scene.camera.text("projection") == "orthographic";
    return view;
}

class VolumeSubject : public render::Subject {
  public:
    void setPatient(bool patient) override { patient_ = patient; }

    std::set<std::string> provides() const override { return {"field", "medium", "surface"}; }

    void prepare(const gpu::Context& context, const scene::Scene& scene) override {
        const Choice choice = choiceOf(scene);
        const Json& json = scene.subject.get<parameter::Structure>("transfer").json;
        // Everything that can fail first.
        std::shared_ptr<Grid> grid = grid_ && grid_->choice == choice ? grid_ : makeGrid(context, choice);
        std::optional<Transfer> transfer;
        if (grid != grid_ || transfer_.json != json) transfer = makeTransfer(context, *grid, json);
        const double place = isoPlace(scene, *grid, transfer ? *transfer : transfer_);
        std::optional<Iso> iso;
        if (transfer || place != iso_.place) iso = makeIso(context, *grid, place, transfer ? *transfer : transfer_);
        context_ = &context;
        grid_ = std::move(grid);
        if (transfer) transfer_ = std::move(*transfer);
        if (iso) iso_ = std::move(*iso);
        floatFiltering_ = context.capabilities().floatFiltering;
        const bool linear = scene.subject.choice("interpolation") == 0 && filterable();
        (grid_->stream ? grid_->stream->atlas() : grid_->texture).setLinear(linear);
        if (grid_->stream && (transfer || iso)) {
            // Others may be wanted now; until then there is what there is.
            view_.reset();
            bricksFromShown();
        }
    }

    bool update(const scene::Scene& scene, double budget) override {
        if (!grid_->stream) return false;
        BrickStream& stream = *grid_->stream;
        bool changed = false;
        if (const BrickView view = viewOf(scene, *grid_); view_ != view) {
            std::vector<float> seen = transfer_.seen;
            for (std::size_t i = 0; i < seen.size(); ++i)
                seen[i] = std::max(seen[i], iso_.seen[i]);
            changed = stream.want(view, neededBricks(BrickPyramid(grid_->size), grid_->ranges, seen));
            view_ = view;
        }
        if (stream.busy()) {
            const double forEver = std::numeric_limits<double>::infinity();
            changed = stream.load(patient_ ? forEver : budget) || changed;
        }
        if (changed) bricksFromShown();
        return changed;
    }
    bool busy() const override { return grid_->stream && (!view_ || grid_->stream->busy()); }
    std::vector<std::pair<std::string, double>> counters() const override {
        return grid_->stream ? grid_->stream->counters() : std::vector<std::pair<std::string, double>>{};
    }

    std::optional<render::Bounds> bounds() const override { return transfer_.bounds; }

    Shown shown(const scene::Scene& scene) const {
        Shown shown{grid_->volume,
                    grid_->stream ? 0 : grid_->choice.time,
                    grid_->data,
                    {},
                    grid_->modality,
                    scene.subject.choice("interpolation") == 0 ? Between::Linear : Between::Nearest,
                    indexToScene(*grid_, grid_->volume->indexToWorld),
                    shownSlices(scene.subject, planes(scene))};
        const std::vector<TransferFunction> functions = transferFunctions(transfer_.json, grid_->automatic);
        for (std::size_t i = 0; i < shown.ranges.size(); ++i)
            shown.transfer.push_back(inValueUnits(functions[std::min(i, functions.size() - 1)], shown.ranges[i]));
        return shown;
    }

    std::vector<std::string> notes(const scene::Scene& scene) const override {
        std::vector<std::string> notes = grid_->volume->messages;
        const auto& tags = scene.renderer.module("type").tags;
        const auto needs = tags.find("needs");
        if (needs != tags.end() && needs->second == "surface" && !shownSlices(scene.subject, planes(scene)).empty())
            notes.emplace_back(
                "renderers of surfaces do not show slices: choose eam, lao, iso, mip, depth, mcs or mcm");
        if (grid_->turned)
            notes.emplace_back(
                "the file does not say how it lies, and it seems to stand on its head: it is turned by 180 "
                "degrees about y");
        if (grid_->stream) {
            const glm::ivec3 size = grid_->size;
            notes.push_back(fmt::format("{}x{}x{} voxels are more than the memory for them holds: what is seen best is "
                                        "shown finest",
                                        size.x, size.y, size.z));
        }
        return notes;
    }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        const bool manual = scene.subject.choice("interpolation") == 0 && !filterable();
        source.addText("the volume's kind",
                       fmt::format("const int volume_channels = {};\nconst bool volume_manual = {};\n"
                                   "const bool volume_steep = {};\nconst bool volume_glows = {};\n"
                                   "const float volume_brick = {}.0;\n",
                                   grid_->volume->channels, manual, transfer_.rows > 1, transfer_.glows,
                                   grid_->ranges.side));
        for (const auto& file : scene.subject.files()) {
            source.addModule(*file, "subject_", scene.subject, "subject", options.specialise,
                             gpu::ShaderSource::Rename::Parameters);
        }
        if (cornersUsed(scene)) {
            const bool halves = grid_->corners->format() == gpu::GridFormat::RGBA32UI;
            source.addText("the volume's words", fmt::format("const bool volume_halves = {};\n", halves));
        }
        source.addFile(grid_->stream ? kBrickedFile : cornersUsed(scene) ? kCornersFile : kSampledFile);
    }

    std::string variant() const override {
        return fmt::format("{}{}{}{}{}", grid_->volume->channels, transfer_.rows > 1, transfer_.glows,
                           grid_->ranges.side,
                           grid_->stream    ? 2
                           : grid_->corners ? 1
                                            : 0);
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const Grid& grid = *grid_;
        kernel.setParameters("subject", scene.subject);
        if (grid.stream) {
            kernel.set("volume_atlas", grid.stream->atlas());
            kernel.set("volume_pages", grid.stream->pages());
        } else if (cornersUsed(scene)) {
            kernel.set("volume_corners", *grid.corners);
            kernel.set("volume_corners_step", 1.0F / glm::vec3(grid.corners->size()));
        } else {
            kernel.set("volume_data", grid.texture);
        }
        kernel.set("volume_bricks", transfer_.bricks);
        kernel.set("volume_ranges", transfer_.ranges);
        kernel.set("volume_transfer", transfer_.table);
        kernel.set("volume_transfer_size", glm::vec2(transfer_.table.size()));
        kernel.set("volume_brick_count", glm::vec3(transfer_.bricks.size()));
        kernel.set("volume_rows", transfer_.rows);
        kernel.set("volume_glow", transfer_.glow);
        kernel.set("volume_iso", static_cast<float>(iso_.place));
        kernel.set("volume_iso_bricks", iso_.bricks);
        kernel.set("volume_to_grid", glm::mat3(grid.toGrid));
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        kernel.set("clip_camera", glm::vec3(render::difference(position, {})));
        const glm::dvec3 camera = grid.origin + grid.toGrid * render::difference(position, {});
        kernel.set("volume_camera", glm::vec3(camera));
        kernel.set("volume_size", glm::vec3(grid.size));
        glm::vec4 scale(1.0F);
        glm::vec4 offset(0.0F);
        glm::vec4 gradient(0.0F);
        for (int i = 0; i < grid.volume->channels; ++i) {
            const glm::dvec2 lookup = transfer_.lookup[static_cast<std::size_t>(i)];
            scale[i] = static_cast<float>(lookup.x * grid.form.scale);
            offset[i] = static_cast<float>(lookup.x * grid.form.offset + lookup.y);
            gradient[i] = static_cast<float>(transfer_.gradient[static_cast<std::size_t>(i)]);
        }
        kernel.set("volume_scale", scale);
        kernel.set("volume_offset", offset);
        kernel.set("volume_gradient", gradient);
        bindSlices(kernel, scene);
        kernel.set("volume_unit", static_cast<float>(1.0 / grid.longest));
        kernel.set("volume_spacing", static_cast<float>(grid.spacing));
    }

  private:
    std::array<SlicePlane, 4> planes(const scene::Scene& scene) const {
        // Grid coordinates count from the corner of the first voxel, indices from its centre.
        static const glm::dmat4 kCorner(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5, -0.5, -0.5, 1);
        const glm::dmat4 toWorld = indexToScene(*grid_, grid_->indexToWorld) * kCorner;
        return slicePlanes(scene.subject, toWorld, glm::dvec3(grid_->size));
    }

    void bindSlices(gpu::Kernel& kernel, const scene::Scene& scene) const {
        const glm::dvec3 camera = render::difference(scene.camera.get<parameter::Decimal3>("position"), {});
        std::array<glm::vec4, 4> slices{};
        std::size_t i = 0;
        for (const SlicePlane& plane : planes(scene))
            slices[i++] = glm::vec4(glm::dvec4(plane.normal, plane.offset - glm::dot(plane.normal, camera)));
        kernel.set("slice_planes", std::span<const glm::vec4>(slices));
        // From places in the transfer function to grey.
        const glm::dvec2 window = scene.subject.get<glm::dvec2>("slice_window");
        const DataRange& range = grid_->data.front();
        const double low = window.y > 0.0 ? window.x - 0.5 * window.y : range.low;
        const double high = window.y > 0.0 ? window.x + 0.5 * window.y : range.high;
        const auto place = [&](double value) { return placeOf(value, *grid_, transfer_); };
        const double width = place(high) - place(low);
        const double scale = width != 0.0 ? 1.0 / width : 0.0;
        kernel.set("slice_grey", glm::vec2(glm::dvec2(scale, -scale * place(low))));
    }

    bool cornersUsed(const scene::Scene& scene) const {
        return grid_->corners.has_value() && scene.subject.choice("interpolation") == 0;
    }
    bool filterable() const {
        const gpu::GridFormat format = grid_->form.format;
        return floatFiltering_ || gpu::bytesPerTexel(format) < 4 * gpu::channelsOf(format);
    }

    /// Of a large volume: majorants for what is shown of it.
    void bricksFromShown() {
        const auto& lookup = transfer_.lookup;
        const BrickRanges visible = grid_->stream->shownRanges(transfer_.seen);
        transfer_.bricks =
            brickTexture(*context_, visible, majorants(visible, transfer_.opacities, transfer_.width, lookup));
        const std::vector<float> all(transfer_.seen.size(), 1.0F);
        transfer_.ranges = rangeTexture(*context_, grid_->stream->shownRanges(all), lookup);
        const BrickRanges crossed = grid_->stream->shownRanges(iso_.seen);
        iso_.bricks = brickTexture(*context_, crossed, crossings(crossed, iso_.place, lookup));
    }

    bool patient_ = false;
    const gpu::Context* context_ = nullptr;
    std::shared_ptr<Grid> grid_;
    std::optional<BrickView> view_; ///< for which bricks of a large volume are wanted
    Transfer transfer_;
    Iso iso_;
    bool floatFiltering_ = true;
};

std::vector<parameter::Parameter> hostParameters() {
    using parameter::Type;
    const auto count = [](std::int64_t value) { return parameter::Value(value); };
    const auto word = [](const char* text) { return parameter::Value(std::string(text)); };
    std::vector<parameter::Parameter> parameters{
        Declare("source", Type::Text, word("cloud"),
                "The data: a generated volume (cloud, hydrogen, fractal, shepp_logan, marschner_lobb), or a file")
            .path(),
        Declare("raw", Type::Text, word(""), "The file is bare voxels of that form, such as 128x128x128:uint8"),
        Declare("resolution", Type::Int, count(128), "Voxels along the longest side of a generated volume")
            .range(kMinGeneratedSize, kMaxGeneratedSize)
            .logarithmic(),
        Declare("orbital_n", Type::Int, count(4), "Principal quantum number of the hydrogen orbital").range(1, 10),
        Declare("orbital_l", Type::Int, count(2), "Its azimuthal quantum number, below orbital_n").range(0, 9),
        Declare("orbital_m", Type::Int, count(0), "Its magnetic quantum number, -orbital_l to orbital_l").range(-9, 9),
        Declare("orbital_phases", Type::Bool, false,
                "Two channels instead of one: where its wave is positive, and where it is negative"),
        Declare("seed", Type::Int, count(1), "Start of the generated cloud's random numbers").range(0, 4294967295.0),
        Declare("time", Type::Int, count(0), "Which point of time is shown, of a series, from 0").range(0, 1e6),
        transferParameter(),
        Declare("interpolation", Type::Choice, word("linear"), "Values between voxels").choices({"linear", "nearest"}),
        Declare("brick", Type::Choice, word("8"),
                "Side of the bricks [voxels] of which the largest opacity is known: empty ones are stepped over")
            .choices({"4", "8", "16", "32"}),
        Declare("memory", Type::Float, 0.0,
                "Most memory for the voxels: larger volumes are shown coarser where they are less seen; 0: all that is "
                "needed, and of what textures do not hold, or the machine, a part")
            .range(0, 1e6)
            .unit("MiB"),
        Declare("isovalue", Type::Float, 0.5, "Where the surface is, for renderers of surfaces")
            .range(-1e6, 1e6)
            .samples(),
        Declare("iso_units", Type::Choice, word("window"),
                "What isovalue counts: 0 to 1 over the window of the data, or values as they were measured")
            .choices({"window", "value"})
            .samples(),
    };
    const std::vector<parameter::Parameter> slices = sliceParameters();
    parameters.insert(parameters.end(), slices.begin(), slices.end());
    return parameters;
}

} // namespace

std::optional<Shown> shown(const render::Subject& subject, const scene::Scene& scene) {
    const auto* volume = dynamic_cast<const VolumeSubject*>(&subject);
    if (volume == nullptr) return std::nullopt;
    return volume->shown(scene);
}

Json toJson(const Shown& shown) {
    const Volume& volume = *shown.volume;
    Json channels = Json::array();
    for (std::size_t i = 0; i < shown.ranges.size(); ++i) {
        const DataRange& range = shown.ranges[i];
        const auto [from, to] = histogramAxis(range);
        channels.push_back({{"name", i < volume.channelNames.size() ? volume.channelNames[i] : ""},
                            {"minimum", range.minimum},
                            {"maximum", range.maximum},
                            {"low", range.low},
                            {"high", range.high},
                            {"gradient_high", range.gradientHigh},
                            {"axis", {from, to}},
                            {"transfer", toJson(shown.transfer[i])}});
    }
    return {{"time", shown.time},
            {"unit", volume.unit},
            {"modality", toString(shown.modality)},
            {"channels", std::move(channels)}};
}

render::SubjectType subjectType() {
    return {{"subject",
             "volume",
             "A measured or generated volume: a grid of values, seen by a transfer function",
             hostParameters(),
             {kClipFile, kFile, kSlicesFile, kSurfaceFile}},
            {},
            [] { return std::unique_ptr<render::Subject>(new VolumeSubject); }};
}

} // namespace apeiron::volume
