// How kernels are put together from files and modules: nothing here needs a GPU.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace apeiron::gpu {
namespace {

using parameter::Parameter;
using parameter::Type;
using parameter::Value;
using test::errorOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

/// A node whose only parameter is a module with that source, under the name "mine".
parameter::Node nodeOf(const std::string& source) {
    Parameter module;
    module.name = "module";
    module.type = Type::Module;
    module.folder = "formulas";
    module.defaultValue = parameter::ModuleReference{"mine", source};
    return parameter::Node(
        std::make_shared<const parameter::NodeType>(parameter::NodeType{"subject", "test", "A test", {module}, {}}));
}

std::string textOf(const std::string& moduleSource, bool specialise) {
    const parameter::Node node = nodeOf(moduleSource);
    ShaderSource source;
    source.addModule(node.module("module"), "my_", node, "slot", specialise);
    return source.text();
}

TEST(WithoutComments, keeps_every_line_where_it_was) {
    EXPECT_EQ(withoutComments("a // b\nc"), "a     \nc");
    EXPECT_EQ(withoutComments("a /* b\nc */ d"), "a     \n     d");
    EXPECT_EQ(withoutComments("a /**/ b"), "a      b");
    EXPECT_EQ(withoutComments("a / b /c/ d"), "a / b /c/ d");
    EXPECT_EQ(withoutComments("a //"), "a   ");
    EXPECT_EQ(withoutComments("a /* b"), "a     ");
    EXPECT_EQ(withoutComments("a /* // */ b // /* c\nd"), "a          b        \nd");
    EXPECT_EQ(withoutComments("/"), "/");
    EXPECT_EQ(withoutComments(""), "");
}

TEST(GlobalNames, are_functions_uniforms_constants_structs_and_macros) {
    EXPECT_THAT(
        globalNames("uniform float power;\n"
                    "const float a = 1.0;\n"
                    "uniform highp vec3 b;\n"
                    "struct S { float member; vec2 other; };\n"
                    "#define MACRO(x) (x)\n"
                    "  # define FLAG\n"
                    "float forward(vec3 p);\n"
                    "void f(inout S s, float argument) { float local = argument; { int inner; } s.member = 1.0; }\n"
                    "const float table[3] = float[3](1.0, 2.0, 3.0);\n"
                    "int first, second;\n"
                    "vec2 g() { return vec2(0.0); } // float comment;\n"),
        UnorderedElementsAre("power", "a", "b", "S", "MACRO", "FLAG", "forward", "f", "table", "first", "second", "g"));
}

TEST(GlobalNames, are_never_words_of_the_language) {
    EXPECT_THAT(globalNames("precision highp float;\nprecision mediump int;\nuniform float a;"),
                UnorderedElementsAre("a"));
    EXPECT_THAT(globalNames("const float[3] weights = float[3](1.0, 2.0, 3.0);"), UnorderedElementsAre("weights"));
    EXPECT_THAT(globalNames("const highp vec2[2] corners = vec2[2](vec2(0.0), vec2(1.0));"),
                UnorderedElementsAre("corners"));
    EXPECT_THAT(globalNames("layout(std140) uniform;\nuniform float a;"), UnorderedElementsAre("a"));
}

TEST(GlobalNames, go_on_after_a_first_value) {
    EXPECT_THAT(globalNames("const float a = f(1.0, 2.0), b = 3.0;\nfloat c;"), UnorderedElementsAre("a", "b", "c"));
}

TEST(WithPrefix, renames_whole_words_that_are_no_members) {
    const std::set<std::string> names{"scale", "z", "MACRO"};
    EXPECT_EQ(withPrefix("scale * orbit.scale + scaled + rescale", names, "p_"),
              "p_scale * orbit.scale + scaled + rescale");
    EXPECT_EQ(withPrefix("orbit . z = z", names, "p_"), "orbit . z = p_z");
    EXPECT_EQ(withPrefix("2.*z + 1.e5 - z.z", names, "p_"), "2.*p_z + 1.e5 - p_z.z");
    EXPECT_EQ(withPrefix("#define MACRO scale\nMACRO", names, "p_"), "#define p_MACRO p_scale\np_MACRO");
    EXPECT_EQ(withPrefix("#include \"a/scale.glsl\"\nscale", names, "p_"), "#include \"a/scale.glsl\"\np_scale");
    EXPECT_EQ(withPrefix("#pragma apeiron provides scale\nscale", names, "p_"),
              "#pragma apeiron provides scale\np_scale");
}

TEST(GlslLiteral, reads_back_as_the_same_float) {
    Parameter p;
    p.type = Type::Float;
    for (const double value : {0.1, -2.5, 8.0, 1e-20, 3e15, 0.0, 16777217.0}) {
        const std::string literal = glslLiteral(p, Value(value));
        EXPECT_EQ(std::stof(literal), static_cast<float>(value)) << literal;
        EXPECT_NE(literal.find_first_of(".e"), std::string::npos) << literal << " would be an int";
    }
}

TEST(GlslLiteral, has_the_type_of_its_parameter) {
    const auto literal = [](Type type, const Value& value) {
        Parameter p;
        p.type = type;
        p.choices = {"none", "hard", "soft"};
        return glslLiteral(p, value);
    };
    EXPECT_EQ(literal(Type::Bool, true), "true");
    EXPECT_EQ(literal(Type::Int, std::int64_t{-7}), "-7");
    EXPECT_EQ(literal(Type::Choice, std::string("soft")), "2");
    EXPECT_EQ(literal(Type::Vec2, glm::dvec2(1, -2)), "vec2(1.0, -2.0)");
    EXPECT_EQ(literal(Type::Vec3, glm::dvec3(1, 0.5, -2)), "vec3(1.0, 0.5, -2.0)");
    EXPECT_EQ(literal(Type::Vec4, glm::dvec4(1, 2, 3, 4)), "vec4(1.0, 2.0, 3.0, 4.0)");
    EXPECT_EQ(errorOf([&] { literal(Type::Text, std::string("x")); })->kind(), ErrorKind::BadInput);
}

TEST(ShaderSource, includes_a_file_once) {
    ShaderSource source;
    source.addFile("render/glsl/camera.glsl"); // includes random and surface
    source.addFile("render/glsl/random.glsl");
    source.addText("text", "#include \"render/glsl/surface.glsl\"\n#include \"render/glsl/camera.glsl\"\n");
    const auto times = [&](const std::string& needle) {
        int count = 0;
        for (std::size_t at = source.text().find(needle); at != std::string::npos;
             at = source.text().find(needle, at + 1)) {
            ++count;
        }
        return count;
    };
    EXPECT_EQ(times("uint random_hash(uint x) {"), 1);
    EXPECT_EQ(times("struct Ray {"), 1);
    EXPECT_EQ(times("Ray camera_ray(vec2 point) {"), 1);
    EXPECT_EQ(times("#include"), 0);
}

TEST(ShaderSource, says_where_an_include_is_missing) {
    const auto error = errorOf([] { textOf("float a;\nfloat b;\n#include \"no/such.glsl\"\n", false); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::BadInput);
    EXPECT_THAT(error->what(), AllOf(testing::StartsWith("mine:3:"), HasSubstr("no/such.glsl")));
}

TEST(ShaderSource, gives_a_module_names_of_its_own) {
    const std::string text =
        textOf("uniform float a; //! 1\nfloat f(float x) { return a * x; }\nvoid kernel_main() {}\n", false);
    EXPECT_THAT(text, AllOf(HasSubstr("uniform float my_a;"), HasSubstr("float my_f(float x) { return my_a * x; }"),
                            HasSubstr("void kernel_main()")));
}

TEST(ShaderSource, binds_parameters_or_makes_them_constants) {
    const std::string module = "uniform float a; //! 2.5\n"
                               "uniform mediump float b; //! 3\n"
                               "uniform int c; //! 4 invalidates program\n"
                               "uniform float engine;\n";
    const parameter::Node node = nodeOf(module);
    ShaderSource variable;
    variable.addModule(node.module("module"), "my_", node, "slot", false);
    ASSERT_EQ(variable.bindings().size(), 2U);
    EXPECT_EQ(variable.bindings()[0].uniform, "my_a");
    EXPECT_EQ(variable.bindings()[0].parameter, "a");
    EXPECT_EQ(variable.bindings()[0].slot, "slot");
    EXPECT_THAT(variable.text(), AllOf(HasSubstr("uniform float my_a;"), HasSubstr("const int my_c = 4;"),
                                       HasSubstr("uniform float my_engine;")));
    ShaderSource constant;
    constant.addModule(node.module("module"), "my_", node, "slot", true);
    EXPECT_TRUE(constant.bindings().empty());
    EXPECT_THAT(constant.text(), AllOf(HasSubstr("const float my_a = 2.5;"), HasSubstr("float my_b = 3.0;"),
                                       HasSubstr("const int my_c = 4;"), HasSubstr("uniform float my_engine;")));
}

TEST(ShaderSource, knows_the_outputs_of_a_kernel) {
    ShaderSource source;
    source.addText("text", "float f() { return 1.0; }\nvoid kernel_main(ivec2 pixel, out vec4 a,\n"
                           "                 out highp ivec4 b) {}\n");
    const auto outputs = source.outputs();
    ASSERT_EQ(outputs.size(), 2U);
    EXPECT_EQ(outputs[0].type, "vec4");
    EXPECT_EQ(outputs[0].name, "a");
    EXPECT_EQ(outputs[1].type, "ivec4");
    EXPECT_EQ(outputs[1].name, "b");
}

/// Files of the engine's about one of a user's, whose include was there before.
ShaderSource threeFiles() {
    static const parameter::Node node =
        nodeOf("// a comment\n#include \"render/glsl/probe.glsl\"\nfloat f() { return 1; }\n");
    ShaderSource source;
    source.addFile("render/glsl/probe.glsl");
    source.addText("engine.glsl", "float e;\nfloat g;\n");
    source.addModule(node.module("module"), "my_", node, "slot", false);
    source.addText("engine.glsl", "float h;\n");
    return source;
}

/// The line of the text that holds `needle`, from 1.
int lineOf(const ShaderSource& source, const std::string& needle) {
    const std::string& text = source.text();
    return 1 + static_cast<int>(
                   std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(needle)), '\n'));
}

TEST(ShaderSource, maps_the_logs_of_all_compilers_to_files) {
    const ShaderSource source = threeFiles();
    const int mine = lineOf(source, "float my_f()");
    const int engine = lineOf(source, "float h;");
    const auto log = [](const char* format, int line) { return fmt::format(fmt::runtime(format), line); };
    const std::string expected = "mine:3: `x' undeclared";
    // Mesa; it forgets the number of the file for most mistakes
    EXPECT_EQ(source.mapLog(log("0:{}(5): error: `x' undeclared\n", mine)), expected);
    EXPECT_EQ(source.mapLog(log("0:{}(5): preprocessor error: `x' undeclared\n", mine)), expected);
    EXPECT_EQ(source.mapLog("0:1(1): warning: `y' unused\n" + log("0:{}(5): error: `x' undeclared\n", mine)), expected);
    // ANGLE (browsers), glslang
    EXPECT_EQ(
        source.mapLog(log("ERROR: 0:{}: `x' undeclared\n", mine) + log("ERROR: 0:{}: '' : syntax error\n", engine)),
        expected + "\nengine.glsl:1: '' : syntax error");
    // NVIDIA
    EXPECT_EQ(source.mapLog(log("0({}) : error `x' undeclared\n", mine) + log("0({}) : error C0000: more\n", engine)),
              expected + "\nengine.glsl:1: C0000: more");
    EXPECT_EQ(source.mapLog(log("0({}) : warning C7050: unused\n", engine) + log("0({}) : error `x' undeclared", mine)),
              expected);
}

TEST(ShaderSource, leaves_a_log_alone_that_it_cannot_read) {
    const ShaderSource source = threeFiles();
    for (const std::string log : {"something went wrong", "0:7000(1): error: beyond the end", "0:0(1): error: no line",
                                  "0:99999999999999999999999(1): error: x"}) {
        EXPECT_EQ(source.mapLog(log), log);
        EXPECT_FALSE(source.blamesUser(log));
    }
}

TEST(ShaderSource, blames_the_author_of_a_users_file_that_takes_part) {
    const ShaderSource source = threeFiles();
    const std::string inEngine = fmt::format("0:{}(1): error: no matching function", lineOf(source, "float h;"));
    EXPECT_TRUE(source.blamesUser(inEngine));
    EXPECT_EQ(source.mapLog(inEngine), "mine does not fit: engine.glsl:1: no matching function");
    ShaderSource ours;
    ours.addText("engine.glsl", "float e;\n");
    EXPECT_FALSE(ours.blamesUser("0:1(1): error: b\n"));
}

} // namespace
} // namespace apeiron::gpu
