// Sequences of formulas and what is done to the point before each step, against their definitions in double precision.

#include "fractal_support.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::test {
namespace {

using glm::dvec3;

/// An orbit as its definition has it, in double precision.
struct Reference {
    dvec3 z{0.0};
    dvec3 c{0.0};
    double derivative = 1.0;
};

/// Quadratic or cubic triplex power by trigonometry (White & Nylander 2009).
void bulb(Reference& o, double power) {
    const double r = glm::length(o.z);
    const double polar = power * std::atan2(std::hypot(o.z.x, o.z.y), o.z.z);
    const double azimuth = power * std::atan2(o.z.y, o.z.x);
    o.z = std::pow(r, power) *
              dvec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)) +
          o.c;
    o.derivative = power * std::pow(r, power - 1.0) * o.derivative + 1.0;
}

/// Tom Lowe's box and ball fold, scale and shift (2010).
void box(Reference& o, double scale) {
    o.z = 2.0 * glm::clamp(o.z, -1.0, 1.0) - o.z;
    const double k = std::max(1.0 / glm::clamp(glm::dot(o.z, o.z), 0.25, 1.0), 1.0);
    o.z = scale * k * o.z + o.c;
    o.derivative = o.derivative * std::abs(scale) * k + 1.0;
}

/// Without what takes time to compile.
scene::Scene plain(const std::string& subject) {
    scene::Scene scene = fractalOf(subject);
    setAll(scene, {{"renderer.shadow", "none"},
                   {"renderer.ambient_occlusion", "none"},
                   {"subject.coloring", "solid"},
                   {"output.width", "8"},
                   {"output.height", "8"}});
    return scene;
}

/// Expects estimates to be those of `truth`, but for points that end within rounding of the bailout radius.
void expectDistances(const scene::Scene& scene, const std::vector<glm::vec3>& points,
                     const std::function<double(dvec3)>& truth) {
    const std::vector<double> found = distancesAt(scene, points);
    std::size_t wrong = 0;
    std::string examples;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double expected = truth(points[i]);
        // An orbit's rounding error grows with its derivative: relative to the distance, an ulp / distance.
        if (std::abs(found[i] - expected) <= 1e-4 * std::abs(expected) + 3e-6) continue;
        ++wrong;
        examples += fmt::format("{} instead of {}\n", found[i], expected);
    }
    EXPECT_LE(wrong, points.size() / 50) << examples;
}

TEST(Hybrid, takes_its_formulas_in_turns) {
    const scene::Scene scene =
        fractalOf(R"({"formula": "mandelbox", "scale": 2, "repeat": 2, "iterations": 8, "bailout": 150,
                                             "slots": [{"formula": "mandelbulb", "power": 2},
                                                       {"formula": "mandelbulb", "power": 3, "repeat": 2}]})");
    expectDistances(scene, pointsInBall(200, 4.0, 1), [](const dvec3& p) {
        Reference o{p, p, 1.0};
        for (int i = 0; i < 8 && glm::length(o.z) <= 150.0; ++i) {
            const int turn = i % 5;
            if (turn < 2) box(o, 2.0);
            if (turn == 2) bulb(o, 2.0);
            if (turn > 2) bulb(o, 3.0);
        }
        return glm::length(o.z) / o.derivative;
    });
}

TEST(Hybrid, of_one_formula_in_two_slots_is_that_formula) {
    const auto points = pointsInBall(200, 1.5, 2);
    const std::vector<double> alone = distancesAt(fractalOf(R"({"power": 3})"), points);
    const std::vector<double> twice =
        distancesAt(fractalOf(R"({"power": 3, "repeat": 3, "slots": [{"power": 3}]})"), points);
    for (std::size_t i = 0; i < points.size(); ++i)
        // The same steps; compilers may fuse their products differently.
        EXPECT_NEAR(twice[i], alone[i], 1e-4 * alone[i] + 3e-6);
}

TEST(Hybrid, gives_each_slot_parameters_of_its_own) {
    scene::Scene scene = plain(R"({"power": 2, "slots": [{"power": 3}, {"power": 4}]})");
    scene.set("camera.position", std::string_view("0.45,0.3,0.5"));
    const auto session = std::make_unique<session::Session>(context(), scene, session::Options{{}, false, 0, 1});
    const double before = session->distanceToSurface();
    EXPECT_EQ(session->set("subject.slots.1.power", std::string_view("7")), parameter::Invalidates::Samples);
    const double after = session->distanceToSurface();
    EXPECT_NE(before, after);
    EXPECT_EQ(session->set("subject.slots.1", std::string_view("null")), parameter::Invalidates::Program);
    EXPECT_EQ(session->set("subject.slots.0", std::string_view("null")), parameter::Invalidates::Program);
    const double alone = session->distanceToSurface();
    EXPECT_EQ(session->set("subject.slots.0.formula", std::string_view("mandelbox")), parameter::Invalidates::Program);
    EXPECT_NE(session->distanceToSurface(), alone);
}

TEST(Hybrid, is_the_same_specialised_or_not) {
    const scene::Scene scene = plain(R"({"formula": "menger", "pre_rotation": [10, 20, 30],
        "slots": [{"formula": "mandelbox", "pre_fold": "diagonal", "repeat": 2}]})");
    session::Session variable(context(), scene, {.specialise = false});
    session::Session constant(context(), scene, {.specialise = true});
    for (const char* position : {"2,1,0.5", "-1,1.5,0.3", "3,-2,4"}) {
        variable.set("camera.position", std::string_view(position));
        constant.set("camera.position", std::string_view(position));
        const double d = variable.distanceToSurface();
        EXPECT_GT(d, 0.0);
        // Constants are folded in other orders.
        EXPECT_NEAR(constant.distanceToSurface(), d, 1e-4 * d + 1e-6);
    }
}

TEST(Hybrid, takes_the_distance_as_it_is_told_to) {
    const auto points = pointsInBall(100, 1.4, 3);
    const auto distances = [&](const char* how) {
        return distancesAt(fractalOf(fmt::format(R"({{"power": 3, "distance": "{}"}})", how)), points);
    };
    const std::vector<double> own = distances("auto");
    EXPECT_EQ(distances("log"), own) << "the mandelbulb's own";
    const auto orbits = valuesAt(fractalOf(R"({"power": 3})"), points,
                                 "vec4(sqrt(fractal_orbit(p).r2) / fractal_orbit(p).derivative, 0.0, 0.0, 0.0)");
    const std::vector<double> linear = distances("linear");
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(linear[i], orbits[i].x, 1e-5 * orbits[i].x);
}

/// A sphere of radius 1 behind one step that does nothing but what its slot does before.
std::string sphere(const std::string& parameters) {
    return R"({"formula": {"name": "sphere", "source": "uniform int iterations; //! 1 [1, 9]\nuniform float bailout; //! 1e9\n)"
           R"(void iterate(inout Orbit orbit) {}\nfloat estimate(Orbit orbit) { return (sqrt(orbit.r2) - 1.0) / orbit.derivative; }"}, )" +
           parameters + "}";
}

TEST(PreTransform, keeps_distances_exact) {
    const auto points = pointsInBall(100, 4.0, 4);
    // A factor of 2 behind a shift: the sphere has radius 1/2, around the point that goes to the origin.
    const std::vector<double> found = distancesAt(
        fractalOf(sphere(R"("pre_scale": 2, "pre_offset": [1, 2, -0.5], "pre_rotation": [0, 0, 90])")), points);
    const dvec3 centre(-1.0, 0.5, 0.25); // turned by 90 degrees about z: (-0.5, -1, 0.25)
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(found[i], glm::length(dvec3(points[i]) - centre) - 0.5, 3e-6);
}

TEST(PreTransform, folds_at_its_mirrors) {
    const auto points = pointsInBall(100, 3.0, 5);
    const auto folded = [&](const char* fold) {
        return valuesAt(fractalOf(fmt::format(R"({{"pre_fold": "{}"}})", fold)), points, "vec4(slot0_fold(p), 0.0)");
    };
    const auto expectFold = [&](const char* name, const std::function<dvec3(dvec3)>& truth) {
        const auto found = folded(name);
        for (std::size_t i = 0; i < points.size(); ++i)
            EXPECT_LT(glm::length(dvec3(found[i]) - truth(points[i])), 1e-6) << name;
    };
    expectFold("abs", [](const dvec3& p) { return glm::abs(p); });
    expectFold("abs_x", [](const dvec3& p) { return dvec3(std::abs(p.x), p.y, p.z); });
    expectFold("abs_y", [](const dvec3& p) { return dvec3(p.x, std::abs(p.y), p.z); });
    expectFold("abs_z", [](const dvec3& p) { return dvec3(p.x, p.y, std::abs(p.z)); });
    expectFold("box", [](const dvec3& p) { return 2.0 * glm::clamp(p, -1.0, 1.0) - p; });
    expectFold("diagonal", [](dvec3 p) {
        std::sort(&p.x, &p.x + 3, std::greater<>());
        return p;
    });
}

TEST(PreTransform, comes_before_every_step) {
    expectDistances(fractalOf(R"({"power": 3, "iterations": 6, "bailout": 4, "pre_fold": "abs", "pre_scale": 1.2,
                                  "pre_offset": [0.1, -0.2, 0.3], "pre_rotation": [0, 90, 0]})"),
                    pointsInBall(200, 1.5, 6), [](const dvec3& p) {
                        Reference o{p, p, 1.0};
                        for (int i = 0; i < 6 && glm::length(o.z) <= 4.0; ++i) {
                            o.z = glm::abs(o.z);
                            o.z = dvec3(o.z.z, o.z.y, -o.z.x); // 90 degrees about y
                            o.z = 1.2 * o.z + dvec3(0.1, -0.2, 0.3);
                            o.derivative *= 1.2;
                            bulb(o, 3.0);
                        }
                        const double r = glm::length(o.z);
                        return std::max(0.5 * r * std::log(r) / o.derivative, 0.0);
                    });
}

TEST(Julia, is_said_to_do_nothing_where_a_formula_has_no_constant) {
    session::Session session(context(), plain(R"({"formula": "menger", "julia": true})"));
    ASSERT_EQ(session.notes().size(), 1U);
    EXPECT_THAT(session.notes()[0], testing::HasSubstr("menger has no constant"));
    session.set("subject.formula", std::string_view("mandelbulb"));
    EXPECT_TRUE(session.notes().empty());
}

} // namespace
} // namespace apeiron::test
