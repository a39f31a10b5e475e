// What colours a fractal: palettes, and what runs along them.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

/// The map z -> 2 z with bailout 8: every orbit is known.
parameter::ModuleReference doubling() {
    return {"doubling", R"(#include "fractal/orbit.glsl"
uniform int iterations; //! 20 [1, 60] | Most iterations
uniform float bailout;  //! 8 [1, 100] | Escape radius
void iterate(inout Orbit orbit) { orbit.z *= 2.0; }
float estimate(Orbit orbit) { return 1.0; }
)"};
}

scene::Scene paletteScene(const char* by, const char* of) {
    scene::Scene scene = darkSphere({256, 1});
    setAll(scene, {{"subject.coloring", "palette"}, {"subject.palette_by", by}, {"subject.palette_of", of}});
    setAll(scene, {{"subject.palette_scale", "1"}, {"subject.palette", "ink"}});
    scene.subject.set("formula", doubling());
    return scene;
}

/// What runs along the palette at 256 points from `from` to `to`.
std::vector<double> measures(const scene::Scene& scene, const glm::vec3& from, const glm::vec3& to) {
    const std::string text = fmt::format("void kernel_main(ivec2 pixel, out vec4 a) {{\n"
                                         "    float s = (float(pixel.x) + 0.5) / 256.0;\n"
                                         "    a = vec4(material_measure(mix(vec3({:.7f}, {:.7f}, {:.7f}),\n"
                                         "        vec3({:.7f}, {:.7f}, {:.7f}), s)));\n"
                                         "}}\n",
                                         from.x, from.y, from.z, to.x, to.y, to.z);
    const Image<float> image = runOnScene(scene, text, {256, 1}, 1)[0];
    std::vector<double> values;
    for (int x = 0; x < 256; ++x)
        values.push_back(image.at(x, 0)[0]);
    return values;
}

TEST(Palette, by_iterations_is_the_continuous_escape_count) {
    const scene::Scene scene = paletteScene("iterations", "nearest");
    const std::vector<double> values = measures(scene, {0.1F, 0, 0}, {4.0F, 0, 0});
    for (int i = 0; i < 256; ++i) {
        const double radius = 0.1 + 3.9 * (i + 0.5) / 256.0;
        // z doubles until it is 8: after log2(8 / r) steps, of at most 20.
        ASSERT_NEAR(values[static_cast<std::size_t>(i)], std::log2(8.0 / radius) / 20.0, 2e-6) << radius;
    }
}

TEST(Palette, nearest_distances_are_those_of_the_orbit) {
    const glm::dvec3 point(0.3, -0.2, 0.6);
    struct Case {
        const char* by;
        std::function<double(const glm::dvec3&)> distance;
    };
    const std::vector<Case> cases{
        {"origin", [](const glm::dvec3& z) { return glm::length(z); }},
        {"planes",
         [](const glm::dvec3& z) {
             return std::min({std::abs(z.x), std::abs(z.y), std::abs(z.z)});
         }},
        {"axes",
         [](const glm::dvec3& z) {
             return std::min({std::hypot(z.x, z.y), std::hypot(z.y, z.z), std::hypot(z.z, z.x)});
         }},
        {"point", [&](const glm::dvec3& z) { return glm::length(z - point); }},
        {"sphere", [&](const glm::dvec3& z) { return std::abs(glm::length(z - point) - 0.7); }},
    };
    const glm::dvec3 from(0.11, 0.2, -0.3);
    const glm::dvec3 to(0.4, -0.3, 0.5);
    for (const Case& c : cases) {
        for (const bool mean : {false, true}) {
            scene::Scene scene = paletteScene(c.by, mean ? "mean" : "nearest");
            setAll(scene, {{"subject.palette_point", "0.3,-0.2,0.6"}, {"subject.palette_radius", "0.7"}});
            const std::vector<double> values = measures(scene, glm::vec3(from), glm::vec3(to));
            for (std::size_t i = 0; i < values.size(); ++i) {
                glm::dvec3 z = glm::mix(from, to, (static_cast<double>(i) + 0.5) / 256.0);
                std::vector<double> distances;
                const double last = std::log2(8.0 / glm::length(z));
                while (glm::length(z) <= 8.0)
                    distances.push_back(c.distance(z *= 2.0));
                const auto of = [&](std::size_t count) {
                    if (!mean) {
                        return *std::min_element(distances.begin(),
                                                 distances.begin() + static_cast<std::ptrdiff_t>(count));
                    }
                    double sum = 0.0;
                    for (std::size_t k = 0; k < count; ++k)
                        sum += distances[k];
                    return sum / static_cast<double>(count);
                };
                const double part = last - std::floor(last);
                ASSERT_NEAR(values[i], glm::mix(of(distances.size() - 1), of(distances.size()), part), 2e-5)
                    << c.by << (mean ? " mean " : " nearest ") << i;
            }
        }
    }
}

TEST(Palette, never_jumps_where_the_orbit_stays_a_step_longer) {
    // Across the sphere |z| = 1 the number of steps changes from 4 to 3.
    for (const char* of : {"nearest", "mean"}) {
        for (const char* by : {"origin", "planes", "axes", "point", "sphere", "iterations", "place"}) {
            const std::vector<double> values =
                measures(paletteScene(by, of), {0.6F, 0.5F, 0.62F}, {0.601F, 0.501F, 0.6201F});
            const auto [least, most] = std::minmax_element(values.begin(), values.end());
            // No measure changes faster than the last of four doublings does; rounded.
            EXPECT_LT(*most - *least, 16.0 * 1.5e-3) << by << " " << of;
            for (std::size_t i = 1; i < values.size(); ++i)
                ASSERT_LT(std::abs(values[i] - values[i - 1]), 16.0 * 1.5e-3 / 256.0 + 1e-5) << by << " " << of;
        }
    }
}

class EveryPalette : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Palette, EveryPalette, testing::ValuesIn(parameter::moduleNames("palettes")),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryPalette, is_a_continuous_albedo) {
    scene::Scene scene = paletteScene("origin", "nearest");
    scene.subject.set("palette", parameter::ModuleReference{GetParam(), {}});
    const Image<float> image = runOnScene(scene,
                                          "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                          "    a = vec4(palette_color(float(pixel.x) / 255.0), 1.0);\n"
                                          "}\n",
                                          {256, 1}, 1)[0];
    double range = 0.0;
    for (int x = 0; x < 256; ++x) {
        for (int c = 0; c < 3; ++c) {
            ASSERT_GE(image.at(x, 0)[c], 0.0F);
            ASSERT_LE(image.at(x, 0)[c], 1.0F);
            // Four segments, each of at most the whole range.
            if (x > 0) {
                ASSERT_LT(std::abs(image.at(x, 0)[c] - image.at(x - 1, 0)[c]), 4.0F / 255.0F + 1e-5F) << x;
            }
            range = std::max(range, std::abs(static_cast<double>(image.at(x, 0)[c]) - image.at(0, 0)[c]));
        }
    }
    EXPECT_GT(range, 0.2) << "a single colour";
}

TEST(Palette, of_own_colours_runs_through_as_many_as_are_used) {
    for (const int stops : {2, 3, 5}) {
        scene::Scene scene = paletteScene("origin", "nearest");
        scene.subject.set("palette", parameter::ModuleReference{"gradient", {}});
        setAll(scene, {{"subject.stop_1", "1,0,0"},
                       {"subject.stop_2", "0,1,0"},
                       {"subject.stop_3", "0,0,1"},
                       {"subject.stop_4", "1,1,0"},
                       {"subject.stop_5", "0,1,1"}});
        scene.subject.set("stops", std::int64_t{stops});
        const Image<float> image = runOnScene(scene,
                                              "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                              "    a = vec4(palette_color(float(pixel.x) / 240.0), 1.0);\n"
                                              "}\n",
                                              {256, 1}, 1)[0];
        const glm::dvec3 colors[]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
        for (int x = 0; x < 256; ++x) {
            const double place = std::min(x / 240.0, 1.0) * (stops - 1);
            const int first = std::min(static_cast<int>(place), stops - 2);
            const glm::dvec3 truth = glm::mix(colors[first], colors[first + 1], place - first);
            ASSERT_LT(glm::length(rgb(image.at(x, 0)) - truth), 1e-5) << stops << " stops, " << x;
        }
    }
}

TEST(Palette, ends_are_clamped_mirrored_or_repeated) {
    for (const char* ends : {"clamp", "mirror", "repeat"}) {
        scene::Scene scene = paletteScene("origin", "nearest");
        setAll(scene, {{"subject.palette_ends", ends}});
        const Image<float> image = runOnScene(scene,
                                              "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                              "    a = vec4(material_wrapped(float(pixel.x - 128) / 40.0));\n"
                                              "}\n",
                                              {256, 1}, 1)[0];
        for (int x = 0; x < 256; ++x) {
            const double t = (x - 128) / 40.0;
            const double turned = t - std::floor(t);
            const bool odd = std::fmod(std::floor(t) + 100.0, 2.0) == 1.0;
            double truth = std::clamp(t, 0.0, 1.0);
            if (*ends == 'm') truth = odd ? 1.0 - turned : turned;
            if (*ends == 'r') truth = turned;
            // At whole numbers rounding may fall on either side.
            if (*ends == 'r' && std::abs(t - std::round(t)) < 1e-6) continue;
            ASSERT_NEAR(image.at(x, 0)[0], truth, 2e-6) << ends << " " << t;
        }
    }
}

TEST(Palette, makes_materials_differ_along_it) {
    scene::Scene scene = paletteScene("place", "nearest");
    setAll(scene, {{"subject.palette_ends", "clamp"},
                   {"subject.roughness", "0.5"},
                   {"subject.roughness_along", "-0.4"},
                   {"subject.metalness_along", "1"},
                   {"subject.emission", "3"},
                   {"subject.emission_along", "2"}});
    const auto images =
        runOnScene(scene,
                   "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                   "    Hit hit = Hit(1.0, vec3(0.0, 0.0, float(pixel.x) / 255.0) - subject_origin, 1e-3, 0.0);\n"
                   "    Material m = surface_material(hit, vec3(0.0, 0.0, 1.0));\n"
                   "    a = vec4(m.albedo, m.roughness);\n"
                   "    b = vec4(m.emission, m.metalness);\n"
                   "}\n",
                   {256, 1}, 2);
    for (int x = 0; x < 256; ++x) {
        const double t = x / 255.0;
        ASSERT_NEAR(images[0].at(x, 0)[3], 0.5 - 0.4 * t, 1e-5);
        ASSERT_NEAR(images[1].at(x, 0)[3], t, 1e-5);
        ASSERT_NEAR(images[1].at(x, 0)[1], 3.0 * t * t * images[0].at(x, 0)[1], 2e-5);
    }
}

TEST(Palette, of_a_user_is_told_what_it_lacks) {
    scene::Scene scene = paletteScene("origin", "nearest");
    scene.subject.set("palette", parameter::ModuleReference{"mine", "vec3 colour(float t) { return vec3(t); }\n"});
    const auto error = errorOf([&] { session::Session(context(), scene); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("vec3 color(float t)"));
    EXPECT_THAT(error->what(), testing::HasSubstr("mine:1"));
}

} // namespace
} // namespace apeiron::test
