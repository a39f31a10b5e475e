#include "core/file.hpp"
#include "parameter/glsl_module.hpp"
#include "support.hpp"

namespace apeiron::parameter {
namespace {

using test::messageOf;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

GlslModule parse(const std::string& source) {
    return parseModule("m", "m.glsl", source);
}
Parameter parameterOf(const std::string& line) {
    return parse(line).parameters.at(0);
}
std::string errorOf(const std::string& source) {
    return messageOf([&] { parse(source); });
}

TEST(GlslModuleTest, annotation_declares_everything) {
    const Parameter p = parameterOf(
        "uniform float power; //! 8 [2, 16] step 0.1 unit rad log invalidates program | Exponent | of the power");
    EXPECT_EQ(p.name, "power");
    EXPECT_EQ(p.type, Type::Float);
    EXPECT_EQ(std::get<double>(p.defaultValue), 8);
    EXPECT_EQ(p.minimum, 2);
    EXPECT_EQ(p.maximum, 16);
    EXPECT_EQ(p.step, 0.1);
    EXPECT_EQ(p.unit, "rad");
    EXPECT_TRUE(p.logarithmic);
    EXPECT_TRUE(p.uniform);
    EXPECT_EQ(p.invalidates, Invalidates::Program);
    EXPECT_EQ(p.doc, "Exponent | of the power");
    EXPECT_EQ(p.where, "m.glsl:1");
}

TEST(GlslModuleTest, pieces_come_in_any_order) {
    const Parameter p = parameterOf("uniform vec3 c; //!color invalidates present[0,1](1, 0.5, 0)| Colour");
    EXPECT_TRUE(p.color);
    EXPECT_EQ(p.invalidates, Invalidates::Present);
    EXPECT_EQ(std::get<glm::dvec3>(p.defaultValue), glm::dvec3(1, 0.5, 0));
    EXPECT_EQ(p.maximum, 1);
}

TEST(GlslModuleTest, every_type_has_defaults) {
    EXPECT_EQ(std::get<bool>(parameterOf("uniform bool b; //! true").defaultValue), true);
    EXPECT_EQ(std::get<std::int64_t>(parameterOf("uniform int i; //! -3").defaultValue), -3);
    EXPECT_EQ(std::get<double>(parameterOf("uniform highp float f; //! 1e-6").defaultValue), 1e-6);
    EXPECT_EQ(std::get<glm::dvec2>(parameterOf("uniform vec2 v; //! (1, 2)").defaultValue), glm::dvec2(1, 2));
    EXPECT_EQ(std::get<glm::dvec4>(parameterOf("uniform vec4 v; //! (1,2,3,4)").defaultValue), glm::dvec4(1, 2, 3, 4));
    EXPECT_EQ(parameterOf("uniform float f; //! 1").invalidates, Invalidates::Samples);
}

TEST(GlslModuleTest, labels_make_a_choice) {
    const Parameter p = parameterOf("uniform int s; //! soft {hard, soft, very soft} | Shadows");
    EXPECT_EQ(p.type, Type::Choice);
    EXPECT_THAT(p.choices, ElementsAre("hard", "soft", "very soft"));
    EXPECT_EQ(std::get<std::string>(p.defaultValue), "soft");
    EXPECT_EQ(std::get<std::string>(parameterOf("uniform int s; //! {log, color} log").defaultValue), "log");
    EXPECT_EQ(std::get<std::string>(parameterOf("uniform int s; //! (very soft) {hard, very soft}").defaultValue),
              "very soft");
}

TEST(GlslModuleTest, wrong_annotations_are_errors_at_their_line) {
    const auto error = [](const std::string& line) { return errorOf("\n" + line); };
    EXPECT_EQ(error("uniform float f; //! 99 [2, 16]"), "m.glsl:2: default value: 99 is outside [2, 16]");
    EXPECT_EQ(error("uniform float f; //! x"),
              "m.glsl:2: unknown word \"x\"; known: step, unit, log, color, invalidates");
    EXPECT_EQ(error("uniform float f; //! 1 setp 2"), "m.glsl:2: unknown word \"setp\"; did you mean 'step'?");
    EXPECT_EQ(error("uniform float f; //! [0, 1]"), "m.glsl:2: no default value; write it after //!");
    EXPECT_EQ(error("uniform float f; //! 1 2"), "m.glsl:2: two of default value");
    EXPECT_EQ(error("uniform float f; //! 1 [1, 2"), "m.glsl:2: '[' without ']'");
    EXPECT_EQ(error("uniform float f; //! 1 [2, 1]"), "m.glsl:2: min is above max in [2, 1]");
    EXPECT_EQ(error("uniform float f; //! 1 [1]"), "m.glsl:2: expected [min, max], got [1]");
    EXPECT_EQ(error("uniform float f; //! 1 step"), "m.glsl:2: step needs a value");
    EXPECT_EQ(error("uniform float f; //! 1 step 0"), "m.glsl:2: step must be above 0");
    EXPECT_EQ(error("uniform float f; //! 1 color"), "m.glsl:2: only a vec3 can be a color");
    EXPECT_EQ(error("uniform float f; //! 1 {a, b}"), "m.glsl:2: {...} needs an int uniform");
    EXPECT_EQ(error("uniform bool b; //! true [0, 1]"), "m.glsl:2: a bool has no [min, max], step or log");
    EXPECT_EQ(error("uniform int i; //! hrad {hard, soft}"),
              "m.glsl:2: default value: unknown value \"hrad\"; did you mean 'hard'?");
    EXPECT_EQ(error("uniform int i; //! a {a, a}"), "m.glsl:2: the label 'a' is given twice");
    EXPECT_EQ(error("uniform int i; //! 1.5"), "m.glsl:2: default value: expected a whole number, got \"1.5\"");
    EXPECT_EQ(error("uniform vec3 v; //! 1"),
              "m.glsl:2: default value: expected 3 numbers, such as [0, 0.5, 1], got \"1\"");
    EXPECT_EQ(error("uniform float f; //! 1 invalidates sample"),
              "m.glsl:2: unknown value \"sample\" of invalidates; did you mean 'samples'?");
    EXPECT_THAT(error("uniform sampler2D s; //! 1"), HasSubstr("m.glsl:2: a uniform of type sampler2D cannot be"));
    EXPECT_THAT(error("uniform float f[3]; //! 1"), HasSubstr("m.glsl:2: cannot read this annotated uniform"));
    EXPECT_THAT(error("uniform float a, b; //! 1"), HasSubstr("m.glsl:2: cannot read this annotated uniform"));
    EXPECT_THAT(error("uniform float f //! 1"), HasSubstr("m.glsl:2: an annotated uniform must stand on one line"));
    EXPECT_THAT(error("float f; //! 1"), HasSubstr("m.glsl:2: an annotation (//!) without a uniform"));
    EXPECT_THAT(error("uniform float gl_f; //! 1"), HasSubstr("m.glsl:2: the name 'gl_f' is reserved"));
    EXPECT_THAT(error("uniform float type; //! 1"), HasSubstr("m.glsl:2: a parameter cannot be called 'type'"));
}

TEST(GlslModuleTest, name_taken_twice_is_an_error_that_names_both_lines) {
    EXPECT_EQ(errorOf("uniform float f; //! 1\nuniform float f; //! 2"),
              "m.glsl:2: the parameter 'f' is already declared in m.glsl:1");
}

TEST(GlslModuleTest, values_that_no_uniform_can_hold_are_refused) {
    EXPECT_THAT(errorOf("uniform float f; //! 1e300"), HasSubstr("too large for a shader"));
    EXPECT_THAT(errorOf("uniform int i; //! 3000000000"), HasSubstr("too large for a shader"));
}

TEST(GlslModuleTest, comments_and_plain_uniforms_declare_nothing) {
    const GlslModule module = parse("/* uniform float a; //! 1\n"
                                    "uniform float b; //! x y z\n"
                                    "*/ uniform float c; //! 1\r\n"
                                    "// uniform float d; //! 1\n"
                                    "uniform sampler2D e; // the engine's\n"
                                    "uniform float f;\n"
                                    "// no /* comment starts here\n"
                                    "uniform /* highp */ float g; //! 2");
    ASSERT_EQ(module.parameters.size(), 2U);
    EXPECT_EQ(module.parameters[0].name, "c");
    EXPECT_EQ(module.parameters[0].where, "m.glsl:3");
    EXPECT_EQ(module.parameters[1].name, "g");
}

TEST(GlslModuleTest, annotation_continues_on_lines_of_its_own) {
    const GlslModule module = parse("uniform float f; //! 1 [0, 2]\n"
                                    "                 //! step 0.5 | A doc\n"
                                    "                 //! in two lines\n"
                                    "uniform float g; //! 3 | Next");
    ASSERT_EQ(module.parameters.size(), 2U);
    EXPECT_EQ(module.parameters[0].step, 0.5);
    EXPECT_EQ(module.parameters[0].doc, "A doc in two lines");
    EXPECT_EQ(module.parameters[1].where, "m.glsl:4");
}

TEST(GlslModuleTest, leading_slashes_are_the_doc) {
    EXPECT_EQ(parse("// Licence\n\n/// One.\n///\n///   Two.\n\n/// not this\nfloat f;").doc, "One.\n\n  Two.");
    EXPECT_EQ(parse("float f;\n/// too late").doc, "");
}

TEST(GlslModuleTest, pragmas_are_tags) {
    const GlslModule module = parse("#pragma apeiron provides surface\n# pragma apeiron needs  a b // why\n"
                                    "#pragma apeiron needs c\n#pragma optimize(on)\n#pragma apeiron flag");
    EXPECT_THAT(module.tags,
                ElementsAre(std::pair("flag", ""), std::pair("needs", "a b c"), std::pair("provides", "surface")));
    EXPECT_EQ(errorOf("\n#pragma apeiron"), "m.glsl:2: #pragma apeiron needs a key");
}

TEST(GlslModuleTest, pragma_invalidates_is_the_default_of_the_file) {
    const GlslModule module = parse("uniform float a; //! 1\n#pragma apeiron invalidates present\n"
                                    "uniform float b; //! 1 invalidates program");
    EXPECT_EQ(module.parameters[0].invalidates, Invalidates::Present);
    EXPECT_EQ(module.parameters[1].invalidates, Invalidates::Program);
    EXPECT_EQ(errorOf("\n#pragma apeiron invalidates presnt"),
              "m.glsl:2: unknown value \"presnt\" of invalidates; did you mean 'present'?");
}

TEST(GlslModuleTest, binary_file_is_refused) {
    EXPECT_EQ(errorOf(std::string("a\0b", 3)), "m.glsl: is not a text file");
    EXPECT_EQ(errorOf("// caf\xE9"), "m.glsl: is not in UTF-8; save it as UTF-8");
    EXPECT_EQ(errorOf("// caf\xC3\xA9"), "no error");
}

TEST(GlslModuleTest, modules_come_from_names_paths_and_carried_source) {
    const TemporaryFolder folder;
    writeFile(folder / "mine.glsl", "uniform float f; //! 1");

    const GlslModule byPath = loadModule("tonemappers", {"mine.glsl", {}}, folder.path());
    EXPECT_FALSE(byPath.embedded);
    EXPECT_EQ(byPath.name, "mine.glsl");
    EXPECT_EQ(byPath.file, (folder / "mine.glsl").string());
    EXPECT_EQ(byPath.parameters.size(), 1U);

    const GlslModule carried = loadModule("tonemappers", {"label", "uniform float g; //! 1"}, folder.path());
    EXPECT_FALSE(carried.embedded);
    EXPECT_EQ(carried.parameters[0].name, "g");

    const GlslModule embedded = loadModule("tonemappers", {"reinhard", {}}, folder.path());
    EXPECT_TRUE(embedded.embedded);
    EXPECT_THAT(embedded.file, HasSubstr("tonemappers/reinhard.glsl"));
    EXPECT_THAT(moduleNames("tonemappers"), testing::Contains("reinhard"));
}

TEST(GlslModuleTest, unknown_module_gets_a_suggestion) {
    EXPECT_EQ(messageOf([] {
                  loadModule("tonemappers", {"reinhrad", {}});
              }),
              "unknown module \"reinhrad\" of tonemappers; did you mean 'reinhard'?");
    EXPECT_THAT(messageOf([] {
                    loadModule("tonemappers", {"./no.glsl", {}}, "/nowhere");
                }),
                HasSubstr("/nowhere/./no.glsl: cannot be read"));
}

TEST(GlslModuleTest, all_embedded_modules_can_be_read) {
    for (const char* folder : {"environments", "renderers", "tonemappers", "effects", "formulas"})
        for (const std::string& name : moduleNames(folder))
            EXPECT_EQ(messageOf([&] { loadModule(folder, {name, {}}); }), "no error") << folder << '/' << name;
}

} // namespace
} // namespace apeiron::parameter
