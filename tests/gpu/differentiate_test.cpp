// Differentiated GLSL against differences in double precision, and what it says of text that it does not understand.

#include "gpu/differentiate.hpp"

#include "fractal_support.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::test {
namespace {

using glm::dvec3;
using testing::HasSubstr;
using testing::StartsWith;

std::string differentiated(const std::string& text, const std::string& root = "f") {
    return gpu::differentiate(text, {root}, [](int line) { return fmt::format("mine:{}", line); });
}

/// Value (w) and gradient (xyz) of `float f(vec3 p)` at points.
std::vector<glm::dvec4> gradients(const std::string& text, const std::vector<glm::vec3>& points) {
    gpu::ShaderSource source;
    source.addText("text", text);
    source.addFile("gpu/glsl/dual.glsl");
    source.addText("dual", differentiated(text));
    source.addText("main", "uniform vec3 points[256];\n"
                           "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                           "    Dual d = f(Dual3(points[pixel.x], mat3(1.0)));\n"
                           "    a = vec4(d.g, d.v);\n"
                           "    b = vec4(f(points[pixel.x]));\n"
                           "}\n");
    const auto images =
        runKernel(source, gpu::Stage::Fragment, {static_cast<int>(points.size()), 1}, 2,
                  [&](gpu::Kernel& kernel) { kernel.set("points[0]", std::span<const glm::vec3>(points)); });
    std::vector<glm::dvec4> result;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float* v = images[0].data().data() + 4 * i;
        const double alone = images[1].data()[4 * i];
        EXPECT_NEAR(v[3], alone, 2e-6 * (1.0 + std::abs(alone))) << "the value itself";
        result.emplace_back(v[0], v[1], v[2], v[3]);
    }
    return result;
}

/// Expects values and gradients to be those of a function in double precision.
void expectGradients(const std::string& text, const std::function<double(dvec3)>& truth) {
    const auto points = pointsInBall(64, 1.5, 11);
    const auto found = gradients(text, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const dvec3 p(points[i]);
        // GLSL lets asin and its like be off by some 1e-4; gradients() compares with the value at hand.
        EXPECT_NEAR(found[i].w, truth(p), 5e-4 * (1.0 + std::abs(truth(p)))) << text;
        // Central differences of width 1e-5 in double precision are good to about 1e-9.
        constexpr double kStep = 1e-5;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 h(0.0);
            h[axis] = kStep;
            const double slope = (truth(p + h) - truth(p - h)) / (2.0 * kStep);
            EXPECT_NEAR(found[i][axis], slope, 2e-5 * (1.0 + std::abs(slope)))
                << text << " at " << p.x << ", " << p.y << ", " << p.z << " axis " << axis;
        }
    }
}

TEST(Differentiate, knows_the_rules_of_all_functions) {
    struct Rule {
        const char* glsl;
        std::function<double(dvec3)> truth;
    };
    const std::vector<Rule> rules{
        {"p.x * p.y - p.z / (2.0 + p.x)", [](dvec3 p) { return p.x * p.y - p.z / (2.0 + p.x); }},
        {"-p.x + 3.0 * (1.0 - p.y)", [](dvec3 p) { return -p.x + 3.0 * (1.0 - p.y); }},
        {"dot(p, vec3(1.0, 2.0, 3.0) * p)", [](dvec3 p) { return p.x * p.x + 2 * p.y * p.y + 3 * p.z * p.z; }},
        {"length(p - vec3(1.0, 2.0, 3.0))", [](dvec3 p) { return glm::length(p - dvec3(1, 2, 3)); }},
        {"distance(p, p.yzx)", [](dvec3 p) { return glm::distance(p, dvec3(p.y, p.z, p.x)); }},
        {"normalize(p).y", [](dvec3 p) { return glm::normalize(p).y; }},
        {"cross(p, vec3(p.y, 1.0, p.x)).z", [](dvec3 p) { return glm::cross(p, dvec3(p.y, 1.0, p.x)).z; }},
        {"reflect(p, normalize(p.zxy + 4.0)).x",
         [](dvec3 p) { return glm::reflect(p, glm::normalize(dvec3(p.z, p.x, p.y) + 4.0)).x; }},
        {"min(p.x, p.y) + max(p, 0.1).z", [](dvec3 p) { return std::min(p.x, p.y) + std::max(p.z, 0.1); }},
        {"clamp(p, -0.5, p.x).y", [](dvec3 p) { return std::min(std::max(p.y, -0.5), p.x); }},
        {"dot(abs(p), sign(p))", [](dvec3 p) { return p.x + p.y + p.z; }},
        {"mix(p.x, p.y * p.y, p.z) + mix(p, p.yzx, 0.25).x",
         [](dvec3 p) { return glm::mix(p.x, p.y * p.y, p.z) + glm::mix(p.x, p.y, 0.25); }},
        {"step(0.3, p.x) * p.y + floor(p.z)", [](dvec3 p) { return (p.x < 0.3 ? 0.0 : p.y) + std::floor(p.z); }},
        {"fract(p.x) * mod(p.y, 0.7) + mod(p.z + 9.0, 3.0 + p.x)",
         [](dvec3 p) { return glm::fract(p.x) * glm::mod(p.y, 0.7) + glm::mod(p.z + 9.0, 3.0 + p.x); }},
        {"sqrt(p.x + 2.0) + inversesqrt(p.y + 2.0)",
         [](dvec3 p) { return std::sqrt(p.x + 2) + 1.0 / std::sqrt(p.y + 2); }},
        {"pow(p.x + 2.0, 2.5) + pow(p.y + 2.0, p.z)",
         [](dvec3 p) { return std::pow(p.x + 2, 2.5) + std::pow(p.y + 2, p.z); }},
        {"exp(p.x) + log(p.y + 2.0) + exp2(p.z) + log2(p.z + 3.0)",
         [](dvec3 p) { return std::exp(p.x) + std::log(p.y + 2) + std::exp2(p.z) + std::log2(p.z + 3); }},
        {"sin(p.x) * cos(p.y) + tan(0.5 * p.z)",
         [](dvec3 p) { return std::sin(p.x) * std::cos(p.y) + std::tan(0.5 * p.z); }},
        {"asin(0.5 * p.x) + acos(0.5 * p.y) + atan(p.z)",
         [](dvec3 p) { return std::asin(0.5 * p.x) + std::acos(0.5 * p.y) + std::atan(p.z); }},
        {"atan(p.y + 3.0, p.x)", [](dvec3 p) { return std::atan2(p.y + 3, p.x); }},
        {"sinh(p.x) + cosh(p.y) + tanh(p.z)", [](dvec3 p) { return std::sinh(p.x) + std::cosh(p.y) + std::tanh(p.z); }},
        {"radians(p.x) + degrees(0.01 * p.y)", [](dvec3 p) { return glm::radians(p.x) + glm::degrees(0.01 * p.y); }},
        {"smoothstep(-2.0, 2.0, p.x)", [](dvec3 p) { return glm::smoothstep(-2.0, 2.0, p.x); }},
        {"(mat3(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0) * p).y",
         [](dvec3 p) { return 2 * p.x + 5 * p.y + 8 * p.z; }},
        {"(p.xy * mat2(1.0, 2.0, 3.0, 4.0)).y", [](dvec3 p) { return 3 * p.x + 4 * p.y; }},
        {"vec4(p.xy, 2.0, p.z).w * vec3(p.x, p.yz)[1] + vec2(p).x + vec3(float(int(p.z)), p.xy).z",
         [](dvec3 p) { return p.z * p.y + p.x + p.y; }},
        {"(p.x > p.y ? p : p * p.z).x", [](dvec3 p) { return p.x > p.y ? p.x : p.x * p.z; }},
        {"all(lessThan(p, vec3(0.2))) ? p.x * p.x : (p.y > 0.0 && p.x < 1.0 ? p.y * p.z : 2.0)",
         [](dvec3 p) {
             const bool all = p.x < 0.2 && p.y < 0.2 && p.z < 0.2;
             return all ? p.x * p.x : (p.y > 0.0 && p.x < 1.0 ? p.y * p.z : 2.0);
         }},
    };
    for (const Rule& rule : rules)
        expectGradients(fmt::format("float f(vec3 p) {{ return {}; }}\n", rule.glsl), rule.truth);
}

TEST(Differentiate, follows_statements_structs_and_calls) {
    const std::string text = R"(#define HALF 0.5
uniform float unused;
const vec3 table[2] = vec3[2](vec3(1.0, 2.0, 3.0), vec3(0.5));
struct State { vec3 z; float r; int i; };
float scale() { return 1.5; }
float square(float x) { return x * x; }
bool inside(State s) { return s.r < 40.0; }
vec3 swapped(vec3 v) { if (v.x < v.y) v.xy = v.yx; else if (v.y < v.z) { v.zy = v.yz; } return v; }
void bend(inout vec2 a, out float angle, float by) { angle = a.x * by; a += vec2(angle, 1.0); a.y *= 1.1; }
State advance(State s) {
    State t = s;
    float angle;
    bend(t.z.xz, angle, HALF);
    t.z[1] -= 0.25 * angle;
    t.r = square(t.z.x) + dot(t.z, table[1]);
    ++t.i;
    return t;
}
float f(vec3 p) {
    State s = State(swapped(p), 0.0, 0);
    float sum = 0.0, weight = 1.0;
    for (int i = 0; i < 6; ++i) {
        if (i == 4) break;
        if (i == 1) continue;
        s = advance(s);
        if (!inside(s)) break;
        weight *= scale();
        sum += s.r * weight;
    }
    int n = 0;
    while (n < 2) { sum = sum * 0.5 + p.x; n++; }
    do { sum--; } while (false);
    { float sum = 3.0; s.z.x += sum; }
    return sum + float(s.i) + s.z.x;
}
)";
    // The same steps, written anew.
    expectGradients(text, [](dvec3 p) {
        dvec3 z = p;
        if (z.x < z.y)
            std::swap(z.x, z.y);
        else if (z.y < z.z)
            std::swap(z.y, z.z);
        double r = 0.0;
        double sum = 0.0;
        double weight = 1.0;
        int steps = 0;
        for (int i = 0; i < 4; ++i) {
            if (i == 1) continue;
            const double angle = z.x * 0.5;
            z.x += angle;
            z.z = (z.z + 1.0) * 1.1;
            z.y -= 0.25 * angle;
            r = z.x * z.x + 0.5 * (z.x + z.y + z.z);
            ++steps;
            if (r >= 40.0) break;
            weight *= 1.5;
            sum += r * weight;
        }
        for (int n = 0; n < 2; ++n)
            sum = sum * 0.5 + p.x;
        return sum - 1.0 + steps + z.x + 3.0;
    });
}

TEST(Differentiate, leaves_alone_what_does_not_depend_on_the_point) {
    const std::string text =
        differentiated("uniform float a;\n"
                       "mat2 turn() { return mat2(cos(a), sin(a), -sin(a), cos(a)); }\n"
                       "float f(vec3 p) { float b = sin(a) * 2.0; mat2 m = turn(); return (m * p.xy).x * b; }\n");
    EXPECT_THAT(text, HasSubstr("float b = (sin(a) * 2.0);"));
    EXPECT_THAT(text, HasSubstr("mat2 m = turn();"));
    EXPECT_THAT(text, testing::Not(HasSubstr("turn() {"))) << "no second one";
}

TEST(Differentiate, chooses_by_a_function_since_webgl_has_no_choice_of_structs) {
    const std::string text = "struct State { vec3 z; float r; };\n"
                             "float f(vec3 p) {\n"
                             "    State a = State(p, p.x);\n"
                             "    State b = State(p * p, p.y);\n"
                             "    State c = p.z > 0.0 ? a : b;\n"
                             "    return c.z.x + (p.x > p.y ? p.z : 2.0) * c.r;\n"
                             "}\n";
    EXPECT_THAT(differentiated(text), testing::Not(HasSubstr(" ? ")));
    expectGradients(
        text, [](dvec3 p) { return (p.z > 0 ? p.x : p.x * p.x) + (p.x > p.y ? p.z : 2.0) * (p.z > 0 ? p.x : p.y); });
}

TEST(Differentiate, says_what_it_does_not_understand_and_where) {
    const auto message = [](const std::string& body) {
        const auto error =
            errorOf([&] { differentiated("float g;\nfloat f(vec3 p) {\n    " + body + "\n    return p.x;\n}\n"); });
        return error ? std::string(error->what()) : std::string("no error");
    };
    EXPECT_THAT(message("mat2 m = mat2(p.x, p.y, p.z, 1.0);"),
                StartsWith("mine:3: cannot differentiate a matrix that depends on the position"));
    EXPECT_THAT(message("float a[2] = float[2](p.x, 1.0);"), StartsWith("mine:3: cannot differentiate an array that"));
    EXPECT_THAT(message("float a[2]; a[0] = p.x;"), StartsWith("mine:3: cannot differentiate an array that"));
    EXPECT_THAT(message("switch (1) { default: break; }"),
                StartsWith("mine:3: cannot differentiate 'switch' inside a function"));
    EXPECT_THAT(message("p.x = g;"), StartsWith("mine:3: cannot differentiate the global variable 'g'"));
    EXPECT_THAT(message("float a; float b = (a = p.x);"),
                StartsWith("mine:3: cannot differentiate an assignment inside an expression"));
    EXPECT_THAT(message("int i = 0; p.x = p.y > 0.0 ? p.x * float(i++) : 1.0;"),
                StartsWith("mine:3: cannot differentiate a '?' between things that do more"));
    EXPECT_THAT(message("p.x = nothing;"),
                StartsWith("mine:3: cannot differentiate 'nothing', which is declared nowhere"));
    EXPECT_THAT(message("p.x = nothing(p);"), StartsWith("mine:3: cannot differentiate the function 'nothing'"));
    EXPECT_THAT(message("p.q = 1.0;"), StartsWith("mine:3: cannot differentiate"));
    EXPECT_THAT(message("#if 1"), StartsWith("mine:3: cannot differentiate a preprocessor directive"));
    EXPECT_THAT(message("p.x = 1.0"), StartsWith("mine:4: cannot differentiate 'return' where ';' is expected"));
    EXPECT_THAT(message("p.x = (1.0;"), StartsWith("mine:3: cannot differentiate ';' where ')' is expected"));
    EXPECT_THAT(errorOf([] { differentiated("float f(vec3 p) {"); })->what(), HasSubstr("without its '}'"));
    EXPECT_THAT(errorOf([] { differentiated("", "f"); })->what(), HasSubstr("'f', which is not there"));
}

} // namespace
} // namespace apeiron::test
