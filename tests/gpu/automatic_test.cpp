// Distances of formulas that give only their map, and exact gradients of all estimates.

#include "fractal_support.hpp"
#include "gpu/differentiate.hpp"
#include "render/kernel_sources.hpp"
#include "session/subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

using glm::dvec3;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kBulb = "uniform float power; //! 8 [2, 16] | Exponent\n"
                              "vec3 map(vec3 z, vec3 c) {\n"
                              "    float r = length(z);\n"
                              "    float theta = power * acos(z.z / max(r, 1e-20));\n"
                              "    float phi = power * atan(z.y, z.x);\n"
                              "    vec3 direction = vec3(sin(theta) * vec2(cos(phi), sin(phi)), cos(theta));\n"
                              "    return pow(r, power) * direction + c;\n"
                              "}\n";
constexpr const char* kBox = "uniform float bailout; //! 200 [1, 1000] | Escape radius\n"
                             "vec3 map(vec3 z, vec3 c) {\n"
                             "    z = clamp(z, -1.0, 1.0) * 2.0 - z;\n"
                             "    return 2.0 * z / clamp(dot(z, z), 0.25, 1.0) + c;\n"
                             "}\n";

scene::Scene fractalOf(const std::string& source, const std::string& others) {
    scene::Scene scene = test::fractalOf("{" + others + "}");
    scene.subject.set("formula", parameter::ModuleReference{"mine.glsl", source});
    return scene;
}

/// The ratios of two estimates where both are well above rounding, sorted.
std::vector<double> ratios(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> all;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i] > 1e-3 && b[i] > 1e-3) all.push_back(a[i] / b[i]);
    std::sort(all.begin(), all.end());
    return all;
}

TEST(Map, of_the_mandelbulb_has_the_distance_of_its_formula) {
    const auto points = pointsInBall(200, 1.6, 21);
    const std::vector<double> own =
        distancesAt(test::fractalOf(R"({"formula": "mandelbulb", "bailout": 10, "iterations": 12})"), points);
    const std::vector<double> automatic = distancesAt(fractalOf(kBulb, ""), points);
    const std::vector<double> all = ratios(automatic, own);
    ASSERT_GT(all.size(), 80U);
    // The formula takes the map for a conformal one: it stretches by n r^(n-1) in all directions. Along the potential's
    // gradient the true stretch is near that: mostly within a third, by a factor of some more near the poles.
    EXPECT_GT(all[all.size() / 20], 0.6);
    EXPECT_LT(all[all.size() - all.size() / 20 - 1], 1.7);
    EXPECT_NEAR(all[all.size() / 2], 1.0, 0.15);
    // Both say of the same points that they are inside, but for those next to the surface.
    std::size_t different = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        different += (own[i] <= 1e-3) != (automatic[i] <= 1e-3);
    EXPECT_LE(different, points.size() / 50);
}

TEST(Map, that_doubles_has_the_distance_to_its_fixed_point) {
    // z -> 2 z - c escapes from everywhere but c itself, with z = c: its Julia set for c = (1, 0, 0) is the point c,
    // and r / |grad r| = |2^n (p - c) + c| / 2^n, which is the distance but for the last term.
    const auto points = pointsInBall(100, 3.0, 22);
    const std::vector<double> found = distancesAt(
        fractalOf("uniform float bailout; //! 1e5 [1, 1e6] | Far\nuniform int iterations; //! 30 [1, 40] | Many\n"
                  "vec3 map(vec3 z, vec3 c) { return 2.0 * z - c; }\n",
                  R"("julia": true, "julia_c": [1, 0, 0])"),
        points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double truth = glm::length(dvec3(points[i]) - dvec3(1.0, 0.0, 0.0));
        // |c| / 2^n is at most 2 |p - c| / bailout; the cap of half the distance from the origin, or 1, comes first.
        const double most = std::max(0.5 * glm::length(dvec3(points[i])), 1.0);
        EXPECT_NEAR(found[i], std::min(truth, most), 1e-4 * truth);
    }
}

TEST(Map, is_recognised_as_growing_by_powers_or_by_factors) {
    const auto power = [](const std::string& map) {
        return valuesAt(fractalOf(map, ""), {glm::vec3(0.0F)}, "vec4(fractal_grows_as_power())")[0].x > 0.5;
    };
    EXPECT_TRUE(power(kBulb));
    EXPECT_TRUE(
        power("vec3 map(vec3 z, vec3 c) { return vec3(z.x * z.x - z.y * z.y - z.z * z.z, 2.0 * z.x * z.yz) + c; }\n"));
    EXPECT_TRUE(power("vec3 map(vec3 z, vec3 c) { float r = length(z); return z * r * r * r * r * r * r * r * r * r * "
                      "r * r * r * r * r * r; }\n"))
        << "degree 16 leaves the range of floats";
    EXPECT_FALSE(power(kBox));
    EXPECT_FALSE(power("vec3 map(vec3 z, vec3 c) { return 3.0 * abs(z) - 2.0; }\n"));
    EXPECT_FALSE(power("vec3 map(vec3 z, vec3 c) { return -1.2 * z + c; }\n"));
}

TEST(Map, has_the_same_distance_by_dual_numbers_and_by_differences) {
    for (const auto& [source, radius] : {std::pair(kBulb, 1.4), std::pair(kBox, 7.0)}) {
        const auto points = pointsInBall(200, radius, 23);
        const std::vector<double> all =
            ratios(distancesAt(fractalOf(source, R"("derivative": "dual")"), points),
                   distancesAt(fractalOf(source, R"("derivative": "differences")"), points));
        ASSERT_GT(all.size(), 60U);
        // Differences measure a step's mean slope, rounded: most agree to a few percent, except across folds.
        EXPECT_NEAR(all[all.size() / 2], 1.0, 0.01);
        EXPECT_GT(all[all.size() / 10], 0.9);
        EXPECT_LT(all[all.size() - all.size() / 10 - 1], 1.1);
    }
}

TEST(Map, can_be_a_slot_of_a_hybrid) {
    const auto points = pointsInBall(200, 1.4, 24);
    scene::Scene mixed = test::fractalOf(R"({"power": 3, "bailout": 10, "derivative": "dual", "slots": [{}]})");
    mixed.slots[0].set("formula", parameter::ModuleReference{"mine.glsl", kBulb});
    mixed.slots[0].set("power", 5.0);
    const scene::Scene shipped =
        test::fractalOf(R"({"power": 3, "bailout": 10, "derivative": "dual", "slots": [{"power": 5}]})");
    const std::vector<double> all = ratios(distancesAt(mixed, points), distancesAt(shipped, points));
    ASSERT_GT(all.size(), 60U);
    // The same maps; acos and atan are good to 1e-3 only.
    EXPECT_GT(all[all.size() / 20], 0.95);
    EXPECT_LT(all[all.size() - all.size() / 20 - 1], 1.05);
}

TEST(Map, that_cannot_be_differentiated_says_so_and_where) {
    const std::string source = "vec3 map(vec3 z, vec3 c) {\n"
                               "    mat2 m = mat2(z.x, z.y, -z.y, z.x);\n"
                               "    return vec3(m * z.xy, z.z) + c;\n}\n";
    scene::Scene scene = fractalOf(source, "");
    setAll(scene, {{"output.width", "8"},
                   {"output.height", "8"},
                   {"renderer.shadow", "none"},
                   {"renderer.ambient_occlusion", "none"}});
    const session::Session session(context(), scene);
    ASSERT_EQ(session.notes().size(), 1U);
    EXPECT_EQ(session.notes()[0], "mine.glsl:2: cannot differentiate a matrix that depends on the position; finite "
                                  "differences are used instead");
    scene.subject.set("derivative", std::string("dual"));
    const auto error = errorOf([&] { const session::Session other(context(), scene); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::BadInput);
    EXPECT_THAT(error->what(), StartsWith("mine.glsl:2: cannot differentiate a matrix"));
    EXPECT_THAT(error->what(), HasSubstr("choose subject.derivative differences"));
}

TEST(Map, that_is_wrong_is_an_error_at_its_place) {
    const auto message = [](const std::string& source) {
        const auto error = errorOf([&] { const session::Session session(context(), fractalOf(source, "")); });
        return error ? std::string(error->what()) : std::string("no error");
    };
    EXPECT_THAT(message("// mine\nvec3 map(vec3 z, vec3 c) { return z + nothing; }\n"), StartsWith("mine.glsl:2:"));
    EXPECT_THAT(message("vec3 map(vec3 z) { return z; }\n"), HasSubstr("mine.glsl"));
    EXPECT_THAT(message("vec3 f(vec3 z) { return z; }\n"),
                AllOf(StartsWith("mine.glsl:1:"), HasSubstr("vec3 map(vec3 z, vec3 c)")));
}

/// Gradients of a scene's estimate (exact, by dual numbers).
std::vector<glm::dvec4> gradientsAt(scene::Scene scene, const std::vector<glm::vec3>& points) {
    scene.subject.set("normals", std::string("analytic"));
    return valuesAt(scene, points, "vec4(distance_gradient(p), distance_estimate(p))");
}

TEST(Gradient, of_an_exact_distance_is_the_unit_normal) {
    scene::Scene scene = test::fractalOf("{}");
    scene.subject.set("formula", unitSphere());
    const auto points = pointsInBall(100, 2.0, 25);
    const auto found = gradientsAt(scene, points);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_LT(glm::length(dvec3(found[i]) - glm::normalize(dvec3(points[i]))), 3e-6);
}

class GradientOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Formulas, GradientOf, testing::ValuesIn(parameter::moduleNames("formulas")),
                         [](const auto& instance) { return instance.param; });

TEST_P(GradientOf, an_estimate_is_that_of_differences) {
    scene::Scene scene = test::fractalOf("{}");
    scene.subject.set("formula", parameter::ModuleReference{GetParam(), {}});
    // Few steps: the estimate is then smooth enough for differences in single precision.
    const auto least = static_cast<std::int64_t>(scene.subject.schema().at("iterations").minimum.value_or(1.0));
    scene.subject.set("iterations", std::max(least, std::int64_t{2}));
    scene.subject.set("normals", std::string("analytic"));
    const double radius = std::min(valuesAt(scene, {glm::vec3(0.0F)}, "vec4(distance_bound().w)")[0].x, 3.0);
    const auto points = pointsInBall(200, radius, 26);
    const auto exact = valuesAt(scene, points, "vec4(distance_gradient(p), distance_estimate(p))");
    const auto near =
        valuesAt(scene, points,
                 "vec4(distance_estimate(p + vec3(5e-4, 0, 0)) - distance_estimate(p - vec3(5e-4, 0, 0)), "
                 "distance_estimate(p + vec3(0, 5e-4, 0)) - distance_estimate(p - vec3(0, 5e-4, 0)), "
                 "distance_estimate(p + vec3(0, 0, 5e-4)) - distance_estimate(p - vec3(0, 0, 5e-4)), 0) / 1e-3");
    std::size_t compared = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (exact[i].w < 0.01) continue;
        ++compared;
        const double difference = glm::length(dvec3(exact[i]) - dvec3(near[i]));
        wrong += !(difference <= 0.03 * (1.0 + glm::length(dvec3(exact[i])))); // also what is no number
    }
    ASSERT_GT(compared, 20U);
    // Across folds and where an orbit has a step more, differences compare two branches.
    EXPECT_LE(wrong, compared / 10);
}

TEST_P(GradientOf, an_estimate_can_be_compiled_for_both_stages) {
    scene::Scene scene = test::fractalOf(R"({"normals": "analytic"})");
    scene.subject.set("formula", parameter::ModuleReference{GetParam(), {}});
    const auto subject = session::subjectTypes().front().create();
    for (const gpu::Stage stage : {gpu::Stage::Fragment, gpu::Stage::Compute}) {
        if (stage == gpu::Stage::Compute && !context().capabilities().compute) continue;
        for (const char* derivative : {"auto", "dual"}) {
            scene.subject.set("derivative", std::string(derivative));
            gpu::ShaderSource source;
            subject->addSource(source, scene, {stage, false});
            source.addText("test",
                           "void kernel_main(ivec2 p, out vec4 a) { a = vec4(distance_gradient(vec3(p, 0)), 1); }\n");
            EXPECT_NO_THROW(gpu::Kernel(context(), "test", source, stage, {gpu::PixelFormat::RGBA32F})) << derivative;
        }
    }
}

TEST(Normals, analytic_and_by_tetrahedron_agree_on_smooth_surfaces) {
    // A quaternion-like smooth one: the quadratic bulb after two steps.
    scene::Scene scene = sceneOf(R"({"apeiron": 1, "camera": {"position": ["0", "-4", "0"], "fov": 40, "filter": "box"},
        "subject": {"power": 2, "iterations": 2, "coloring": "solid", "detail": 0.3},
        "renderer": {"shadow": "none", "ambient_occlusion": "none"},
        "output": {"width": 32, "height": 32, "samples": 1}})");
    const auto taps = rendered(scene)->layers().geometry;
    scene.set("subject.normals", std::string_view("analytic"));
    const auto exact = rendered(scene)->layers().geometry;
    std::size_t seen = 0;
    std::size_t apart = 0;
    for (std::size_t i = 0; i < taps.data().size(); i += 4) {
        const dvec3 a = rgb(taps.data().data() + i);
        const dvec3 b = rgb(exact.data().data() + i);
        if (glm::length(a) < 0.5 || glm::length(b) < 0.5) continue;
        ++seen;
        // Taps half a footprint (0.02) away see the mean of the surface's bend: within 3 degrees.
        apart += glm::dot(glm::normalize(a), glm::normalize(b)) < std::cos(glm::radians(3.0));
    }
    EXPECT_GT(seen, 100U);
    EXPECT_LE(apart, seen / 10); // where two sheets meet within a footprint, the taps see both
}

class NormalsFromPositions : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Constants, NormalsFromPositions, testing::Bool(),
                         [](const auto& instance) { return instance.param ? "specialised" : "uniform"; });

TEST_P(NormalsFromPositions, are_the_analytic_ones_away_from_silhouettes) {
    // The bulb with bends that are wider than a pixel: what is sharper has no one normal per pixel.
    // (Measured: median 0.1, 95 % within 3.2 degrees; four taps: 1.4 and 8.)
    scene::Scene scene =
        sceneOf(R"({"apeiron": 1, "camera": {"position": ["1.2", "-2.2", "0.9"], "fov": 30, "filter": "box"},
        "subject": {"power": 8, "iterations": 2, "coloring": "solid", "detail": 0.5, "normals": "position"},
        "renderer": {"shadow": "none", "ambient_occlusion": "none"},
        "output": {"width": 96, "height": 96, "samples": 1}})");
    session::Options options;
    options.specialise = GetParam();
    const auto found = rendered(scene, options)->layers().geometry;
    scene.set("subject.normals", std::string_view("analytic"));
    const auto exact = rendered(scene, options)->layers().geometry;
    const glm::dvec3 towards = glm::normalize(glm::dvec3(1.2, -2.2, 0.9));
    std::vector<double> angles;
    for (std::size_t i = 0; i < found.data().size(); i += 4) {
        const dvec3 a = rgb(found.data().data() + i);
        const dvec3 b = rgb(exact.data().data() + i);
        if (glm::length(a) < 0.5 || glm::length(b) < 0.5) continue;
        ASSERT_NEAR(glm::length(a), 1.0, 1e-5);
        // Where the surface turns away, the ray beside this one may miss it: the known weakness of positions.
        if (glm::dot(b, towards) < 0.35) continue;
        angles.push_back(glm::degrees(std::acos(std::min(glm::dot(a, b), 1.0))));
    }
    ASSERT_GT(angles.size(), 1500U);
    std::sort(angles.begin(), angles.end());
    EXPECT_LT(angles[angles.size() / 2], 3.0);
    EXPECT_LT(angles[angles.size() * 95 / 100], 8.0);
}

TEST(Normals, from_positions_are_the_same_from_both_stages) {
    if (!context().capabilities().compute) GTEST_SKIP() << "no compute shaders";
    const scene::Scene scene = sceneOf(R"({"apeiron": 1, "camera": {"position": ["1.2", "-2.2", "0.9"], "fov": 40},
        "subject": {"iterations": 4, "normals": "position"}, "output": {"width": 32, "height": 32, "samples": 1}})");
    session::Options fragment;
    fragment.stage = gpu::Stage::Fragment;
    session::Options compute;
    compute.stage = gpu::Stage::Compute;
    const auto a = rendered(scene, fragment)->layers().geometry;
    const auto b = rendered(scene, compute)->layers().geometry;
    EXPECT_TRUE(std::equal(a.data().begin(), a.data().end(), b.data().begin()));
}

} // namespace
} // namespace apeiron::test
