// From radiance to what is shown.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::test {
namespace {

/// IEC 61966-2-1.
double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

/// A picture of nothing but the environment.
scene::Scene flat(double radiance) {
    scene::Scene scene = darkSphere({24, 16});
    scene.subject.set("formula", formulaOf("length(p - vec3(0.0, -50.0, 0.0)) - 1.0", 60.0));
    scene.environment.set("color", glm::dvec3(radiance));
    return scene;
}

void expectFlat(const Image<float>& picture, double value, double tolerance) {
    for (std::size_t i = 0; i < picture.data().size(); i += 4) {
        ASSERT_NEAR(picture.data()[i], value, tolerance) << "pixel " << i / 4;
        ASSERT_EQ(picture.data()[i + 3], 1.0F);
    }
}

TEST(Display, encodes_linear_radiance_as_srgb) {
    const auto session = rendered(flat(1.0), {.stage = {}, .specialise = false});
    for (const double radiance : {0.0, 0.001, 0.01, 0.18, 0.5, 0.999, 1.0, 7.0}) {
        session->set("environment.color", std::string_view(fmt::format("{0},{0},{0}", radiance)));
        finish(*session);
        expectFlat(session->picture(), srgb(std::min(radiance, 1.0)), 2e-6);
    }
}

TEST(Display, an_exposure_step_doubles_the_light) {
    const auto session = rendered(flat(0.1));
    for (const auto& [exposure, factor] :
         {std::pair{"1", 2.0}, std::pair{"-2", 0.25}, std::pair{"0.5", std::sqrt(2.0)}}) {
        session->set("post.exposure", std::string_view(exposure));
        expectFlat(session->picture(), srgb(0.1 * factor), 2e-6);
    }
}

TEST(Display, reinhards_curve_is_that_of_the_paper) {
    scene::Scene scene = flat(0.7);
    setAll(scene, {{"post.tonemapper", "reinhard"}, {"post.white", "3"}});
    const auto session = rendered(scene, {.stage = {}, .specialise = false});
    expectFlat(session->picture(), srgb(0.7 * (1.0 + 0.7 / 9.0) / 1.7), 2e-6);
    for (const char* color : {"3,3,3", "50,50,50"}) { // the white point, and beyond
        session->set("environment.color", std::string_view(color));
        finish(*session);
        expectFlat(session->picture(), 1.0, 2e-6);
    }
}

TEST(Display, dither_is_within_half_a_step_and_adds_nothing) {
    const auto session = rendered(flat(0.3));
    const Image<float> plain = session->picture();
    const Image<float> dithered = session->picture(1.0 / 255.0);
    double sum = 0.0;
    double most = 0.0;
    for (std::size_t i = 0; i < plain.data().size(); ++i) {
        if (i % 4 == 3) continue;
        const double difference = static_cast<double>(dithered.data()[i]) - plain.data()[i];
        sum += difference;
        most = std::max(most, std::abs(difference));
    }
    EXPECT_LE(most, 0.5 / 255.0 + 1e-6);
    EXPECT_GT(most, 0.4 / 255.0);
    // Uniform over a step: deviation 1 / sqrt(12) of it.
    const double n = static_cast<double>(plain.data().size()) * 0.75;
    EXPECT_LT(std::abs(sum / n), 4.0 / 255.0 / std::sqrt(12.0 * n));
}

TEST(Effects, leave_a_picture_alone_at_strength_zero) {
    for (const std::string& effect : parameter::moduleNames("effects")) {
        scene::Scene scene = darkSphere({24, 16});
        setAll(scene, {{"environment.type", "gradient"}});
        const Image<float> before = rendered(scene)->picture();
        parameter::Node node(scene.catalogue().type("effect", ""));
        node.set("type", parameter::ModuleReference{effect, {}});
        if (node.schema().find("strength") == nullptr) continue;
        scene.effects.push_back(node);
        scene.effects[0].set("enabled", false);
        EXPECT_TRUE(identical(rendered(scene)->picture(), before)) << effect << " is off";
        scene.effects[0].set("enabled", true);
        EXPECT_FALSE(identical(rendered(scene)->picture(), before)) << effect << " is on";
        scene.effects[0].set("strength", 0.0);
        EXPECT_LT(largestDifference(rendered(scene)->picture(), before), 1e-6) << effect;
    }
}

TEST(Effects, bloom_spreads_light_but_makes_none) {
    scene::Scene scene = flat(0.4);
    setAll(scene, {{"post.effects", R"([{"type": "bloom", "strength": 0.8, "radius": 0.2}])"}});
    expectFlat(rendered(scene)->picture(), srgb(0.4), 2e-6);
}

TEST(Effects, bloom_around_a_bright_point_is_the_kernel_of_a_lens) {
    // A tiny ball in the dark, its own light everything there is.
    constexpr int kSize = 256;
    scene::Scene scene = darkSphere({kSize, kSize});
    scene.subject.set("formula", formulaOf("length(p) - 0.012", 2.0));
    setAll(scene, {{"subject.emission", "1"},
                   {"renderer.shadow", "none"},
                   {"renderer.ambient_occlusion", "none"},
                   {"output.samples", "1"},
                   {"post.effects", R"([{"type": "bloom", "strength": 1, "radius": 0.04}])"}});
    const auto session = rendered(scene);
    const Image<float> before = session->layers().radiance;
    double light = 0.0;
    glm::dvec2 middle(0.0);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            light += before.at(x, y)[0];
            middle += static_cast<double>(before.at(x, y)[0]) * glm::dvec2(x, y);
        }
    }
    ASSERT_GT(light, 0.0);
    middle /= light;
    // Exposed so that sRGB's curve is left below its clip.
    const double s = 0.04 * kSize;
    const double peak = light / (glm::pi<double>() * s * s);
    session->set("post.exposure", std::string_view(fmt::format("{}", std::log2(0.9 / peak))));
    const Image<float> after = session->picture();
    const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            const double r = glm::length(glm::dvec2(x, y) - middle) / s;
            const double expected = 0.9 / std::pow(1.0 + r * r, 2.0);
            // Gaussians an octave apart, each sampled on a grid of its own, follow the kernel to a third of it, over
            // the three decades that it falls here; at the border, where what is beyond is taken to be as the border
            // is, it is more by less than a thousandth of the peak.
            ASSERT_NEAR(linear(after.at(x, y)[0]), expected, 0.37 * expected + 0.0009) << x << "," << y;
        }
    }
}

TEST(Effects, vignette_is_the_cosine_to_the_fourth) {
    scene::Scene scene = flat(0.4);
    setAll(scene, {{"post.effects", R"([{"type": "vignette", "strength": 1}])"}});
    const Image<float> picture = rendered(scene)->picture();
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 24; ++x) {
            // A lens that sees 90 degrees from corner to corner: tangent 1 at the corners.
            const double tangent = std::hypot(x + 0.5 - 12.0, y + 0.5 - 8.0) / std::hypot(12.0, 8.0);
            const double cosine = std::cos(std::atan(tangent));
            ASSERT_NEAR(picture.at(x, y)[0], srgb(0.4 * std::pow(cosine, 4.0)), 2e-6) << x << "," << y;
        }
    }
}

TEST(Effects, run_in_the_order_of_the_scene) {
    scene::Scene scene = flat(0.4);
    setAll(scene, {{"post.effects", R"([{"type": "vignette", "strength": 1}, {"type": "bloom", "strength": 1}])"}});
    const Image<float> one = rendered(scene)->picture();
    setAll(scene, {{"post.effects", R"([{"type": "bloom", "strength": 1}, {"type": "vignette", "strength": 1}])"}});
    EXPECT_GT(largestDifference(one, rendered(scene)->picture()), 0.01);
    setAll(
        scene,
        {{"post.effects",
          R"([{"type": "vignette", "strength": 1}, {"type": "bloom", "enabled": false}, {"type": "bloom", "strength": 1}])"}});
    EXPECT_TRUE(identical(one, rendered(scene)->picture())) << "a disabled one does not count";
}

} // namespace
} // namespace apeiron::test
