// Depth of field as an effect: against the thin-lens formula, and against rays through a lens.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

void addEffect(scene::Scene& scene, const std::string& values) {
    const std::string list = fmt::format(R"([{{"type": "depth_of_field", {}}}])", values);
    scene.set("post.effects", std::string_view(list));
}

/// IEC 61966-2-1, backwards: the linear tone mapper's radiance.
double linear(float encoded) {
    const auto e = static_cast<double>(encoded);
    return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
}

TEST(DepthOfField, leaves_what_is_sharp_and_a_pinhole_alone) {
    scene::Scene scene = darkSphere({64, 36});
    // A wall with stripes, square to the view, in the plane of focus.
    scene.subject.set("formula", formulaOf("abs(p.y) - 0.1 - 0.05 * step(0.5, fract(3.0 * p.x))", 9.0));
    setAll(scene, {{"environment.type", "gradient"}, {"renderer.ambient_occlusion", "field"}});
    const Image<float> plain = rendered(scene)->picture();
    addEffect(scene, R"("aperture": 0)");
    EXPECT_LT(largestDifference(rendered(scene)->picture(), plain), 1e-6);
    addEffect(scene, R"("aperture": 0.1, "focus": 3.9)");
    // The stripes are 0.05 apart: circles of confusion far below a pixel, and a difference far below a step of 8 bits.
    EXPECT_LT(largestDifference(rendered(scene)->picture(), plain), 0.1 / 255.0);
}

TEST(DepthOfField, of_an_even_picture_is_the_same_picture) {
    scene::Scene scene = darkSphere({64, 36});
    scene.subject.set("formula", formulaOf("abs(p.y) - 0.1", 9.0));
    setAll(scene, {{"subject.emission", "0.8"}});
    const Image<float> plain = rendered(scene)->picture();
    addEffect(scene, R"("aperture": 0.5, "focus": 2, "largest": 0.2)");
    EXPECT_LT(largestDifference(rendered(scene)->picture(), plain), 2e-6);
}

TEST(DepthOfField, keeps_a_sharp_edge_in_front_of_a_blurred_background) {
    // A dark wall over the left half, sharp; far behind it, blurred, a bright one.
    scene::Scene scene = darkSphere({64, 64});
    scene.subject.set("formula", formulaOf("min(max(abs(p.y) - 0.1, p.x), abs(p.y - 30.0) - 0.1)", 80.0));
    setAll(scene, {{"environment.color", "0.6,0.6,0.6"}, {"renderer.fog", "0.02"}, {"renderer.fog_light", "color"}});
    setAll(scene, {{"renderer.fog_color", "0.9,0.9,0.9"}});
    const Image<float> plain = rendered(scene)->picture();
    addEffect(scene, R"("aperture": 0.2, "focus": 3.9, "largest": 0.1, "taps": 512)");
    const Image<float> blurred = rendered(scene)->picture();
    for (int y = 0; y < 64; ++y) {
        for (const int x : {20, 28, 30, 33, 36, 44})
            ASSERT_NEAR(blurred.at(x, y)[0], plain.at(x, y)[0], 0.01) << x << "," << y;
    }
}

TEST(DepthOfField, is_close_to_what_a_lens_sees) {
    // The edge of a bright wall in front of a dark one, out of focus: half of its light goes over the edge.
    scene::Scene scene = darkSphere({64, 64});
    scene.subject.set("formula", formulaOf("max(abs(p.y) - 0.1, p.x)", 9.0));
    setAll(scene, {{"subject.emission", "1.6"}, {"camera.focus", "6"}, {"output.samples", "64"}});
    setAll(scene, {{"camera.aperture", "0.4"}});
    const Image<float> lens = rendered(scene)->picture();
    setAll(scene, {{"camera.aperture", "0"}, {"output.samples", "16"}});
    addEffect(scene, R"("aperture": 0.4, "largest": 0.2, "taps": 1024)");
    const Image<float> effect = rendered(scene)->picture();
    double worst = 0.0;
    double widest = 0.0;
    for (int x = 0; x < 64; ++x) {
        double a = 0.0;
        double b = 0.0;
        for (int y = 24; y < 40; ++y) {
            a += linear(lens.at(x, y)[0]) / 16.0;
            b += linear(effect.at(x, y)[0]) / 16.0;
        }
        worst = std::max(worst, std::abs(a - b));
        if (a > 0.08 && a < 0.72) widest += 1.0;
    }
    EXPECT_GT(widest, 8.0) << "the edge is not blurred at all";
    // Of a radiance of 0.8. Behind the edge the effect cannot see, and it takes the wall's light there as whole.
    EXPECT_LT(worst, 0.16);
}

} // namespace
} // namespace apeiron::test
