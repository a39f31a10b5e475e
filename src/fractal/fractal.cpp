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

constexpr const char* kSlotFile = "fractal/slot.glsl";

/// The subject's own formula and those of its slots, in the order of their turns.
struct Turn {
    const parameter::Node& node;
    std::string slot;    ///< the node's name among the kernel's bindings
    std::string prefix;  ///< of the slot's own names
    std::string formula; ///< of the names of its formula
};

std::vector<Turn> turnsOf(const scene::Scene& scene) {
    std::vector<Turn> turns{{scene.subject, "subject", "slot0_", "formula_"}};
    for (std::size_t i = 0; i < scene.slots.size(); ++i) {
        const std::string slot = fmt::format("slot{}", i + 1);
        turns.push_back({scene.slots[i], slot, slot + "_", slot + "_formula_"});
    }
    return turns;
}

void requireFormula(const parameter::GlslModule& formula, const std::set<std::string>& names) {
    for (const Requirement& required : kRequired) {
        if (names.contains(required.name)) continue;
        throw Error(ErrorKind::BadInput, fmt::format("a formula must declare '{}'", required.declaration),
                    formula.file + ":1", "see src/fractal/orbit.glsl");
    }
}

void addFormula(gpu::ShaderSource& source, const Turn& turn, bool specialise) {
    const parameter::GlslModule& formula = turn.node.module("formula");
    const std::set<std::string> names = gpu::globalNames(formula.source);
    requireFormula(formula, names);
    source.addModule(formula, turn.formula, turn.node, turn.slot, specialise);
    const auto byDefault = [&](const char* name, const std::string& declaration) {
        if (!names.contains(name)) source.addText(fmt::format("formula without {}", name), declaration + "\n");
    };
    byDefault("start", fmt::format("void {}start(inout Orbit orbit) {{}}", turn.formula));
    byDefault("bound", fmt::format("float {}bound() {{ return 1000.0; }}", turn.formula));
    byDefault("step_factor", fmt::format("const float {}step_factor = 1.0;", turn.formula));
    source.addModule(turn.node.file(kSlotFile), turn.prefix, turn.node, turn.slot, specialise);
}

/// The step whose turn it is: each slot has `repeat` of them, then the next, and after the last the first again.
std::string iterateText(const std::vector<Turn>& turns) {
    const auto step = [](const Turn& turn) {
        return fmt::format("{}prepare(orbit); {}iterate(orbit);", turn.prefix, turn.formula);
    };
    std::string text = "void fractal_iterate(inout Orbit orbit) {\n";
    if (turns.size() == 1) return text + "    " + step(turns.front()) + "\n}\n";
    std::string sum;
    std::string ends;
    for (std::size_t i = 0; i < turns.size(); ++i) {
        sum += (i == 0 ? "" : " + ") + turns[i].prefix + "repeat";
        ends += fmt::format("    int end{} = {};\n", i, sum);
    }
    text += ends + fmt::format("    int turn = orbit.i % end{};\n", turns.size() - 1);
    // Loops of one turn instead of ifs: all neighbours' orbits are at the same step, and rasterisers on the CPU, which
    // compute both branches of an `if`, skip an empty loop.
    for (std::size_t i = 0; i < turns.size(); ++i) {
        const std::string from = i == 0 ? "0" : fmt::format("end{}", i - 1);
        text += fmt::format("    for (int n = 0; n < int(turn >= {} && turn < end{}); ++n) {{ {} }}\n", from, i,
                            step(turns[i]));
    }
    return text + "}\n";
}

/// A formula's own bound holds for it alone. Nothing is known of hybrids but that they are about as large as their
/// parts: too large a bound costs a few steps, too small a one cuts off what is there.
std::string boundText(const std::vector<Turn>& turns) {
    std::string bound = turns.front().formula + "bound()";
    std::string changes = turns.front().prefix + "changes()";
    for (std::size_t i = 1; i < turns.size(); ++i) {
        bound = fmt::format("max({}, {}bound())", bound, turns[i].formula);
        changes = "true";
    }
    return fmt::format("float fractal_bound() {{ return {} ? 4.0 * {} : formula_bound(); }}\n", changes, bound);
}

class Fractal : public render::Subject {
  public:
    std::set<std::string> provides() const override { return {"surface"}; }

    void addSource(gpu::ShaderSource& source, const scene::Scene& scene,
                   const render::BuildOptions& options) const override {
        const std::vector<Turn> turns = turnsOf(scene);
        source.addFile("fractal/orbit.glsl");
        const parameter::GlslModule& palette = scene.subject.module("palette");
        if (!gpu::globalNames(palette.source).contains("color")) {
            throw Error(ErrorKind::BadInput, "a palette must declare 'vec3 color(float t)'", palette.file + ":1",
                        "see src/fractal/gradient.glsl");
        }
        source.addModule(palette, "palette_", scene.subject, "subject", options.specialise);
        for (const Turn& turn : turns)
            addFormula(source, turn, options.specialise);
        for (const auto& file : scene.subject.files()) {
            if (file->file == kSlotFile) continue;
            source.addModule(*file, "subject_", scene.subject, "subject", options.specialise,
                             gpu::ShaderSource::Rename::Parameters);
        }
        source.addText("the formulas' turns", iterateText(turns) + boundText(turns));
        source.addFile("fractal/estimate_formula.glsl");
    }

    std::vector<std::string> notes(const scene::Scene& scene) const override {
        std::vector<std::string> notes;
        if (!scene.subject.flag("julia")) return notes;
        for (const Turn& turn : turnsOf(scene)) {
            const parameter::GlslModule& formula = turn.node.module("formula");
            const auto tag = formula.tags.find("julia");
            if (tag != formula.tags.end() && tag->second == "none")
                notes.push_back(fmt::format("{} has no constant: subject.julia does not change it", formula.name));
        }
        return notes;
    }

    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const override {
        const auto& position = scene.camera.get<parameter::Decimal3>("position");
        for (const Turn& turn : turnsOf(scene))
            kernel.setParameters(turn.slot, turn.node);
        kernel.set("subject_origin", glm::vec3(render::difference(position, {})));
    }
};

parameter::Parameter formulaParameter(const char* doc) {
    parameter::Parameter formula;
    formula.name = "formula";
    formula.type = parameter::Type::Module;
    formula.folder = "formulas";
    formula.defaultValue = parameter::ModuleReference{"mandelbulb", {}};
    formula.invalidates = parameter::Invalidates::Program;
    formula.doc = doc;
    formula.where = "src/fractal/fractal.cpp";
    return formula;
}

parameter::Parameter paletteParameter() {
    parameter::Parameter palette;
    palette.name = "palette";
    palette.type = parameter::Type::Module;
    palette.folder = "palettes";
    palette.defaultValue = parameter::ModuleReference{"sunset", {}};
    palette.invalidates = parameter::Invalidates::Program;
    palette.doc =
        "The colours along a measure, where coloring is palette: a name, or the path of a GLSL file of your own";
    palette.where = "src/fractal/fractal.cpp";
    return palette;
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
              paletteParameter()},
             {"render/glsl/distance_surface.glsl", "fractal/fractal.glsl", "fractal/material.glsl", kSlotFile}},
            {std::move(slot)},
            [] { return std::unique_ptr<render::Subject>(new Fractal); }};
}

} // namespace apeiron::fractal
