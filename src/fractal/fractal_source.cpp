#include "fractal/fractal_source.hpp"

#include "core/error.hpp"
#include "gpu/differentiate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

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

/// Whether a formula gives nothing but its map.
bool isMap(const std::set<std::string>& names) {
    return names.contains("map") && !names.contains("iterate");
}

bool isMap(const Turn& turn) {
    return isMap(gpu::globalNames(turn.node.module("formula").source));
}

bool anyMap(const std::vector<Turn>& turns) {
    return std::any_of(turns.begin(), turns.end(), [](const Turn& turn) { return isMap(turn); });
}

void requireFormula(const parameter::GlslModule& formula, const std::set<std::string>& names) {
    for (const Requirement& required : kRequired) {
        if (names.contains(required.name)) continue;
        throw Error(ErrorKind::BadInput, fmt::format("a formula must declare '{}'", required.declaration),
                    formula.file + ":1", "or nothing but 'vec3 map(vec3 z, vec3 c)'; see src/fractal/orbit.glsl");
    }
}

void addFormula(gpu::ShaderSource& source, const Turn& turn, bool specialise) {
    const parameter::GlslModule& formula = turn.node.module("formula");
    const std::set<std::string> names = gpu::globalNames(formula.source);
    const bool map = isMap(names);
    if (!map) requireFormula(formula, names);
    source.addModule(formula, turn.formula, turn.node, turn.slot, specialise);
    const std::string& prefix = turn.formula;
    const auto byDefault = [&](const char* name, const std::string& declaration) {
        if (!names.contains(name)) source.addText(fmt::format("formula without {}", name), declaration + "\n");
    };
    if (map) {
        byDefault("iterations", fmt::format("const int {}iterations = 12;", prefix));
        byDefault("bailout", fmt::format("const float {}bailout = 32.0;", prefix));
        byDefault("iterate",
                  fmt::format("void {0}iterate(inout Orbit orbit) {{ orbit.z = {0}map(orbit.z, orbit.c); }}", prefix));
        byDefault("estimate", fmt::format("float fractal_automatic(Orbit orbit);\n"
                                          "float {}estimate(Orbit orbit) {{ return fractal_automatic(orbit); }}",
                                          prefix));
    }
    byDefault("start", fmt::format("void {}start(inout Orbit orbit) {{}}", prefix));
    byDefault("bound", fmt::format("float {}bound() {{ return {}; }}", prefix, map ? "100.0" : "1000.0"));
    byDefault("step_factor", fmt::format("const float {}step_factor = 1.0;", prefix));
    source.addModule(turn.node.file(kSlotFile), turn.prefix, turn.node, turn.slot, specialise);
}

void addPalette(gpu::ShaderSource& source, const parameter::Node& subject, bool specialise) {
    const parameter::GlslModule& palette = subject.module("palette");
    if (!gpu::globalNames(palette.source).contains("color")) {
        throw Error(ErrorKind::BadInput, "a palette must declare 'vec3 color(float t)'", palette.file + ":1",
                    "see src/fractal/gradient.glsl");
    }
    source.addModule(palette, "palette_", subject, "subject", specialise);
}

/// The step whose turn it is: each slot has `repeat` of them, then the next, and after the last the first again.
std::string iterateText(const std::vector<Turn>& turns) {
    const auto step = [](const Turn& turn) {
        return fmt::format("{}prepare(orbit); {}iterate(orbit);", turn.prefix, turn.formula);
    };
    std::string text = "void fractal_iterate(inout Orbit orbit) {\n";
    if (turns.size() == 1) return text + "    " + step(turns.front()) + "\n}\nint fractal_cycle() { return 1; }\n";
    std::string sum;
    std::string ends;
    for (std::size_t i = 0; i < turns.size(); ++i) {
        sum += (i == 0 ? "" : " + ") + turns[i].prefix + "repeat";
        ends += fmt::format("    int end{} = {};\n", i, sum);
    }
    text += ends + fmt::format("    int turn = orbit.i % end{};\n", turns.size() - 1);
    for (std::size_t i = 0; i < turns.size(); ++i) {
        const std::string from = i == 0 ? "0" : fmt::format("end{}", i - 1);
        text += fmt::format("    if (turn >= {} && turn < end{}) {{ {} }}\n", from, i, step(turns[i]));
    }
    return text + fmt::format("}}\nint fractal_cycle() {{ return {}; }}\n", sum);
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

/// Where the derivative behind the distance comes from.
enum class Derivative { Formula, Dual, DualIfPossible, Differences };

Derivative derivativeOf(const scene::Scene& scene, const std::vector<Turn>& turns) {
    switch (scene.subject.choice("derivative")) {
    case 1:
        return Derivative::Dual;
    case 2:
        return Derivative::Differences;
    default:
        return anyMap(turns) ? Derivative::DualIfPossible : Derivative::Formula;
    }
}

/// Adds second versions of functions, on dual numbers. Nothing is added when it throws.
void addDual(gpu::ShaderSource& source, const std::string& function) {
    const std::string text =
        gpu::differentiate(source.text(), {function}, [&](int line) { return source.placeOf(line); });
    source.addFile("gpu/glsl/dual.glsl");
    source.addText("the derivative of " + function, text);
}

Error withHint(const Error& error, const char* hint) {
    return {error.kind(), error.what(), {}, hint};
}

void addFormulaEstimate(gpu::ShaderSource& source, bool gradient) {
    source.addFile("fractal/estimate_formula.glsl");
    if (!gradient) return source.addText("no gradient", "vec3 distance_gradient(vec3 p) { return vec3(0.0); }\n");
    try {
        addDual(source, "fractal_distance");
    } catch (const Error& error) {
        throw withHint(error, "choose subject.normals tetrahedron");
    }
    source.addText("gradient", "vec3 distance_gradient(vec3 p) {\n"
                               "    return fractal_distance(Dual3(subject_origin + p, mat3(1.0))).g;\n}\n");
}

} // namespace

std::vector<Turn> turnsOf(const scene::Scene& scene) {
    std::vector<Turn> turns{{scene.subject, "subject", "slot0_", "formula_"}};
    for (std::size_t i = 0; i < scene.slots.size(); ++i) {
        const std::string slot = fmt::format("slot{}", i + 1);
        turns.push_back({scene.slots[i], slot, slot + "_", slot + "_formula_"});
    }
    return turns;
}

std::optional<std::string> addFractal(gpu::ShaderSource& source, const scene::Scene& scene, bool specialise) {
    const std::vector<Turn> turns = turnsOf(scene);
    source.addFile("fractal/orbit.glsl");
    for (const Turn& turn : turns)
        addFormula(source, turn, specialise);
    addPalette(source, scene.subject, specialise);
    for (const auto& file : scene.subject.files()) {
        if (file->file == kSlotFile) continue;
        source.addModule(*file, "subject_", scene.subject, "subject", specialise,
                         gpu::ShaderSource::Rename::Parameters);
    }
    source.addText("the formulas' turns", iterateText(turns) + boundText(turns));
    if (anyMap(turns)) source.addFile("fractal/automatic.glsl");

    std::optional<std::string> problem;
    Derivative derivative = derivativeOf(scene, turns);
    if (derivative == Derivative::Dual || derivative == Derivative::DualIfPossible) {
        try {
            addDual(source, "fractal_orbit");
            source.addFile("fractal/estimate_dual.glsl");
        } catch (const Error& error) {
            if (derivative == Derivative::Dual) throw withHint(error, "choose subject.derivative differences");
            problem = error.what();
            derivative = Derivative::Differences;
        }
    }
    if (derivative == Derivative::Differences) source.addFile("fractal/estimate_differences.glsl");
    if (derivative == Derivative::Formula) addFormulaEstimate(source, scene.subject.choice("normals") == 1);
    return problem;
}

} // namespace apeiron::fractal
