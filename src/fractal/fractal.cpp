#include "fractal/fractal.hpp"

#include "fractal/fractal_source.hpp"
#include "render/view.hpp"

#include <fmt/format.h>

namespace apeiron::fractal {
namespace {

class Fractal : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"surface"}; }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        addFractal(source, scene, options.specialise);
    }

    std::vector<std::string> notes(const scene::Scene& scene) const override {
        std::vector<std::string> notes;
        for (const Turn& turn : turnsOf(scene)) {
            const parameter::GlslModule& formula = turn.node.module("formula");
            const auto tag = formula.tags.find("julia");
            if (scene.subject.flag("julia") && tag != formula.tags.end() && tag->second == "none")
                notes.push_back(fmt::format("{} has no constant: subject.julia does not change it", formula.name));
        }
        gpu::ShaderSource source;
        if (const auto problem = addFractal(source, scene, true))
            notes.push_back(*problem + "; finite differences are used instead");
        return notes;
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        for (const Turn& turn : turnsOf(scene))
            kernel.setParameters(turn.slot, turn.node);
        kernel.set("subject_origin", glm::vec3(render::difference(position, {})));
    }
};

/// A choice among the modules of a folder, each choice another program.
parameter::Parameter moduleParameter(const char* name, const char* folder, const char* byDefault, const char* doc) {
    parameter::Parameter parameter;
    parameter.name = name;
    parameter.type = parameter::Type::Module;
    parameter.folder = folder;
    parameter.defaultValue = parameter::ModuleReference{byDefault, {}};
    parameter.invalidates = parameter::Invalidates::Program;
    parameter.doc = doc;
    parameter.where = "src/fractal/fractal.cpp";
    return parameter;
}

parameter::Parameter formulaParameter(const char* doc) {
    return moduleParameter("formula", "formulas", "mandelbulb", doc);
}

} // namespace

render::SubjectType subjectType() {
    parameter::NodeType slot{
        "slot",
        "",
        "A further formula of a hybrid: the subject's own and those of the slots have their turns one after the other",
        {formulaParameter("The map of this slot; the subject's iterations and bailout count, not its own")},
        {kSlotFile}};
    return {{"subject",
             "fractal",
             "A three-dimensional fractal given by a distance estimate",
             {formulaParameter("The map that is iterated: a name, or the path of a GLSL file of your own"),
              moduleParameter("palette", "palettes", "sunset",
                              "The colours along a measure, where coloring is palette: a name, or the path of a GLSL "
                              "file of your own")},
             {"render/glsl/distance_surface.glsl", "fractal/fractal.glsl", "fractal/material.glsl", kSlotFile}},
            {std::move(slot)},
            [] { return std::unique_ptr<render::Subject>(new Fractal); }};
}

} // namespace apeiron::fractal
