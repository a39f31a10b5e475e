// Formulas against their definitions, in double precision.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Points in the ball of that radius, as floats hold them: both sides then start from the same numbers.
std::vector<glm::dvec3> randomPoints(int count, double radius, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-radius, radius);
    std::vector<glm::dvec3> points;
    while (points.size() < static_cast<std::size_t>(count)) {
        const glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
        if (glm::length(glm::dvec3(p)) < radius) points.emplace_back(p);
    }
    return points;
}

double distanceAt(session::Session& session, const glm::dvec3& point) {
    parameter::Node camera = session.scene().camera;
    camera.set("position", parameter::Decimal3{Decimal(point.x), Decimal(point.y), Decimal(point.z)});
    session.setCamera(scene::Camera(camera));
    return session.distanceToSurface();
}

std::unique_ptr<session::Session> sessionOf(const std::string& formula, bool specialise) {
    scene::Scene scene = darkSphere({8, 8});
    scene.subject.set("formula", parameter::ModuleReference{formula, {}});
    return std::make_unique<session::Session>(context(), scene, session::Options{{}, specialise, 0, 1});
}

/// What an orbit's rounding does to the distance. A step of the map moves a point's rounding error apart as it does
/// neighbouring points, so that after all steps it is the derivative times an ulp. The distance is about
/// size / derivative: relative errors are about an ulp / distance.
double tolerance(double distance) {
    return distance * 3e-5 + 3e-6;
}

/// Expects estimates to agree; some points may stand where an orbit's last step is a matter of rounding.
void expectAgreement(session::Session& session, const std::vector<glm::dvec3>& points,
                     const std::function<double(glm::dvec3)>& truth, const std::string& what) {
    std::size_t wrong = 0;
    std::string examples;
    for (const glm::dvec3& point : points) {
        const double expected = truth(point);
        const double found = distanceAt(session, point);
        ASSERT_TRUE(std::isfinite(found)) << what;
        if (std::abs(found - expected) <= tolerance(std::abs(expected))) continue;
        ++wrong;
        examples += fmt::format("({}, {}, {}): {} instead of {}\n", point.x, point.y, point.z, found, expected);
    }
    // An orbit that ends within an ulp of the bailout radius has a step more or less.
    EXPECT_LE(wrong, points.size() / 50) << what << "\n" << examples;
}

struct Bulb {
    double power = 8.0;
    bool elevation = false;
    double theta = 0.0; // [deg]
    double phi = 0.0;
    bool julia = false;
};

/// White & Nylander's power with trigonometry, and Quilez' estimate.
double mandelbulb(glm::dvec3 p, const Bulb& b) {
    const glm::dvec3 c = b.julia ? glm::dvec3(0.3, 0.5, -0.2) : p;
    glm::dvec3 z = p;
    double dr = 1.0;
    for (int i = 0; i < 10 && glm::length(z) <= 2.0; ++i) {
        const double r = glm::length(z);
        const double rho = std::hypot(z.x, z.y);
        const double polar =
            b.power * (b.elevation ? std::atan2(z.z, rho) : std::atan2(rho, z.z)) + glm::radians(b.theta);
        const double azimuth = b.power * std::atan2(z.y, z.x) + glm::radians(b.phi);
        const double rn = std::pow(r, b.power);
        dr = b.power * std::pow(r, b.power - 1.0) * dr + (b.julia ? 0.0 : 1.0);
        const double level = b.elevation ? std::cos(polar) : std::sin(polar);
        const double height = b.elevation ? std::sin(polar) : std::cos(polar);
        z = rn * glm::dvec3(level * std::cos(azimuth), level * std::sin(azimuth), height) + c;
    }
    const double r = glm::length(z);
    return std::max(0.5 * std::log(r) * r / dr, 0.0);
}

TEST(Mandelbulb, is_the_power_of_triplex_numbers) {
    const auto session = sessionOf("mandelbulb", false);
    const auto points = randomPoints(100, 1.6, 1);
    for (const bool elevation : {false, true}) {
        session->set("subject.polar", std::string_view(elevation ? "elevation" : "zenith"));
        for (const double power : {2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 13.0, 15.0, 16.0, 8.5, 2.3}) {
            session->set("subject.power", std::string_view(fmt::format("{}", power)));
            expectAgreement(
                *session, points,
                [&](const glm::dvec3& p) {
                    return mandelbulb(p, {power, elevation});
                },
                fmt::format("power {} {}", power, elevation ? "elevation" : "zenith"));
        }
    }
}

TEST(Mandelbulb, has_phases) {
    const auto session = sessionOf("mandelbulb", false);
    const auto points = randomPoints(100, 1.6, 2);
    for (const Bulb& bulb :
         {Bulb{8.0, false, 30.0, 0.0}, Bulb{8.0, false, 0.0, -70.0}, Bulb{3.0, false, 12.0, 120.0}}) {
        session->set("subject.power", std::string_view(fmt::format("{}", bulb.power)));
        session->set("subject.theta", std::string_view(fmt::format("{}", bulb.theta)));
        session->set("subject.phi", std::string_view(fmt::format("{}", bulb.phi)));
        expectAgreement(
            *session, points, [&](const glm::dvec3& p) { return mandelbulb(p, bulb); },
            fmt::format("phases {} {}", bulb.theta, bulb.phi));
    }
}

TEST(Mandelbulb, has_julia_sets) {
    const auto session = sessionOf("mandelbulb", false);
    session->set("subject.julia", std::string_view("true"));
    Bulb bulb;
    bulb.julia = true;
    expectAgreement(
        *session, randomPoints(100, 1.6, 3), [&](const glm::dvec3& p) { return mandelbulb(p, bulb); }, "julia");
}

TEST(Mandelbulb, is_finite_on_its_axis_and_at_its_centre) {
    const auto session = sessionOf("mandelbulb", false);
    for (const char* power : {"2", "3", "5", "8", "8.5", "16"}) {
        session->set("subject.power", std::string_view(power));
        for (const double z : {-2.1, -1.1, -0.5, 0.0, 1e-6, 0.3, 1.0, 1.2, 3.0}) {
            for (const double x : {0.0, 1e-20, 1e-8}) {
                const double d = distanceAt(*session, {x, 0.0, z});
                EXPECT_TRUE(std::isfinite(d) && d >= 0.0) << power << " at " << x << ", 0, " << z << ": " << d;
                if (std::abs(z) >= 1.2) {
                    EXPECT_NEAR(d, mandelbulb({x, 0.0, z}, {std::stod(power), false}), tolerance(d))
                        << power << " " << z;
                }
            }
        }
    }
}

/// Tom Lowe's definition: boxFold, ballFold, scale, translate; distance as |z| / |derivative|.
double mandelbox(glm::dvec3 p, double scale) {
    const auto boxFold = [](double x) { return x > 1.0 ? 2.0 - x : (x < -1.0 ? -2.0 - x : x); };
    glm::dvec3 z = p;
    double dr = 1.0;
    for (int i = 0; i < 14 && glm::length(z) <= 200.0; ++i) {
        z = {boxFold(z.x), boxFold(z.y), boxFold(z.z)};
        const double r = glm::length(z);
        const double k = r < 0.5 ? 4.0 : (r < 1.0 ? 1.0 / (r * r) : 1.0);
        z = scale * k * z + p;
        dr = dr * std::abs(scale) * k + 1.0;
    }
    return glm::length(z) / dr;
}

TEST(Mandelbox, is_lowes_map) {
    const auto session = sessionOf("mandelbox", false);
    for (const double scale : {2.0, -1.5, 2.7}) {
        session->set("subject.scale", std::string_view(fmt::format("{}", scale)));
        expectAgreement(
            *session, randomPoints(100, 9.0, 4), [&](const glm::dvec3& p) { return mandelbox(p, scale); },
            fmt::format("scale {}", scale));
    }
}

double boxDistance(const glm::dvec3& p, const glm::dvec3& centre, double half) {
    const glm::dvec3 q = glm::abs(p - centre) - half;
    return glm::length(glm::max(q, 0.0)) + std::min(std::max(q.x, std::max(q.y, q.z)), 0.0);
}

/// Distance to Menger's sponge of that level within a cube, by its definition: 20 of 27 cubes, again and again.
void nearestInSponge(const glm::dvec3& p, const glm::dvec3& centre, double half, int level, double& best) {
    const double here = boxDistance(p, centre, half);
    if (here >= best) return;
    if (level == 0) {
        best = here;
        return;
    }
    std::vector<std::pair<double, glm::dvec3>> parts;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if ((x == 0) + (y == 0) + (z == 0) >= 2) continue;
                const glm::dvec3 middle = centre + 2.0 / 3.0 * half * glm::dvec3(x, y, z);
                parts.emplace_back(boxDistance(p, middle, half / 3.0), middle);
            }
        }
    }
    std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [distance, middle] : parts)
        nearestInSponge(p, middle, half / 3.0, level - 1, best);
}

TEST(Menger, has_the_true_distance_to_the_sponge) {
    const auto session = sessionOf("menger", false);
    for (const int level : {1, 2, 3, 4}) {
        session->set("subject.iterations", std::string_view(fmt::format("{}", level)));
        int exact = 0;
        int outside = 0;
        for (const glm::dvec3& p : randomPoints(150, 2.2, 5)) {
            double truth = 1e9;
            nearestInSponge(p, glm::dvec3(0.0), 1.0, level, truth);
            const double found = distanceAt(*session, p);
            if (truth <= 0.0) {
                EXPECT_LE(found, 1e-6);
                continue;
            }
            ++outside;
            // Coordinates near 1 have an ulp of 1e-7, times what the folds add up.
            EXPECT_LE(found, truth + 2e-6)
                << "overshoots at " << p.x << ", " << p.y << ", " << p.z << " level " << level;
            exact += found > truth - 2e-6;
        }
        EXPECT_GT(outside, 100);
        EXPECT_GT(exact, outside * 9 / 10) << "level " << level << ": " << exact << " of " << outside;
    }
}

class AnyFormula : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Formulas, AnyFormula, testing::ValuesIn(parameter::moduleNames("formulas")),
                         [](const auto& instance) { return instance.param; });

TEST_P(AnyFormula, is_the_same_specialised_or_not) {
    const auto variable = sessionOf(GetParam(), false);
    const auto constant = sessionOf(GetParam(), true);
    std::size_t wrong = 0;
    const auto points = randomPoints(40, 3.0, 6);
    for (const glm::dvec3& p : points) {
        const double a = distanceAt(*variable, p);
        const double b = distanceAt(*constant, p);
        wrong += std::abs(a - b) > tolerance(std::abs(a));
    }
    EXPECT_LE(wrong, points.size() / 20);
}

TEST_P(AnyFormula, is_finite_everywhere_and_positive_outside_its_bound) {
    scene::Scene scene = darkSphere({8, 8});
    scene.subject.set("formula", parameter::ModuleReference{GetParam(), {}});
    const auto images =
        runOnScene(scene,
                   "uniform float radius;\n"
                   "vec3 direction(vec2 u) {\n"
                   "    float z = 2.0 * u.x - 1.0;\n"
                   "    return vec3(sqrt(1.0 - z * z) * vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y)), z);\n"
                   "}\n"
                   "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                   "    vec4 bound = distance_bound();\n"
                   "    vec3 way = direction(random_pair(pixel, 1u));\n"
                   "    vec2 u = random_pair(pixel, 2u);\n"
                   "    float outside = distance_estimate(bound.xyz + bound.w * (1.02 + 3.0 * u.x) * way);\n"
                   "    float anywhere = distance_estimate(bound.xyz + bound.w * u.y * way);\n"
                   "    a = vec4(outside, anywhere, bound.w, distance_estimate(bound.xyz));\n"
                   "}\n",
                   {32, 32}, 1);
    ASSERT_TRUE(allFinite(images[0]));
    for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
        const float* texel = images[0].data().data() + i;
        ASSERT_GT(texel[0], 0.0F) << "a surface outside bound() would be cut off";
        // No surface is further away than the bound's centre, and some of it is within the bound.
        ASSERT_LE(texel[0], 1.001F * (4.02F + 1.0F) * texel[2]);
    }
}

TEST_P(AnyFormula, gives_a_picture_with_a_surface_and_nothing_that_is_no_number) {
    scene::Scene scene = sceneOf(R"({"apeiron": 1, "output": {"width": 64, "height": 64, "samples": 1}})");
    scene.subject.set("formula", parameter::ModuleReference{GetParam(), {}});
    // From outside the bound: the whole of it.
    const auto bound =
        runOnScene(scene, "void kernel_main(ivec2 p, out vec4 a) { a = vec4(distance_bound().w); }\n", {1, 1}, 1);
    const double radius = std::min(bound[0].data()[0], 20.0F);
    const std::string place = fmt::format("{},{},{}", 1.1 * radius, -2.4 * radius, 0.8 * radius);
    scene.set("camera.position", std::string_view(place));
    const auto session = rendered(scene);
    const auto layers = session->layers();
    EXPECT_TRUE(allFinite(layers.radiance));
    EXPECT_TRUE(allFinite(layers.geometry));
    EXPECT_TRUE(allFinite(layers.albedo));
    EXPECT_TRUE(allFinite(session->picture()));
    int hits = 0;
    for (std::size_t i = 3; i < layers.albedo.data().size(); i += 4)
        hits += layers.albedo.data()[i] > 0.0F;
    EXPECT_GT(hits, 200) << "of 4096";
    EXPECT_LT(hits, 3900) << "of 4096";
    EXPECT_EQ(layers.albedo.at(0, 0)[3], 0.0F) << "the corner is background";
}

} // namespace
} // namespace apeiron::test
