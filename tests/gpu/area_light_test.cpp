// Rectangles that shine, against Lambert's closed form, quadrature, points far away, and themselves in parts. Seeds are
// fixed: statistical tests pass or fail for good. z-tests at 4 sigma: by chance, one in 16,000 fails.

#include "volume_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// What a scene says of a rectangle, and the same in numbers.
struct Panel {
    glm::dvec3 position{0.0};
    glm::dvec3 target{0.0};
    double width = 1.0;
    double height = 1.0;
    double intensity = 1.0;
    double roll = 0.0; ///< [deg]
    bool visible = false;

    glm::dvec3 front() const { return glm::normalize(target - position); }
    double radiance() const { return intensity / (width * height); }
    /// Along the width and the height: not worked out for a front that looks straight up or down.
    std::array<glm::dvec3, 2> sides() const {
        const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 0, 1), front()));
        const glm::dvec3 y = glm::cross(front(), x);
        const double a = glm::radians(roll);
        return {std::cos(a) * x + std::sin(a) * y, std::cos(a) * y - std::sin(a) * x};
    }
    glm::dvec3 point(double u, double v) const {
        return position + (u - 0.5) * width * sides()[0] + (v - 0.5) * height * sides()[1];
    }
    Json json() const {
        return {{"type", "rectangle"},
                {"position", {position.x, position.y, position.z}},
                {"target", {target.x, target.y, target.z}},
                {"width", width},
                {"height", height},
                {"roll", roll},
                {"color", {1, 1, 1}},
                {"intensity", intensity},
                {"visible", visible}};
    }
};

/// Irradiance of a polygon that is above the horizon as a whole and whose front is seen (Lambert 1760, "Photometria";
/// the form factor of configuration C-23 in Howell's catalogue, times pi times radiance).
double lambert(const Panel& panel, const glm::dvec3& place, const glm::dvec3& normal) {
    const std::array<glm::dvec2, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 a = glm::normalize(panel.point(corners[i].x, corners[i].y) - place);
        const glm::dvec2 next = corners[(i + 1) % 4];
        const glm::dvec3 b = glm::normalize(panel.point(next.x, next.y) - place);
        const glm::dvec3 edge = glm::cross(b, a);
        sum += std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::dot(glm::normalize(edge), normal);
    }
    return 0.5 * panel.radiance() * std::abs(sum);
}

/// Near and far, upright and tilted: solid angles of 5.6 down to 0.0007 sr from the origin.
std::vector<Panel> panels() {
    return {{{0.1, 0.05, 0.3}, {0.1, 0.0501, -1.0}, 2.0, 1.6, 3.0, 0.0},
            {{0.8, -0.7, 1.2}, {0.0, 0.0, 0.0}, 1.0, 0.6, 3.0, 25.0},
            {{-1.5, 0.2, 1.5}, {1.0, 0.3, 0.8}, 0.8, 1.6, 5.0, -70.0},
            {{5.0, 3.0, 9.0}, {0.0, 0.0, 0.0}, 0.3, 0.3, 80.0, 10.0}};
}

scene::Scene litBy(const Panel& panel) {
    scene::Scene scene = darkSphere({24, 24});
    scene.subject.set("formula", formulaOf("p.z", 1000.0));
    scene.set("lights", Json::array({panel.json()}));
    setAll(scene, {{"camera.projection", "orthographic"},
                   {"camera.position", "0,0,3"},
                   {"camera.target", "0,0,0"},
                   {"camera.up", "0,1,0"},
                   {"camera.fov", "10"}});
    return scene;
}

TEST(AreaLight, draws_directions_that_meet_it_and_whose_mean_is_lamberts_irradiance) {
    for (const Panel& panel : panels()) {
        scene::Scene scene = litBy(panel);
        setAll(scene, {{"camera.position", "0,0,0"}, {"camera.target", "0,0,1"}});
        const auto images =
            runOnScene(scene,
                       "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                       "    float pdf; bool sharp;\n"
                       "    LightSample light = light_drawn(0, vec3(0.0), random_pair(pixel, 8u), pdf, sharp);\n"
                       "    float distance; float other;\n"
                       "    vec3 met = light_met(0, vec3(0.0), light.direction, distance, other);\n"
                       "    a = vec4(light.irradiance.x * light.direction.z, met.x, pdf, other);\n"
                       "    b = vec4(light.distance * light.direction, distance / light.distance);\n"
                       "}\n",
                       {128, 128}, 2, {});
        double sum = 0.0;
        double squares = 0.0;
        double missed = 0.0;
        glm::dvec3 low(1e30);
        glm::dvec3 high(-1e30);
        const double n = 128.0 * 128.0;
        for (int y = 0; y < 128; ++y) {
            for (int x = 0; x < 128; ++x) {
                const auto a = images[0].at(x, y);
                const auto b = images[1].at(x, y);
                sum += a[0] / n;
                squares += a[0] * a[0] / n;
                // The outermost points may fall off the edge by rounding.
                missed += a[1] == 0.0F ? 1.0 : 0.0;
                if (a[1] > 0.0F) {
                    ASSERT_NEAR(a[1], panel.radiance(), 1e-4 * panel.radiance());
                    ASSERT_NEAR(a[2], a[3], 1e-3 * a[2]);
                    ASSERT_NEAR(b[3], 1.0, 1e-3);
                }
                const glm::dvec3 at = glm::dvec3(b[0], b[1], b[2]) - panel.position;
                const glm::dvec3 along(glm::dot(at, panel.sides()[0]), glm::dot(at, panel.sides()[1]),
                                       glm::dot(at, panel.front()));
                low = glm::min(low, along);
                high = glm::max(high, along);
            }
        }
        const double truth = lambert(panel, glm::dvec3(0.0), glm::dvec3(0, 0, 1));
        EXPECT_NEAR(sum, truth, 4.0 * std::sqrt((squares - sum * sum) / n) + 1e-4 * truth) << "at " << panel.position.z;
        EXPECT_LT(missed, 1e-3 * n);
        // All of it, and nothing else.
        EXPECT_NEAR(low.x, -0.5 * panel.width, 0.01 * panel.width);
        EXPECT_NEAR(high.x, 0.5 * panel.width, 0.01 * panel.width);
        EXPECT_NEAR(low.y, -0.5 * panel.height, 0.01 * panel.height);
        EXPECT_NEAR(high.y, 0.5 * panel.height, 0.01 * panel.height);
        EXPECT_NEAR(low.z, 0.0, 1e-4 * glm::length(panel.position));
        EXPECT_NEAR(high.z, 0.0, 1e-4 * glm::length(panel.position));
    }
}

/// Mean radiance of a plane below the rectangle, by the closed form at the pixels' centres.
double planeUnder(const Panel& panel, const scene::Scene& scene) {
    const double extent = 2.0 * 3.0 * std::tan(glm::radians(5.0));
    const auto n = static_cast<int>(scene.output.integer("width"));
    double sum = 0.0;
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const glm::dvec3 place(extent * ((x + 0.5) / n - 0.5), extent * ((y + 0.5) / n - 0.5), 0.0);
            sum += 0.5 / kPi * lambert(panel, place, glm::dvec3(0, 0, 1)) / (n * n);
        }
    }
    return sum;
}

TEST(AreaLight, lights_a_plane_as_lambert_says) {
    for (const Panel& panel : panels()) {
        scene::Scene scene = litBy(panel);
        scene.set("output.samples", Json(16));
        const double truth = planeUnder(panel, scene);
        const auto expectTruth = [&](const std::string& what) {
            const MeanOf mean = meanOf(scene);
            // Pixels are small: the mean over one is that of its centre.
            EXPECT_LT(std::abs(mean.value - truth), 4.0 * std::sqrt(mean.variance) + 5e-4 * truth)
                << what << ", height " << panel.position.z << ": " << mean.value << " instead of " << truth;
        };
        for (const char* shadow : {"none", "penumbra", "sampled"}) {
            scene.set("renderer.shadow", std::string_view(shadow));
            expectTruth(shadow);
        }
        setAll(scene, {{"renderer.type", "pathtrace"}, {"renderer.brdf", "lambert"}});
        for (const char* sampling : {"mis", "light", "brdf"}) {
            scene.set("renderer.sampling", std::string_view(sampling));
            // Few cosines meet what is small.
            scene.set("output.samples", Json(std::string_view(sampling) == "brdf" ? 256 : 16));
            expectTruth(sampling);
        }
    }
}

void expectSame(const MeanOf& a, const MeanOf& b, double slack, const std::string& what) {
    const double sigma = std::sqrt(a.variance + b.variance);
    EXPECT_LT(std::abs(a.value - b.value), 4.0 * sigma + slack * b.value)
        << what << ": " << a.value << " and " << b.value << ", sigma " << sigma;
    EXPECT_GT(b.value, 20.0 * sigma) << what << ": nothing is to be seen";
}

TEST(AreaLight, is_found_alike_by_all_ways_of_sampling_on_glossy_surfaces) {
    Panel panel = panels()[1];
    scene::Scene scene = litBy(panel);
    setAll(scene, {{"camera.position", "-1.6,1.4,2.4"},
                   {"camera.fov", "40"},
                   {"renderer.type", "pathtrace"},
                   {"renderer.brdf", "ggx"},
                   {"subject.roughness", "0.35"},
                   {"output.samples", "128"}});
    // A second one behind a corner of the picture, so that they have to be told apart.
    scene.set("lights", Json::array({panel.json(), panels()[2].json()}));
    scene.subject.set("formula", formulaOf("min(p.z, length(p) - 0.5)", 1000.0));
    const MeanOf both = meanOf(scene);
    for (const char* sampling : {"light", "brdf"}) {
        scene.set("renderer.sampling", std::string_view(sampling));
        expectSame(meanOf(scene), both, 1e-4, sampling);
    }
}

/// A ball that is denser inside, in shades of the value, in front of the dark.
scene::Scene ball(const char* renderer) {
    provide("ball", 24, [](glm::dvec3 p, int) { return std::clamp(1.0 - glm::length(p) / 11.0, 0.0, 1.0); });
    scene::Scene scene = volumeScene("ball", 20.0);
    scene.set("subject.density", Json(12.0));
    scene.set("subject.transfer",
              R"({"window": "none", "space": "linear", "points": [
        {"value": 0, "color": [0.8, 0.8, 0.8], "opacity": 0}, {"value": 1, "color": [0.8, 0.8, 0.8], "opacity": 1}]})");
    scene.set("renderer.type", std::string_view(renderer));
    scene.set("output.samples", Json(32));
    return scene;
}

constexpr std::array kRenderers{"raymarch", "pathtrace", "mcs", "mcm", "eam", "lao", "iso"};

TEST(AreaLight, far_away_is_a_point_of_the_same_intensity) {
    for (const char* renderer : kRenderers) {
        scene::Scene scene = ball(renderer);
        const Panel panel{{-300.0, -800.0, 500.0}, {0.0, 0.0, 0.0}, 2.0, 3.0, 9e5};
        scene.set("lights", Json::array({panel.json()}));
        const MeanOf rectangle = meanOf(scene);
        scene.set("lights", Json::parse(R"([{"type": "point", "position": [-300, -800, 500], "color": [1, 1, 1],
                                             "intensity": 9e5, "radius": 0}])"));
        // The cosine at the ball's edge, 12 mm aside of 990, and the size of the rectangle.
        expectSame(rectangle, meanOf(scene), renderer[0] == 'r' ? 4e-3 : 1e-3, renderer);
    }
}

TEST(AreaLight, is_the_sum_of_its_quarters) {
    for (const char* renderer : kRenderers) {
        scene::Scene scene = ball(renderer);
        const Panel panel{{-14.0, -16.0, 9.0}, {0.0, 0.0, 2.0}, 24.0, 16.0, 2000.0, 20.0};
        scene.set("lights", Json::array({panel.json()}));
        const MeanOf whole = meanOf(scene);
        Json quarters = Json::array();
        for (const double u : {0.25, 0.75}) {
            for (const double v : {0.25, 0.75}) {
                Panel quarter = panel;
                quarter.position = panel.point(u, v);
                quarter.target = quarter.position + panel.target - panel.position;
                quarter.width *= 0.5;
                quarter.height *= 0.5;
                quarter.intensity *= 0.25;
                quarters.push_back(quarter.json());
            }
        }
        scene.set("lights", quarters);
        // Steps of `eam` and `lao` are the same in both; what is left is noise.
        expectSame(meanOf(scene), whole, 2e-4, renderer);
    }
}

TEST(AreaLight, is_scattered_once_as_quadrature_says) {
    // A box of 8 mm, optical depth 2, the lamp above and aside; seen along +y, 4 mm of it.
    constexpr double kDepth = 2.0;
    constexpr double kSigma = kDepth / 8.0;
    provide("slab", 8, [](glm::dvec3, int) { return 1.0; });
    const Panel panel{{2.0, -1.0, 7.0}, {0.0, 0.5, 0.0}, 6.0, 4.0, 90.0, 15.0};
    for (const double g : {-0.5, 0.0, 0.7}) {
        constexpr int kPlaces = 16;
        constexpr int kDeep = 32;
        constexpr int kPoints = 20;
        const double weight = panel.intensity / (kPoints * kPoints); // radiance times area of a point
        double truth = 0.0;
        for (int i = 0; i < kPlaces * kPlaces * kDeep; ++i) {
            const int column = i / kDeep;
            const int row = column / kPlaces;
            const double deep = 8.0 * (i % kDeep + 0.5) / kDeep;
            const glm::dvec3 place(4.0 * ((column % kPlaces + 0.5) / kPlaces - 0.5), deep - 4.0,
                                   4.0 * ((row + 0.5) / kPlaces - 0.5));
            double arriving = 0.0;
            for (int k = 0; k < kPoints * kPoints; ++k) {
                const int line = k / kPoints;
                const glm::dvec3 to = panel.point((k % kPoints + 0.5) / kPoints, (line + 0.5) / kPoints) - place;
                const double d = glm::length(to);
                const glm::dvec3 l = to / d;
                double out = d;
                for (int axis = 0; axis < 3; ++axis)
                    out = std::min(out, ((l[axis] > 0.0 ? 4.0 : -4.0) - place[axis]) / l[axis]);
                // Light travels along -l, then along -y.
                const double base = 1.0 + g * g - 2.0 * g * l.y;
                const double phase = (1.0 - g * g) / (4.0 * kPi * std::pow(base, 1.5));
                arriving +=
                    weight * std::max(-glm::dot(l, panel.front()), 0.0) / (d * d) * phase * std::exp(-kSigma * out);
            }
            truth += 0.7 * kSigma * 8.0 / kDeep * std::exp(-kSigma * deep) * arriving / (kPlaces * kPlaces);
        }
        for (const char* sampling : {"mis", "light", "scattering"}) {
            scene::Scene scene = volumeScene("slab", 4.0);
            scene.set("subject.density", Json(kDepth));
            scene.set("subject.transfer", uniformTransfer(0.7));
            scene.set("subject.anisotropy", Json(g));
            scene.set("lights", Json::array({panel.json()}));
            setAll(scene, {{"renderer.type", "mcs"}, {"output.samples", "64"}});
            scene.set("renderer.sampling", std::string_view(sampling));
            const MeanOf mean = meanOf(scene);
            // Midpoints of 32 steps along an optical depth of 2 are 2e-4 off, those of the lamp's points less.
            EXPECT_LT(std::abs(mean.value - truth), 4.0 * std::sqrt(mean.variance) + 7e-4 * truth)
                << "g " << g << ", " << sampling << ": " << mean.value << " instead of " << truth;
        }
    }
}

TEST(AreaLight, within_a_medium_is_met_before_what_is_behind_it) {
    // What lies behind the lamp takes nothing away from its light, however that is found.
    const Panel panel{{3.0, -2.0, 6.0}, {0.0, 0.0, 0.0}, 8.0, 5.0, 300.0};
    const std::array lights{
        panel.json(),
        Json::parse(
            R"({"type": "point", "position": [3, -2, 6], "color": [1, 1, 1], "intensity": 300, "radius": 2.5})")};
    for (const Json& light : lights) {
        scene::Scene scene = ball("mcm");
        scene.set("lights", Json::array({light}));
        setAll(scene, {{"output.samples", "64"}, {"renderer.bounces", "8"}});
        const MeanOf both = meanOf(scene);
        for (const char* sampling : {"light", "scattering"}) {
            scene.set("renderer.sampling", std::string_view(sampling));
            expectSame(meanOf(scene), both, 2e-4, light.at("type").get<std::string>() + ", " + sampling);
        }
    }
}

TEST(AreaLight, is_seen_by_the_camera_where_that_is_wanted_from_its_front_alone) {
    for (const char* renderer : {"raymarch", "pathtrace", "mcs", "mcm"}) {
        // Beside the ball's isosurface and behind it; nothing else of the ball is there.
        const Panel panel{{6.0, 40.0, 0.0}, {6.0, 0.0, 0.0}, 6.0, 12.0, 720.0, 0.0, true};
        scene::Scene scene = ball(renderer);
        setAll(scene, {{"environment.background", "transparent"}, {"output.samples", "4"}, {"subject.density", "0"}});
        scene.set("lights", Json::array({panel.json()}));
        const Image<float> seen = rendered(scene)->layers().radiance;
        // 20 mm are 32 pixels: x from 3 to 9 mm are pixels 20.8 to 30.4, z from -6 to 6 mm rows 6.4 to 25.6.
        EXPECT_NEAR(seen.at(30, 1)[3], 0.0, 1e-6) << renderer;
        EXPECT_NEAR(seen.at(29, 7)[1], 10.0, 0.05) << renderer;
        EXPECT_NEAR(seen.at(29, 7)[3], 1.0, 1e-6) << renderer;
        EXPECT_EQ(seen.at(31, 16)[1], 0.0F) << renderer;
        scene.set("lights.0.target", std::string_view("6,80,0"));
        EXPECT_NEAR(rendered(scene)->layers().radiance.at(29, 7)[1], 0.0, 1e-6) << renderer;
        scene.set("lights.0.target", std::string_view("6,0,0"));
        scene.set("lights.0.visible", std::string_view("false"));
        EXPECT_NEAR(rendered(scene)->layers().radiance.at(29, 7)[1], 0.0, 1e-6) << renderer;
    }
}

} // namespace
} // namespace apeiron::test
