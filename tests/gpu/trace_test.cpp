// What makes tracing faster must not change what is found: prepass, bounding sphere, over-relaxation.

#include "gpu_support.hpp"

#include "scene/camera.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::test {
namespace {

struct View {
    const char* name;
    std::vector<std::pair<const char*, const char*>> values;
};

void PrintTo(const View& view, std::ostream* out) {
    *out << view.name;
}

class EveryView : public testing::TestWithParam<View> {};
INSTANTIATE_TEST_SUITE_P(
    Camera, EveryView,
    testing::Values(View{"far", {{"camera.position", "[\"0\", \"-40\", \"3\"]"}, {"camera.fov", "5"}}},
                    View{"wide", {{"camera.position", "[\"0.3\", \"-1.6\", \"0.2\"]"}, {"camera.fov", "110"}}},
                    View{"near",
                         {{"camera.position", "[\"0.1\", \"-1.02\", \"0.1\"]"},
                          {"camera.target", "[\"1\", \"-1\", \"0\"]"}}},
                    View{"orthographic", {{"camera.projection", "orthographic"}}},
                    View{"lens", {{"camera.aperture", "0.3"}, {"camera.focus", "2.5"}}}),
    [](const auto& instance) { return std::string(instance.param.name); });

scene::Scene sceneOfView(const View& view) {
    scene::Scene scene = darkSphere({64, 48});
    scene.subject.set("formula", unitSphere());
    setAll(scene, {{"camera.filter", "gaussian"}, {"output.samples", "4"}});
    for (const auto& [path, value] : view.values)
        setAll(scene, {{path, value}});
    return scene;
}

TEST_P(EveryView, prepass_and_relaxation_change_nothing_that_is_seen) {
    scene::Scene slow = sceneOfView(GetParam());
    setAll(slow, {{"subject.prepass", "false"}, {"subject.relaxation", "1"}, {"subject.bounding", "false"}});
    const auto truth = rendered(slow)->layers();
    for (const auto& [prepass, relaxation] : {std::pair{"true", "1"}, {"false", "1.5"}, {"true", "1.3"}}) {
        scene::Scene fast = sceneOfView(GetParam());
        setAll(fast, {{"subject.prepass", prepass}, {"subject.relaxation", relaxation}});
        const auto found = rendered(fast)->layers();
        std::size_t different = 0;
        std::size_t hits = 0;
        for (std::size_t i = 0; i < truth.albedo.data().size(); i += 4) {
            const float share = truth.albedo.data()[i + 3];
            hits += share > 0.0F ? 1 : 0;
            // A ray that only touches the sphere may see it or not: one of the four samples at the rim.
            if (std::abs(found.albedo.data()[i + 3] - share) > 0.3F) ++different;
            if (share < 1.0F || found.albedo.data()[i + 3] < 1.0F) continue;
            // All stop within the hit threshold, a twentieth of a pixel, seen at a slant.
            const double t = truth.geometry.data()[i + 3];
            EXPECT_NEAR(found.geometry.data()[i + 3], t, 0.02 * t) << i / 4;
        }
        EXPECT_GT(hits, 64U) << "the sphere is in view";
        EXPECT_EQ(different, 0U) << "prepass " << prepass << ", relaxation " << relaxation;
    }
}

TEST_P(EveryView, rays_start_before_what_they_hit_and_not_much) {
    // Of every pixel's ray: where the prepass lets it start, and where it hits.
    scene::Scene scene = sceneOfView(GetParam());
    const char* text = R"(
#define kernel_main prepass_main
#include "render/glsl/prepass.glsl"
#undef kernel_main
void kernel_main(ivec2 pixel, out vec4 result) {
    Ray cone = prepass_cone(vec2(pixel / 8 * 8), 8.0);
    float start = surface_clear(cone);
    Ray ray = camera_sample(pixel);
    Hit hit;
    bool there = surface_trace(ray, hit);
    result = vec4(start, there ? hit.t : 0.0, 0.0, 1.0);
})";
    const auto picture =
        runOnScene(scene, text, {64, 48}, 1, [](gpu::Kernel& kernel) { kernel.set("random_sample", 3U); });
    std::size_t hits = 0;
    double saved = 0.0;
    for (std::size_t i = 0; i < picture[0].data().size(); i += 4) {
        const double start = picture[0].data()[i];
        const double hit = picture[0].data()[i + 1];
        if (hit == 0.0) continue;
        ++hits;
        ASSERT_LE(start, hit) << "pixel " << i / 4;
        saved += start / hit;
    }
    ASSERT_GT(hits, 0U);
    EXPECT_GT(saved / static_cast<double>(hits), 0.3) << "the prepass is of some use";
}

TEST(Trace, of_a_fractal_is_the_same_with_prepass_and_relaxation_but_for_a_few_pixels) {
    scene::Scene slow = darkSphere({96, 72});
    setAll(slow, {{"subject.formula", "mandelbulb"},
                  {"camera.position", "[\"1.3\", \"-2.2\", \"0.9\"]"},
                  {"subject.detail", "1"},
                  {"output.samples", "1"},
                  {"subject.prepass", "false"},
                  {"subject.relaxation", "1"}});
    const auto truth = rendered(slow)->layers();
    scene::Scene fast = slow;
    setAll(fast, {{"subject.prepass", "true"}, {"subject.relaxation", "1.3"}});
    const auto found = rendered(fast)->layers();
    std::size_t different = 0;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < truth.albedo.data().size(); i += 4) {
        const bool hit = truth.albedo.data()[i + 3] > 0.0F;
        hits += hit ? 1 : 0;
        const double t = truth.geometry.data()[i + 3];
        const double footprint = 2.0 * std::tan(0.5 * glm::radians(slow.camera.number("fov"))) / 72.0 * t;
        const bool same =
            hit == (found.albedo.data()[i + 3] > 0.0F) && std::abs(found.geometry.data()[i + 3] - t) <= 4.0 * footprint;
        different += same ? 0 : 1;
    }
    EXPECT_GT(hits, 1500U);
    // The estimate is no strict bound, and rays that graze the surface end in one place or another.
    EXPECT_LE(different, hits / 200);
}

TEST(Motion, never_passes_through_the_surface) {
    session::Session session(context(), darkSphere({16, 16}));
    scene::Camera beyond = session.camera();
    beyond.fly({0.0, 0.0, -8.0});
    // From (0, -4, 0) to (0, 4, 0) leads through the unit sphere.
    EXPECT_FALSE(session.moveCamera(beyond));
    const double left = session.distanceToSurface();
    EXPECT_GT(left, 0.0);
    EXPECT_LT(left, 0.5) << "it went as far as it could";
    for (int i = 0; i < 20; ++i) {
        beyond = session.camera();
        beyond.fly({0.0, 0.0, -8.0});
        session.moveCamera(beyond);
        EXPECT_GT(session.distanceToSurface(), 0.0) << i;
    }
    // Past the sphere the way is free.
    session::Session aside(context(), darkSphere({16, 16}));
    scene::Camera past = aside.camera();
    past.fly({1.5, 0.0, 0.0});
    EXPECT_TRUE(aside.moveCamera(past));
    past.fly({0.0, 0.0, -8.0});
    EXPECT_TRUE(aside.moveCamera(past));
    EXPECT_NEAR(aside.distanceToSurface(), std::hypot(1.5, 4.0) - 1.0, 1e-4);
}

TEST(Motion, is_as_fast_as_the_surface_is_far) {
    session::Session session(context(), darkSphere({16, 16}));
    // Straight at the sphere the distance falls as exp(-speed t), whatever the steps.
    for (int i = 0; i < 10; ++i)
        session.fly({0.0, 0.0, -2.0}, 1.5, 0.1);
    EXPECT_NEAR(session.distanceToSurface(), 3.0 * std::exp(-1.5), 0.002);
    session.fly({0.0, 0.0, -1.0}, 1.5, 30.0);
    EXPECT_GT(session.distanceToSurface(), 0.0);
}

/// Mean squared difference of two pictures' colours.
double difference2(const Image<float>& a, const Image<float>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i) {
        const double d = static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]);
        sum += i % 4 == 3 ? 0.0 : d * d;
    }
    return sum / (0.75 * static_cast<double>(a.data().size()));
}

/// A bulb with all of its detail, without random shading.
scene::Scene bulb() {
    return sceneOf(R"({"camera": {"filter": "box"}, "subject": {"formula": "mandelbulb"},
        "renderer": {"shadow": "penumbra", "ambient_occlusion": "field"},
        "environment": {"type": "gradient"}, "output": {"width": 160, "height": 90, "samples": 16}})");
}

scene::Camera turned(const session::Session& session, double degrees) {
    scene::Camera camera = session.camera();
    camera.orbit(glm::radians(degrees), 0.0);
    return camera;
}

TEST(Motion, shows_the_picture_before_from_the_new_place_at_once) {
    session::Session session(context(), bulb(), {.stage = {}, .specialise = true, .tilePixels = 0, .interleave = 8});
    finish(session);
    const Image<float> before = session.picture();
    session.setCamera(turned(session, 2.0));
    EXPECT_TRUE(session.step(0.0).changed);
    EXPECT_EQ(session.samples(), 0);
    const Image<float> moved = session.picture();
    scene::Scene there = session.scene();
    const Image<float> truth = rendered(there)->picture();
    const double error = difference2(moved, truth);
    // The picture before as it was is what one would see without.
    EXPECT_LT(error, 0.35 * difference2(before, truth));
    EXPECT_LT(10.0 * std::log10(error), -22.0);
    for (std::size_t i = 3; i < moved.data().size(); i += 4)
        ASSERT_EQ(moved.data()[i], 1.0F) << "no holes";
}

TEST(Motion, does_not_drift_however_long) {
    session::Session session(context(), bulb(), {.stage = {}, .specialise = true, .tilePixels = 0, .interleave = 8});
    finish(session);
    // Sixty moves of a third of a pixel and back, with hardly anything new: every pixel's point stays where it is.
    const Image<float> before = session.picture();
    for (int i = 0; i < 60; ++i) {
        session.setCamera(turned(session, i < 30 ? 0.15 : -0.15));
        session.step(0.0);
        session.picture();
    }
    EXPECT_LT(10.0 * std::log10(difference2(session.picture(), before)), -24.0);
}

TEST(Motion, renews_every_pixel_in_the_course_of_a_journey) {
    // Nothing but what is new: each short step begins where the one before ended.
    scene::Scene scene = darkSphere({40, 24});
    session::Session session(context(), scene, {.stage = {}, .specialise = true, .tilePixels = 20, .interleave = 4});
    finish(session);
    setAll(scene, {{"subject.color_a", "[0.9, 0.1, 0.1]"}});
    std::int64_t pixels = session.statistics().pixels;
    for (int i = 0; i < 3000 && session.statistics().pixels - pixels < 40 * 24; ++i) {
        session.setCamera(turned(session, 0.01));
        session.step(1e-4);
        session.step(1e-4);
        session.picture();
    }
    EXPECT_GE(session.statistics().pixels - pixels, 40 * 24) << "steps got somewhere";
}

TEST(Motion, leaves_nothing_in_a_finished_picture) {
    session::Session session(context(), bulb(), {.stage = {}, .specialise = true, .tilePixels = 0, .interleave = 4});
    session.step(0.05);
    session.setCamera(turned(session, 5.0));
    session.step(0.05);
    session.setCamera(turned(session, -3.0));
    finish(session);
    // The first of 16 samples was made without the prepass, so that some of its rays end elsewhere within the hit
    // threshold.
    const double error = difference2(session.picture(), rendered(session.scene())->picture());
    EXPECT_LT(10.0 * std::log10(error), -40.0);
    // The old picture's part would be seen.
    scene::Scene elsewhere = bulb();
    EXPECT_GT(difference2(session.picture(), rendered(elsewhere)->picture()), 20.0 * error);
}

TEST(Adaptive, leaves_out_what_is_good_enough_and_reaches_the_target) {
    // A sphere in a constant light: the background is known after two samples, the shadow's edge is not.
    scene::Scene scene = darkSphere({64, 64});
    setAll(scene, {{"environment", R"({"type": "constant", "color": [0.5, 0.5, 0.5]})"},
                   {"lights", R"([{"type": "sun", "size": 40, "intensity": 3}])"},
                   {"renderer.shadow", "sampled"},
                   {"renderer.ambient_occlusion", "sampled"},
                   {"output.samples", "2000"},
                   {"output.noise", "0.004"}});
    const auto session = rendered(scene);
    const render::Accumulation found = session->accumulation();
    EXPECT_LE(found.noise(), 0.004);
    EXPECT_LT(session->samples(), 2000);
    float least = 1e9F;
    float most = 0.0F;
    for (std::size_t i = 3; i < found.mean.data().size(); i += 4) {
        least = std::min(least, found.mean.data()[i]);
        most = std::max(most, found.mean.data()[i]);
    }
    EXPECT_GE(least, 16.0F) << "too few to know the variance";
    EXPECT_LT(least, 0.5F * most) << "the background needs no more";
    EXPECT_EQ(static_cast<std::int64_t>(most), session->samples());

    // The same picture as without, within its error: the mean over the picture by a z-test, 4 sigma.
    scene::Scene all = scene;
    setAll(all, {{"output.noise", "0"}, {"output.samples", "256"}, {"output.seed", "7"}});
    const render::Accumulation truth = rendered(all)->accumulation();
    const double sigma = truth.luminance() * 0.004 / std::sqrt(64.0 * 64.0) * std::sqrt(2.0);
    EXPECT_NEAR(found.luminance(), truth.luminance(), 4.0 * sigma + 1e-4 * truth.luminance());
}

} // namespace
} // namespace apeiron::test
