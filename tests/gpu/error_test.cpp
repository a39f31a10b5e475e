// What someone sees who writes a formula of his own and makes a mistake.

#include "gpu_support.hpp"

#include <fstream>

namespace apeiron::test {
namespace {

using gpu::Stage;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// A complete formula whose line 9 is `line`.
std::string formulaWith(const std::string& line) {
    return "/// A formula of someone's own.\n"
           "#include \"fractal/orbit.glsl\"\n"
           "uniform int iterations; //! 3 [1, 10] | How often\n"
           "uniform float bailout;  //! 4 [1, 100] | How far\n"
           "/* a comment\n"
           "   of two lines */\n"
           "void iterate(inout Orbit orbit) {\n"
           "    // line 8\n" +
           line +
           "\n}\n"
           "float estimate(Orbit orbit) { return length(orbit.z) - 0.5; }\n"
           "float bound() { return 0.6; }\n";
}

scene::Scene tiny() {
    return sceneOf(R"({"apeiron": 1, "output": {"width": 16, "height": 16, "samples": 1}})");
}

std::optional<Error> errorWith(const std::string& source, Stage stage = Stage::Fragment, bool specialise = true) {
    return errorOf([&] {
        scene::Scene scene = tiny();
        scene.subject.set("formula", parameter::ModuleReference{"mine.glsl", source});
        const session::Session session(context(), scene, {.stage = stage, .specialise = specialise});
    });
}

TEST(UserFormula, works_without_a_build) {
    scene::Scene scene = tiny();
    scene.subject.set("formula", parameter::ModuleReference{"mine.glsl", formulaWith("    orbit.derivative *= 1.0;")});
    const auto session = rendered(scene);
    EXPECT_TRUE(session->distanceAt({8, 8}).has_value());
    EXPECT_FALSE(session->distanceAt({0, 0}).has_value());
}

TEST(UserFormula, works_from_a_file_relative_to_the_scene) {
    const TemporaryFolder folder;
    std::ofstream(folder / "mine.glsl") << formulaWith("");
    scene::Scene scene = tiny();
    scene.set("subject.formula", std::string_view("./mine.glsl"), folder / "");
    std::filesystem::remove(folder / "mine.glsl");
    const auto session = rendered(scene);
    EXPECT_TRUE(session->distanceAt({8, 8}).has_value()) << "the scene no longer needs the file";
}

TEST(UserFormula, may_be_written_as_other_programs_want_it) {
    // Precisions, arrays, helpers and names that the engine uses for itself.
    const std::string source =
        "precision highp float;\n"
        "precision highp int;\n"
        "#include \"fractal/orbit.glsl\"\n"
        "#define PI 3.14159\n"
        "uniform mediump float radius; //! 0.5 [0, 1] | Radius\n"
        "uniform int iterations; //! 3 [1, 10] | How often\n"
        "uniform float bailout;  //! 4 [1, 100] | How far\n"
        "const float[2] weights = float[2](0.5, 0.5);\n"
        "const float one = 1.0, half_pi = 0.5 * PI;\n"
        "struct Hit2 { float t; vec3 position; };\n"
        "float surface_distance2(vec3 p) { return length(p); }\n"
        "vec3 fold(vec3 p) { return abs(p); }\n"
        "void iterate(inout Orbit orbit) { Hit2 h = Hit2(0.0, orbit.z); orbit.z = h.position; }\n"
        "float estimate(Orbit orbit) {\n"
        "    float sum = 0.0;\n"
        "    for (int i = 0; i < 2; ++i) sum += weights[i];\n"
        "    return sum * (surface_distance2(fold(orbit.z)) - radius * one * sin(half_pi));\n"
        "}\n"
        "float bound() { return 1.01 * radius; }\n";
    for (const bool specialise : {true, false}) {
        scene::Scene scene = tiny();
        scene.subject.set("formula", parameter::ModuleReference{"mine.glsl", source});
        setAll(scene, {{"camera.position", "0,-2,0"}});
        const auto session = rendered(scene, {.stage = {}, .specialise = specialise});
        // The probe's camera is at distance 2; `radius` must not have become 0.
        EXPECT_NEAR(session->distanceToSurface(), 1.5, 1e-5) << specialise;
    }
}

TEST(UserFormula, mistakes_are_reported_at_their_line_with_the_compilers_words) {
    for (const Stage stage : {Stage::Fragment, Stage::Compute}) {
        for (const bool specialise : {true, false}) {
            const auto syntax = errorWith(formulaWith("    orbit.z = orbit.z +;"), stage, specialise);
            ASSERT_TRUE(syntax);
            EXPECT_EQ(syntax->kind(), ErrorKind::BadInput);
            EXPECT_THAT(syntax->what(), AllOf(StartsWith("mine.glsl:9:"), HasSubstr("syntax error")));
        }
        const auto undeclared = errorWith(formulaWith("    orbit.z *= no_such_thing;"), stage);
        ASSERT_TRUE(undeclared);
        EXPECT_EQ(undeclared->kind(), ErrorKind::BadInput);
        EXPECT_THAT(undeclared->what(), AllOf(StartsWith("mine.glsl:9:"), HasSubstr("no_such_thing")));
    }
}

TEST(UserFormula, lines_count_on_after_an_include) {
    const std::string source = "#include \"fractal/orbit.glsl\"\n#include \"render/glsl/random.glsl\"\n"
                               "uniform int iterations; //! 3 [1, 10] | How often\n"
                               "uniform float bailout;  //! 4 [1, 100] | How far\n"
                               "void iterate(inout Orbit orbit) {}\n"
                               "float estimate(Orbit orbit) { return undeclared; }\n";
    const auto later = errorWith(source);
    ASSERT_TRUE(later);
    EXPECT_THAT(later->what(), AllOf(StartsWith("mine.glsl:6:"), HasSubstr("undeclared")));
}

TEST(UserFormula, a_missing_include_is_reported_at_its_line) {
    const auto error = errorWith(formulaWith("#include \"fractal/no_such.glsl\""));
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::BadInput);
    EXPECT_THAT(error->what(), AllOf(StartsWith("mine.glsl:9:"), HasSubstr("fractal/no_such.glsl")));
}

TEST(UserFormula, is_told_what_it_lacks) {
    const std::string complete = formulaWith("");
    for (const std::string name : {"iterate", "estimate", "iterations", "bailout"}) {
        std::string source = complete;
        for (std::size_t at = 0; (at = source.find(name, at)) != std::string::npos; at += name.size()) {
            const char after = source[at + name.size()];
            if (std::isalnum(static_cast<unsigned char>(after)) == 0) source.replace(at, name.size(), "other");
        }
        const auto error = errorWith(source);
        ASSERT_TRUE(error) << name;
        EXPECT_EQ(error->kind(), ErrorKind::BadInput) << name;
        EXPECT_THAT(error->what(), AllOf(StartsWith("mine.glsl:"), HasSubstr("must declare"), HasSubstr(name)));
    }
}

TEST(UserFormula, is_blamed_for_a_function_of_the_wrong_form) {
    std::string source = formulaWith("");
    const std::string right = "float estimate(Orbit orbit)";
    source.replace(source.find(right), right.size(), "float estimate(Orbit orbit, int n)");
    const auto error = errorWith(source);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::BadInput) << "no fault of the GPU: " << error->what();
    EXPECT_THAT(error->what(), AllOf(HasSubstr("mine.glsl"), HasSubstr("estimate")));
}

TEST(UserEffect, mistakes_are_reported_at_their_line) {
    scene::Scene scene = tiny();
    session::Session session(context(), scene);
    const auto error = errorOf([&] {
        scene::Scene edited = session.scene();
        edited.effects.emplace_back(edited.catalogue().type("effect", ""));
        edited.effects[0].set("type",
                              parameter::ModuleReference{"glow.glsl", "#include \"post/effect.glsl\"\n\n"
                                                                      "void kernel_main(ivec2 p, out vec4 c) {\n"
                                                                      "    c = effect_at(p) * oops;\n}\n"});
        session.setScene(edited);
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::BadInput);
    EXPECT_THAT(error->what(), AllOf(StartsWith("glow.glsl:4:"), HasSubstr("oops")));
}

} // namespace
} // namespace apeiron::test
