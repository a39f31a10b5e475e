#include "terrain/terrain.hpp"

#include "core/error.hpp"
#include "terrain/scenery.hpp"

namespace apeiron::terrain {
namespace {

using parameter::Invalidates;
using parameter::Parameter;
using parameter::Type;
using parameter::Value;

constexpr const char* kSurfaceFile = "terrain/terrain.glsl";

class Terrain : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"surface"}; }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        Clipmap::addConstants(source);
        source.addModule(scene.subject.file(kSurfaceFile), "subject_", scene.subject, "subject", options.specialise,
                         gpu::ShaderSource::Rename::Parameters);
        const parameter::GlslModule& ground = scene.subject.module("ground");
        if (!gpu::globalNames(ground.source).contains("material")) {
            throw Error(ErrorKind::BadInput, "a ground must declare 'vec4 material(Ground ground)'", ground.file + ":1",
                        "see src/terrain/grounds/alpine.glsl");
        }
        source.addModule(ground, "ground_", scene.subject, "subject", options.specialise);
    }

    bool draws() const override { return true; }

    void prepare(const gpu::Context& context, gpu::KernelCache& kernels, gpu::Stage stage, const scene::Scene& scene,
                 glm::ivec2 size) const override {
        if (!scenery_) scenery_ = std::make_unique<Scenery>(context);
        scenery_->prepare(kernels, stage, scene, size);
    }

    void draw(glm::vec2 shift, glm::vec2 lens) const override { scenery_->draw(shift, lens); }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        if (scenery_) scenery_->bind(kernel, scene);
    }

    std::optional<render::Surroundings> lookAround(const scene::Scene& scene, glm::vec3 way) const override {
        if (!scenery_) return std::nullopt;
        return scenery_->lookAround(scene, glm::dvec3(way));
    }

    std::optional<double> rebase(scene::Scene& scene) const override {
        return scenery_ ? scenery_->rebase(scene) : std::nullopt;
    }

    std::optional<render::Flown> autopilot(scene::Scene& scene, render::Autopilot way, double speed,
                                           double seconds) const override {
        if (!scenery_) return std::nullopt;
        return scenery_->autopilot(scene, way, speed, seconds);
    }

    std::optional<double> scalePower() const override {
        return scenery_ ? std::optional(scenery_->scale()) : std::nullopt;
    }

    bool update(const scene::Scene& /*scene*/, double /*budget*/) override { return scenery_ && scenery_->due(); }
    bool busy() const override { return scenery_ && scenery_->busy(); }

    std::vector<std::pair<std::string, double>> counters() const override {
        return scenery_ ? scenery_->counters() : std::vector<std::pair<std::string, double>>{};
    }
    std::vector<std::string> notes(const scene::Scene& /*scene*/) const override {
        return scenery_ ? scenery_->notes() : std::vector<std::string>{};
    }

  private:
    mutable std::unique_ptr<Scenery> scenery_; ///< made with the first context
};

Parameter declare(const char* name, Type type, Value byDefault, const char* doc) {
    Parameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.defaultValue = std::move(byDefault);
    parameter.doc = doc;
    parameter.where = "src/terrain/terrain.cpp";
    return parameter;
}

Parameter ranged(Parameter parameter, double minimum, double maximum, bool logarithmic = false) {
    parameter.minimum = minimum;
    parameter.maximum = maximum;
    parameter.logarithmic = logarithmic;
    return parameter;
}

Parameter choice(const char* name, const char* byDefault, std::vector<std::string> labels, const char* doc) {
    Parameter parameter = declare(name, Type::Choice, std::string(byDefault), doc);
    parameter.choices = std::move(labels);
    return parameter;
}

std::vector<Parameter> parameters() {
    Parameter ground = declare("ground", Type::Module, parameter::ModuleReference{"alpine", {}},
                               "What the ground is made of: a name, or the path of a GLSL file of your own");
    ground.folder = "grounds";
    ground.invalidates = Invalidates::Program;
    Parameter detail =
        ranged(declare("detail", Type::Float, 1.5, "Most distance between two heights in the picture"), 0.5, 16, true);
    detail.unit = "px";
    Parameter memory =
        ranged(declare("memory", Type::Int, std::int64_t{192}, "Most GPU memory for tiles' heights and slopes"), 4,
               4096, true);
    memory.unit = "MiB";
    return {
        declare("address", Type::Text, std::string(),
                "Path from the root cell to the cell that is the world's unit: a digit 0 to 3 a level"),
        ranged(declare("depth", Type::Int, std::int64_t{40},
                       "The address is continued to so many levels, over ground that is flat at large"),
               0, static_cast<double>(Address::kMaxLevels), true),
        ranged(declare("seed", Type::Int, std::int64_t{1}, "Chooses the terrain"), 0, 4294967295.0),
        choice("kernel", "bspline", {"bspline", "bilinear"},
               "How each octave continues the one before: smooth, or linear with creases"),
        ranged(declare("hurst", Type::Float, 1.0,
                       "Hurst exponent: 1 halves each octave's height; less is rougher (self-affine)"),
               0.4, 1),
        ranged(declare("relief", Type::Float, 0.6, "Factor on all heights"), 0.05, 4, true),
        std::move(ground),
        choice("tile", "64", {"32", "64", "128"}, "Cells along a tile's side"),
        std::move(detail),
        choice("mesh", "4", {"1", "2", "4"}, "Heights per vertex of the mesh; those between shade only"),
        ranged(declare("octaves", Type::Int, std::int64_t{14}, "Levels that are drawn upwards of the address's"), 4,
               16),
        std::move(memory),
        declare("background", Type::Bool, false,
                "A moving camera sees far ground as it was a little way off, where that is right to half a pixel"),
        declare("frozen", Type::Bool, false, "The tiles stay those that were chosen, wherever the camera goes"),
        choice("heights", "automatic", {"automatic", "cpu", "gpu"}, "Where heights of tiles are computed"),
        choice("depth_test", "automatic", {"automatic", "reversed", "blocks"},
               "How near hides far: a reversed float depth, or level by level where clip control is missing"),
    };
}

} // namespace

render::SubjectType subjectType() {
    return {{"subject",
             "terrain",
             "Fractal mountains that can be zoomed into and out of without limit",
             parameters(),
             {kSurfaceFile}},
            {},
            [] { return std::unique_ptr<render::Subject>(new Terrain); }};
}

} // namespace apeiron::terrain
