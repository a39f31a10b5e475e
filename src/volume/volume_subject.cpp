#include "volume/volume_subject.hpp"

#include "gpu/texture3d.hpp"
#include "render/view.hpp"
#include "volume/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace apeiron::volume {
namespace {

constexpr const char* kFile = "volume/volume.glsl";

/// What decides which voxels are shown.
struct Choice {
    std::string source;
    std::int64_t resolution = 0;
    std::int64_t time = 0;
    int brick = 8;
    bool operator==(const Choice&) const = default;
};

Choice choiceOf(const scene::Scene& scene) {
    const parameter::Node& subject = scene.subject;
    return {subject.text("source"), subject.integer("resolution"), subject.integer("time"),
            4 << subject.choice("brick")};
}

Volume ball(int size) {
    Volume volume;
    volume.size = glm::ivec3(size);
    volume.name = "ball";
    volume.voxels.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) *
                         static_cast<std::size_t>(size));
    std::size_t i = 0;
    for (int z = 0; z < size; ++z) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const glm::dvec3 p = (glm::dvec3(x, y, z) + 0.5) * (2.0 / size) - 1.0;
                const double value = std::clamp(3.0 * (0.95 - glm::length(p)), 0.0, 1.0);
                volume.voxels[i++] = static_cast<std::byte>(std::lround(255 * value));
            }
        }
    }
    volume.indexToWorld = glm::dmat4(glm::dmat3(2.0 / size));
    volume.indexToWorld[3] = glm::dvec4(glm::dvec3(1.0 / size - 1.0), 1.0);
    return volume;
}

/// A grid on the GPU and where it is in the world.
struct Grid {
    Choice choice;
    Volume volume; ///< without its voxels
    GridTexture data;
    BrickRanges ranges;
    glm::dmat3 toGrid{1.0}; ///< world -> grid, whose voxel (0, 0, 0) is the box from 0 to 1
    glm::dvec3 origin{0.0}; ///< grid coordinates of the world's origin
    double longest = 1.0;   ///< side of the box [world units]
    double spacing = 1.0;   ///< of neighbouring voxels, at least [world units]
    render::Bounds bounds;
    glm::dvec2 range{0.0, 1.0}; ///< of stored values
};

std::shared_ptr<Grid> makeGrid(const gpu::Context& context, const Choice& choice, Volume volume) {
    auto grid = std::make_shared<Grid>();
    grid->choice = choice;
    grid->ranges = brickRanges(volume, static_cast<int>(choice.time), choice.brick);
    grid->data = uploadGrid(context, volume, static_cast<int>(choice.time), grid->ranges);
    volume.voxels = {};
    const glm::dmat4 toWorld = volume.indexToWorld;
    const glm::dmat3 axes(toWorld);
    grid->toGrid = glm::inverse(axes);
    grid->origin = grid->toGrid * -glm::dvec3(toWorld[3]) + 0.5;
    const glm::dvec3 size(volume.size);
    grid->longest = 0.0;
    grid->spacing = std::numeric_limits<double>::max();
    for (int i = 0; i < 3; ++i) {
        grid->longest = std::max(grid->longest, size[i] * glm::length(axes[i]));
        grid->spacing = std::min(grid->spacing, glm::length(axes[i]));
    }
    grid->bounds.center = glm::dvec3(toWorld * glm::dvec4(0.5 * size - 0.5, 1.0));
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
        const glm::dvec3 place = axes * ((side - 0.5) * size);
        grid->bounds.radius = std::max(grid->bounds.radius, glm::length(place));
    }
    grid->range = {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    for (const glm::vec2 range : grid->ranges.ranges)
        grid->range = {std::min(grid->range.x, static_cast<double>(range.x)),
                       std::max(grid->range.y, static_cast<double>(range.y))};
    grid->volume = std::move(volume);
    return grid;
}

/// A transfer function ready for the GPU.
struct Transfer {
    int width = 0;
    int height = 1; ///< rows for each channel
    std::vector<float> rgba;
    std::vector<glm::dvec2> domain; ///< of stored values, for each channel
};

Transfer defaultTransfer(const Grid& grid) {
    Transfer transfer;
    transfer.width = 1024;
    for (int channel = 0; channel < grid.volume.channels; ++channel) {
        transfer.domain.push_back(grid.range);
        for (int i = 0; i < transfer.width; ++i) {
            const double x = (i + 0.5) / transfer.width;
            const double opacity = glm::smoothstep(0.1, 0.9, x);
            transfer.rgba.insert(transfer.rgba.end(),
                                 {static_cast<float>(0.9), static_cast<float>(0.55 + 0.3 * x),
                                  static_cast<float>(0.35 + 0.5 * x), static_cast<float>(opacity)});
        }
    }
    return transfer;
}

class VolumeSubject : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"field", "medium"}; }

    void prepare(const gpu::Context& context, const scene::Scene& scene) override {
        const Choice choice = choiceOf(scene);
        std::shared_ptr<Grid> grid = grid_;
        if (!grid || grid->choice != choice)
            grid = makeGrid(context, choice, ball(static_cast<int>(choice.resolution)));
        grid->data.texture.setLinear(linear(context, scene, *grid));
        Transfer transfer = defaultTransfer(*grid);
        if (grid == grid_ && transfer_.rgba == transfer.rgba && transfer_.domain == transfer.domain) return;
        upload(context, *grid, transfer);
        grid_ = std::move(grid);
        transfer_ = std::move(transfer);
        floatFiltering_ = context.capabilities().floatFiltering;
    }

    std::optional<render::Bounds> bounds() const override { return grid_->bounds; }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        const bool manual = scene.subject.choice("interpolation") == 0 && !filterable();
        source.addText("the volume's kind",
                       fmt::format("const int volume_channels = {};\nconst bool volume_manual = {};\n"
                                   "const bool volume_shaped = {};\nconst float volume_brick = {}.0;\n",
                                   grid_->volume.channels, manual, transfer_.height > 1, grid_->choice.brick));
        source.addModule(scene.subject.file(kFile), "subject_", scene.subject, "subject", options.specialise,
                         gpu::ShaderSource::Rename::Parameters);
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const Grid& grid = *grid_;
        kernel.setParameters("subject", scene.subject);
        kernel.set("volume_data", grid.data.texture);
        kernel.set("volume_bricks", bricks_);
        kernel.set("volume_transfer", table_);
        kernel.set("volume_to_grid", glm::mat3(grid.toGrid));
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        const glm::dvec3 camera = grid.origin + grid.toGrid * render::difference(position, {});
        kernel.set("volume_camera", glm::vec3(camera));
        kernel.set("volume_size", glm::vec3(grid.volume.size));
        glm::vec4 scale(1.0F);
        glm::vec4 offset(0.0F);
        for (int i = 0; i < grid.volume.channels; ++i) {
            const glm::dvec2 domain = transfer_.domain[static_cast<std::size_t>(i)];
            const double width = std::max(domain.y - domain.x, 1e-30);
            scale[i] = static_cast<float>(grid.data.scale / width);
            offset[i] = static_cast<float>((grid.data.offset - domain.x) / width);
        }
        kernel.set("volume_scale", scale);
        kernel.set("volume_offset", offset);
        kernel.set("volume_gradient", static_cast<float>(grid.spacing));
        kernel.set("volume_unit", static_cast<float>(1.0 / grid.longest));
        kernel.set("volume_spacing", static_cast<float>(grid.spacing));
    }

  private:
    bool filterable() const {
        return floatFiltering_ ||
               gpu::bytesPerTexel(grid_->data.texture.format()) < 4 * gpu::channelsOf(grid_->data.texture.format());
    }

    static bool linear(const gpu::Context& context, const scene::Scene& scene, const Grid& grid) {
        return scene.subject.choice("interpolation") == 0 && gpu::filterable(context, grid.data.texture.format());
    }

    void upload(const gpu::Context& context, const Grid& grid, const Transfer& transfer) {
        const auto width = static_cast<std::size_t>(transfer.width);
        const auto rows = static_cast<std::size_t>(transfer.height);
        const auto channels = static_cast<std::size_t>(grid.volume.channels);
        // For each value, the most opaque of all gradients.
        std::vector<float> opacities(width * channels, 0.0F);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            for (std::size_t i = 0; i < width * rows; ++i) {
                float& most = opacities[channel * width + i % width];
                most = std::max(most, transfer.rgba[4 * (channel * width * rows + i) + 3]);
            }
        }
        std::vector<glm::dvec2> lookup;
        for (const glm::dvec2 domain : transfer.domain) {
            const double scale = 1.0 / std::max(domain.y - domain.x, 1e-30);
            lookup.emplace_back(scale, -domain.x * scale);
        }
        const std::vector<float> bricks = majorants(grid.ranges, opacities, width, lookup);
        gpu::Texture3D brickTexture(context, gpu::GridFormat::R32F, grid.ranges.size, "majorants");
        brickTexture.upload(std::as_bytes(std::span(bricks)), 0, grid.ranges.size.z);
        gpu::Texture table(context, gpu::PixelFormat::RGBA32F, {transfer.width, transfer.height * grid.volume.channels},
                           "transfer function");
        table.upload(transfer.rgba);
        bricks_ = std::move(brickTexture);
        table_ = std::move(table);
    }

    std::shared_ptr<Grid> grid_;
    Transfer transfer_;
    bool floatFiltering_ = true;
    gpu::Texture3D bricks_;
    gpu::Texture table_;
};

parameter::Parameter parameterOf(const char* name, parameter::Type type, parameter::Value byDefault, const char* doc) {
    parameter::Parameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.defaultValue = std::move(byDefault);
    parameter.invalidates = parameter::Invalidates::Program;
    parameter.doc = doc;
    parameter.where = "src/volume/volume_subject.cpp";
    return parameter;
}

std::vector<parameter::Parameter> hostParameters() {
    using parameter::Type;
    parameter::Parameter source =
        parameterOf("source", Type::Text, std::string("ball"), "The data: the name of a generated volume, or a file");
    parameter::Parameter resolution =
        parameterOf("resolution", Type::Int, std::int64_t{128}, "Voxels along each side of a generated volume");
    resolution.minimum = 8;
    resolution.maximum = 1024;
    resolution.logarithmic = true;
    parameter::Parameter time =
        parameterOf("time", Type::Int, std::int64_t{0}, "Which point of time is shown, of a series");
    time.minimum = 0;
    time.maximum = 1e6;
    parameter::Parameter interpolation =
        parameterOf("interpolation", Type::Choice, std::string("linear"), "Values between voxels");
    interpolation.choices = {"linear", "nearest"};
    parameter::Parameter brick =
        parameterOf("brick", Type::Choice, std::string("8"),
                    "Side of the bricks [voxels] of which the largest opacity is known: empty ones are stepped over");
    brick.choices = {"4", "8", "16", "32"};
    return {source, resolution, time, interpolation, brick};
}

} // namespace

render::SubjectType subjectType() {
    return {{"subject",
             "volume",
             "A measured or generated volume: a grid of values, seen by a transfer function",
             hostParameters(),
             {kFile}},
            {},
            [] { return std::unique_ptr<render::Subject>(new VolumeSubject); }};
}

} // namespace apeiron::volume
