#include "volume/volume_subject.hpp"

#include "core/error.hpp"
#include "gpu/texture3d.hpp"
#include "render/view.hpp"
#include "volume/defaults.hpp"
#include "volume/generators.hpp"
#include "volume/grid.hpp"
#include "volume/histogram.hpp"
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
constexpr const char* kSurfaceFile = "volume/volume_surface.glsl";
constexpr const char* kSampledFile = "volume/values_sampled.glsl";
constexpr const char* kCornersFile = "volume/values_corners.glsl";

/// Copies for faster interpolation do not take more than this [bytes]: a volume of 320³ bytes has one.
constexpr std::size_t kMostForCorners = std::size_t{288} << 20;

/// What decides which voxels are shown, and how they are kept.
struct Choice {
    std::string source;
    std::string raw;
    GeneratorOptions generator;
    int time = 0;
    int brick = 8;

    bool operator==(const Choice& other) const {
        const GeneratorOptions& a = generator;
        const GeneratorOptions& b = other.generator;
        return source == other.source && raw == other.raw && a.size == b.size && a.orbital.n == b.orbital.n &&
               a.orbital.l == b.orbital.l && a.orbital.m == b.orbital.m && a.phases == b.phases && a.seed == b.seed &&
               time == other.time && brick == other.brick;
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
    return choice;
}

bool isGenerator(const std::string& name) {
    const std::vector<Generator>& all = generators();
    return std::any_of(all.begin(), all.end(), [&](const Generator& generator) { return generator.name == name; });
}

std::shared_ptr<const Volume> load(const Choice& choice) {
    if (choice.raw.empty() && isGenerator(choice.source))
        return std::make_shared<const Volume>(generate(choice.source, choice.generator));
    // A word that looks like a name was meant as one: let the list of generators answer.
    if (choice.raw.empty() && choice.source.find_first_of("./\\") == std::string::npos) {
        try {
            return loadVolume({choice.source, {}, {}, 0});
        } catch (const Error&) {
            return std::make_shared<const Volume>(generate(choice.source, choice.generator));
        }
    }
    return loadVolume({choice.source, choice.raw, {}, 0});
}

/// A grid on the GPU and where it is in the world.
struct Grid {
    Choice choice;
    std::shared_ptr<const Volume> volume;
    std::vector<DataRange> data; ///< of each channel
    Modality modality = Modality::Unknown;
    Json automatic; ///< the transfer function that "auto" stands for
    GridTexture texture;
    std::optional<gpu::Texture3D> corners; ///< on devices that are software
    BrickRanges ranges;
    glm::dmat3 toGrid{1.0}; ///< world -> grid, whose voxel (0, 0, 0) is the box from 0 to 1
    glm::dvec3 origin{0.0}; ///< grid coordinates of the world's origin
    double longest = 1.0;   ///< side of the box [world units]
    double spacing = 1.0;   ///< of neighbouring voxels, at least [world units]
    bool turned = false;    ///< upright: half a turn about the world's y
};

glm::dmat4 indexToScene(const Grid& grid) {
    const glm::dmat4& toWorld = grid.volume->indexToWorld;
    return grid.turned ? glm::dmat4(glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1)) * toWorld : toWorld;
}

void place(Grid& grid) {
    const glm::dmat4 toWorld = indexToScene(grid);
    const glm::dmat3 axes(toWorld);
    if (!(std::abs(glm::determinant(axes)) > 0.0))
        throw Error(ErrorKind::BadInput, "the voxels have no size: the axes of the grid lie in a plane",
                    grid.volume->name);
    grid.toGrid = glm::inverse(axes);
    grid.origin = grid.toGrid * -glm::dvec3(toWorld[3]) + 0.5;
    const glm::dvec3 size(grid.volume->size);
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
    glm::ivec3 low = bricks.size;
    glm::ivec3 high(-1);
    std::size_t i = 0;
    for (int z = 0; z < bricks.size.z; ++z)
        for (int y = 0; y < bricks.size.y; ++y)
            for (int x = 0; x < bricks.size.x; ++x, ++i)
                if (opacities[i] > seen) {
                    low = glm::min(low, glm::ivec3(x, y, z));
                    high = glm::max(high, glm::ivec3(x, y, z));
                }
    if (high.x < 0) {
        low = glm::ivec3(0);
        high = bricks.size - 1;
    }
    const glm::dmat3 axes = glm::inverse(grid.toGrid);
    const glm::dvec3 first(low * bricks.side);
    const glm::dvec3 last(glm::min((high + 1) * bricks.side, grid.volume->size));
    glm::dvec3 extent(0.0);
    std::array<glm::dvec3, 8> corners{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
        corners[corner] = axes * ((side - 0.5) * (last - first));
        extent = glm::max(extent, 2.0 * glm::abs(corners[corner]));
    }
    render::Bounds bounds;
    bounds.center = axes * (0.5 * (first + last) - grid.origin);
    bounds.front = frontDirection(grid.modality, extent);
    for (const glm::dvec3& corner : corners) {
        // What is nearer to the camera looks larger: by as much as at the default angle of view.
        constexpr double kPerspective = 0.4;
        const double near = glm::dot(corner, bounds.front);
        const double aside = glm::length(corner - near * bounds.front);
        bounds.radius = std::max(bounds.radius, aside + kPerspective * std::max(near, 0.0));
    }
    return bounds;
}

std::shared_ptr<Grid> makeGrid(const gpu::Context& context, const Choice& choice) {
    auto grid = std::make_shared<Grid>();
    grid->choice = choice;
    grid->volume = load(choice);
    const Volume& volume = *grid->volume;
    if (choice.time >= volume.timePoints) {
        throw Error(ErrorKind::BadInput,
                    fmt::format("{} has {} point{} of time, counted from 0", volume.name, volume.timePoints,
                                volume.timePoints == 1 ? "" : "s"),
                    "subject.time");
    }
    grid->data = dataRanges(volume, choice.time);
    grid->turned = !isGenerator(choice.source) && isUpsideDown(volume, grid->data, choice.time);
    grid->modality = guessModality(volume, statistics(volume));
    grid->automatic = automaticTransfer(volume, grid->data);
    place(*grid);
    grid->ranges = brickRanges(volume, choice.time, choice.brick);
    grid->texture = uploadGrid(context, volume, choice.time, grid->ranges);
    if (context.capabilities().software)
        grid->corners = uploadCorners(context, volume, choice.time, grid->ranges, kMostForCorners);
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
    gpu::Texture3D bricks;
    render::Bounds bounds; ///< of what is seen
};

gpu::Texture3D brickTexture(const gpu::Context& context, const BrickRanges& ranges, const std::vector<float>& values) {
    gpu::Texture3D texture(context, gpu::GridFormat::R32F, ranges.size, "bricks");
    texture.upload(std::as_bytes(std::span(values)), 0, ranges.size.z);
    return texture;
}

Transfer makeTransfer(const gpu::Context& context, const Grid& grid, const Json& json) {
    const std::vector<TransferFunction> functions = transferFunctions(json, grid.automatic);
    const std::vector<TransferTable> tables = transferTables(functions, grid.data);
    Transfer transfer;
    transfer.json = json;
    transfer.rows = tables.front().height;
    transfer.lookup = lookupOf(*grid.volume, tables);
    const auto width = static_cast<std::size_t>(tables.front().width);
    const glm::ivec2 size(tables.front().width, tables.front().height * static_cast<int>(tables.size()));
    std::vector<float> rgba;
    std::vector<float> glow;
    std::vector<float> opacities; // for each value, the most of all gradients
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
    const std::vector<float> most = majorants(grid.ranges, opacities, width, transfer.lookup);
    transfer.bricks = brickTexture(context, grid.ranges, most);
    transfer.bounds = boundsOf(grid, most);
    return transfer;
}

/// Where the isosurface is.
struct Iso {
    double place = 0.5; ///< in the transfer function
    gpu::Texture3D bricks;
};

double isoPlace(const scene::Scene& scene, const Grid& grid, const Transfer& transfer) {
    double value = scene.subject.number("isovalue");
    if (scene.subject.choice("iso_units") == 0) value = glm::mix(grid.data.front().low, grid.data.front().high, value);
    const glm::dvec2 lookup = transfer.lookup.front();
    const double slope = grid.volume->slope != 0.0 ? grid.volume->slope : 1.0;
    return lookup.x * (value - grid.volume->intercept) / slope + lookup.y;
}

class VolumeSubject : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"field", "medium", "surface"}; }

    void prepare(const gpu::Context& context, const scene::Scene& scene) override {
        const Choice choice = choiceOf(scene);
        const Json& json = scene.subject.get<parameter::Structure>("transfer").json;
        // Everything that can fail first.
        std::shared_ptr<Grid> grid = grid_ && grid_->choice == choice ? grid_ : makeGrid(context, choice);
        std::optional<Transfer> transfer;
        if (grid != grid_ || transfer_.json != json) transfer = makeTransfer(context, *grid, json);
        const double place = isoPlace(scene, *grid, transfer ? *transfer : transfer_);
        if (transfer || place != iso_.place) {
            const auto& lookup = transfer ? transfer->lookup : transfer_.lookup;
            iso_ = {place, brickTexture(context, grid->ranges, crossings(grid->ranges, place, lookup))};
        }
        floatFiltering_ = context.capabilities().floatFiltering;
        grid_ = std::move(grid);
        if (transfer) transfer_ = std::move(*transfer);
        grid_->texture.texture.setLinear(scene.subject.choice("interpolation") == 0 && filterable());
    }

    std::optional<render::Bounds> bounds() const override { return transfer_.bounds; }

    Shown shown(const scene::Scene& scene) const {
        Shown shown{
            grid_->volume,       grid_->choice.time,
            grid_->data,         {},
            grid_->modality,     scene.subject.choice("interpolation") == 0 ? Between::Linear : Between::Nearest,
            indexToScene(*grid_)};
        const std::vector<TransferFunction> functions = transferFunctions(transfer_.json, grid_->automatic);
        for (std::size_t i = 0; i < shown.ranges.size(); ++i)
            shown.transfer.push_back(inValueUnits(functions[std::min(i, functions.size() - 1)], shown.ranges[i]));
        return shown;
    }

    std::vector<std::string> notes(const scene::Scene& /*scene*/) const override {
        std::vector<std::string> notes = grid_->volume->messages;
        if (grid_->turned)
            notes.emplace_back(
                "the file does not say how it lies, and it seems to stand on its head: it is turned by 180 "
                "degrees about y");
        return notes;
    }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        const bool manual = scene.subject.choice("interpolation") == 0 && !filterable();
        source.addText("the volume's kind",
                       fmt::format("const int volume_channels = {};\nconst bool volume_manual = {};\n"
                                   "const float volume_brick = {}.0;\n",
                                   grid_->volume->channels, manual, grid_->choice.brick));
        for (const auto& file : scene.subject.files()) {
            source.addModule(*file, "subject_", scene.subject, "subject", options.specialise,
                             gpu::ShaderSource::Rename::Parameters);
        }
        if (cornersUsed(scene)) {
            const bool halves = grid_->corners->format() == gpu::GridFormat::RGBA32UI;
            source.addText("the volume's words", fmt::format("const bool volume_halves = {};\n", halves));
        }
        source.addFile(cornersUsed(scene) ? kCornersFile : kSampledFile);
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const Grid& grid = *grid_;
        kernel.setParameters("subject", scene.subject);
        if (cornersUsed(scene)) {
            kernel.set("volume_corners", *grid.corners);
        } else {
            kernel.set("volume_data", grid.texture.texture);
        }
        kernel.set("volume_bricks", transfer_.bricks);
        kernel.set("volume_transfer", transfer_.table);
        kernel.set("volume_rows", transfer_.rows);
        kernel.set("volume_glows", transfer_.glows);
        kernel.set("volume_glow", transfer_.glow);
        kernel.set("volume_iso", static_cast<float>(iso_.place));
        kernel.set("volume_iso_bricks", iso_.bricks);
        kernel.set("volume_to_grid", glm::mat3(grid.toGrid));
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        kernel.set("clip_camera", glm::vec3(render::difference(position, {})));
        const glm::dvec3 camera = grid.origin + grid.toGrid * render::difference(position, {});
        kernel.set("volume_camera", glm::vec3(camera));
        kernel.set("volume_size", glm::vec3(grid.volume->size));
        glm::vec4 scale(1.0F);
        glm::vec4 offset(0.0F);
        glm::vec4 gradient(0.0F);
        for (int i = 0; i < grid.volume->channels; ++i) {
            const glm::dvec2 lookup = transfer_.lookup[static_cast<std::size_t>(i)];
            scale[i] = static_cast<float>(lookup.x * grid.texture.scale);
            offset[i] = static_cast<float>(lookup.x * grid.texture.offset + lookup.y);
            gradient[i] = static_cast<float>(transfer_.gradient[static_cast<std::size_t>(i)]);
        }
        kernel.set("volume_scale", scale);
        kernel.set("volume_offset", offset);
        kernel.set("volume_gradient", gradient);
        kernel.set("volume_unit", static_cast<float>(1.0 / grid.longest));
        kernel.set("volume_spacing", static_cast<float>(grid.spacing));
    }

  private:
    bool cornersUsed(const scene::Scene& scene) const {
        return grid_->corners.has_value() && scene.subject.choice("interpolation") == 0;
    }
    bool filterable() const {
        const gpu::GridFormat format = grid_->texture.texture.format();
        return floatFiltering_ || gpu::bytesPerTexel(format) < 4 * gpu::channelsOf(format);
    }

    std::shared_ptr<Grid> grid_;
    Transfer transfer_;
    Iso iso_;
    bool floatFiltering_ = true;
};

/// Builds a host parameter piece by piece.
class Declare {
  public:
    Declare(const char* name, parameter::Type type, parameter::Value byDefault, const char* doc) {
        parameter_.name = name;
        parameter_.type = type;
        parameter_.defaultValue = std::move(byDefault);
        parameter_.invalidates = parameter::Invalidates::Program;
        parameter_.doc = doc;
        parameter_.where = "src/volume/volume_subject.cpp";
    }
    Declare& range(double minimum, double maximum) {
        parameter_.minimum = minimum;
        parameter_.maximum = maximum;
        return *this;
    }
    Declare& choices(std::vector<std::string> labels) { return parameter_.choices = std::move(labels), *this; }
    Declare& logarithmic() { return parameter_.logarithmic = true, *this; }
    Declare& path() { return parameter_.path = true, *this; }
    Declare& samples() { return parameter_.invalidates = parameter::Invalidates::Samples, *this; }
    operator parameter::Parameter() const { return parameter_; } // NOLINT: converting is what it is for

  private:
    parameter::Parameter parameter_;
};

std::vector<parameter::Parameter> hostParameters() {
    using parameter::Type;
    const auto count = [](std::int64_t value) { return parameter::Value(value); };
    const auto word = [](const char* text) { return parameter::Value(std::string(text)); };
    return {
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
        Declare("isovalue", Type::Float, 0.5, "Where the surface is, for renderers of surfaces")
            .range(-1e6, 1e6)
            .samples(),
        Declare("iso_units", Type::Choice, word("window"),
                "What isovalue counts: 0 to 1 over the window of the data, or values as they were measured")
            .choices({"window", "value"})
            .samples(),
    };
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
             {kClipFile, kFile, kSurfaceFile}},
            {},
            [] { return std::unique_ptr<render::Subject>(new VolumeSubject); }};
}

} // namespace apeiron::volume
