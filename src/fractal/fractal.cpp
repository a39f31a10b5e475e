#include "fractal/fractal.hpp"

#include "core/error.hpp"
#include "render/view.hpp"

#include <fmt/format.h>

#include <array>

namespace apeiron::fractal {
namespace {

/// What a formula file must declare, and how (see orbit.glsl).
struct Requirement {
    const char* name;
    const char* declaration;
};
constexpr std::array kRequired{
    Requirement{"iterate", "void iterate(inout Orbit orbit)"},
    Requirement{"estimate", "float estimate(Orbit orbit)"},
    Requirement{"iterations", "uniform int iterations; //! 10 [1, 60] | Most iterations"},
    Requirement{"bailout", "uniform float bailout; //! 4 [1, 100] | Escape radius"},
};

class Fractal : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"surface"}; }

    void addSource(gpu::ShaderSource& source, const parameter::Node& node,
                   const render::BuildOptions& options) const override {
        const parameter::GlslModule& formula = node.module("formula");
        const std::set<std::string> names = gpu::globalNames(formula.source);
        for (const Requirement& required : kRequired) {
            if (names.contains(required.name)) continue;
            throw Error(ErrorKind::BadInput, fmt::format("a formula must declare '{}'", required.declaration),
                        formula.file + ":1", "see src/fractal/orbit.glsl");
        }
        source.addFile("fractal/orbit.glsl");
        source.addModule(formula, "formula_", node, "subject", options.specialise);
        if (!names.contains("start")) {
            source.addText("formula without start()", "void formula_start(inout Orbit orbit) {}\n");
        }
        if (!names.contains("bound")) {
            source.addText("formula without bound()", "float formula_bound() { return 1000.0; }\n");
        }
        if (!names.contains("step_factor")) {
            source.addText("formula without step_factor", "const float formula_step_factor = 1.0;\n");
        }
        const parameter::GlslModule& palette = node.module("palette");
        if (!gpu::globalNames(palette.source).contains("color")) {
            throw Error(ErrorKind::BadInput, "a palette must declare 'vec3 color(float t)'", palette.file + ":1",
                        "see src/fractal/gradient.glsl");
        }
        source.addModule(palette, "palette_", node, "subject", options.specialise);
        for (const auto& file : node.files()) {
            source.addModule(*file, "subject_", node, "subject", options.specialise,
                             gpu::ShaderSource::Rename::Parameters);
        }
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        kernel.setParameters("subject", scene.subject);
        kernel.set("subject_origin", glm::vec3(render::difference(position, {})));
    }
};

} // namespace

render::SubjectType subjectType() {
    parameter::Parameter formula;
    formula.name = "formula";
    formula.type = parameter::Type::Module;
    formula.folder = "formulas";
    formula.defaultValue = parameter::ModuleReference{"mandelbulb", {}};
    formula.invalidates = parameter::Invalidates::Program;
    formula.doc = "The map that is iterated: a name, or the path of a GLSL file of your own";
    formula.where = "src/fractal/fractal.cpp";
    parameter::Parameter palette = formula;
    palette.name = "palette";
    palette.folder = "palettes";
    palette.defaultValue = parameter::ModuleReference{"sunset", {}};
    palette.doc =
        "The colours along a measure, where coloring is palette: a name, or the path of a GLSL file of your own";
    return {{"subject",
             "fractal",
             "A three-dimensional fractal given by a distance estimate",
             {formula, palette},
             {"render/glsl/distance_surface.glsl", "fractal/fractal.glsl", "fractal/material.glsl"}},
            [] { return std::unique_ptr<render::Subject>(new Fractal); }};
}

} // namespace apeiron::fractal
