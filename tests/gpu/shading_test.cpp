// What the ray marcher adds to light on surfaces: occlusion, fog and glow.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kDistance = 4.0; // of darkSphere()'s camera from the sphere's centre

/// The direction of the ray through a pixel of darkSphere().
glm::dvec3 rayThrough(const scene::Scene& scene, double x, double y) {
    const auto width = static_cast<double>(scene.output.integer("width"));
    const auto height = static_cast<double>(scene.output.integer("height"));
    const double pixel = 2.0 * std::tan(glm::radians(scene.camera.number("fov")) / 2.0) / height;
    return glm::normalize(glm::dvec3((x - width / 2) * pixel, 1.0, (height / 2 - y) * pixel));
}

/// Visits every pixel's centre.
template <class F> void forEachPixel(const Image<float>& image, const F& visit) {
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            SCOPED_TRACE(testing::Message() << x << "," << y);
            visit(x, y);
            if (testing::Test::HasFatalFailure()) return;
        }
    }
}

scene::Scene sphereInLight() {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"environment.type", "gradient"}, {"renderer.ambient_occlusion", "field"}});
    return scene;
}

TEST(Fog, falls_with_the_power_three_quarters_of_the_distance) {
    scene::Scene scene = sphereInLight();
    const auto clear = rendered(scene)->layers();
    setAll(scene, {{"renderer.fog", "0.3"}, {"renderer.fog_light", "color"}, {"renderer.fog_color", "0.2,0.4,0.8"}});
    const auto foggy = rendered(scene)->layers();
    forEachPixel(clear.radiance, [&](int x, int y) {
        const bool hit = clear.albedo.at(x, y)[3] > 0.0F;
        const double left =
            hit ? std::exp(-0.3 * std::pow(static_cast<double>(clear.geometry.at(x, y)[3]), 0.75)) : 0.0;
        const glm::dvec3 truth = glm::mix(glm::dvec3(0.2, 0.4, 0.8), rgb(clear.radiance.at(x, y)), left);
        ASSERT_LT(glm::length(rgb(foggy.radiance.at(x, y)) - truth), 2e-6);
    });
}

TEST(Fog, lit_by_the_environment_leaves_the_environment_as_it_is) {
    scene::Scene scene = sphereInLight();
    const auto clear = rendered(scene)->layers();
    setAll(scene, {{"renderer.fog", "1e2"}});
    const auto foggy = rendered(scene)->layers();
    scene.subject.set("formula", formulaOf("length(p - vec3(0.0, -50.0, 0.0)) - 1.0", 60.0));
    const auto empty = rendered(scene)->layers();
    forEachPixel(clear.radiance, [&](int x, int y) {
        // Fog that dense shows nothing but the environment, through the sphere, too.
        ASSERT_LT(glm::length(rgb(foggy.radiance.at(x, y)) - rgb(empty.radiance.at(x, y))), 1e-6);
    });
    EXPECT_GT(largestDifference(clear.radiance, empty.radiance), 0.05);
}

TEST(Fog, leaves_a_transparent_background_transparent) {
    scene::Scene scene = sphereInLight();
    setAll(scene, {{"renderer.fog", "5"}, {"renderer.fog_light", "color"}, {"environment.background", "transparent"}});
    const auto layers = rendered(scene)->layers();
    EXPECT_EQ(rgb(layers.radiance.at(0, 0)), glm::dvec3(0.0));
    EXPECT_EQ(layers.radiance.at(0, 0)[3], 0.0F);
}

TEST(Glow, is_the_integral_of_the_haze_along_the_ray) {
    for (const double reach : {0.03, 0.2}) {
        scene::Scene scene = darkSphere();
        setAll(scene,
               {{"renderer.glow", "true"}, {"renderer.glow_strength", "1"}, {"renderer.glow_color", "1,0.5,0.25"}});
        scene.renderer.set("glow_reach", reach);
        const auto session = rendered(scene);
        const auto layers = session->layers();
        // The sample's place within its pixel: the first pair of random numbers, as the box filter uses it.
        const auto places = runOnScene(scene,
                                       "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                       "    a = vec4(vec2(pixel) + 0.5 + camera_jitter(pixel), 0.0, 1.0);\n"
                                       "}\n",
                                       {64, 64}, 1)[0];
        double largest = 0.0;
        forEachPixel(layers.radiance, [&](int x, int y) {
            const glm::dvec3 direction = rayThrough(scene, places.at(x, y)[0], places.at(x, y)[1]);
            const double end = layers.albedo.at(x, y)[3] > 0.0F ? layers.geometry.at(x, y)[3] : 12.0;
            constexpr int kSteps = 4000;
            double truth = 0.0;
            for (int i = 0; i < kSteps; ++i) {
                const double t = end * (i + 0.5) / kSteps;
                const double d = glm::length(glm::dvec3(0, -kDistance, 0) + t * direction) - 1.0;
                truth += std::exp(-std::max(d, 0.0) / reach) * end / kSteps / reach;
            }
            largest = std::max(largest, truth);
            // Where a ray grazes the sphere the distance is not linear within a step of a quarter of the reach.
            ASSERT_NEAR(layers.radiance.at(x, y)[0], truth, 0.02 * truth + 2e-3) << "reach " << reach;
            ASSERT_NEAR(layers.radiance.at(x, y)[1], 0.5 * layers.radiance.at(x, y)[0], 1e-5);
        });
        EXPECT_GT(largest, 2.0) << "rays that graze the sphere stay in the haze";
    }
}

constexpr const char* kTwoSpheres = "min(length(p) - 1.0, length(p - vec3(0.5, -0.9, 0.9)) - 0.4)";

/// Mean variance of a pixel's samples, and the mean radiance with its variance.
struct Statistics {
    double variance = 0.0;
    double mean = 0.0;
    double meanVariance = 0.0;
};

Statistics statisticsOf(const char* rays, int samples) {
    scene::Scene scene = darkSphere({32, 32});
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"camera.fov", "20"}, // nothing but sphere: silhouettes would be noise of another kind
                   {"renderer.ambient_occlusion", "sampled"},
                   {"renderer.occlusion_rays", rays}});
    scene.output.set("samples", std::int64_t{samples});
    const auto accumulation = rendered(scene)->accumulation();
    Statistics statistics;
    const double pixels = 32.0 * 32.0;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            const double variance = static_cast<double>(accumulation.spread.at(x, y)[0]) / (samples - 1);
            statistics.variance += variance / pixels;
            statistics.mean += static_cast<double>(accumulation.mean.at(x, y)[0]) / pixels;
            statistics.meanVariance += variance / samples / pixels / pixels;
        }
    }
    return statistics;
}

TEST(SampledOcclusion, with_more_rays_has_the_same_mean_and_less_noise) {
    const Statistics one = statisticsOf("1", 64);
    const Statistics many = statisticsOf("16", 8);
    // Independent rays would have a sixteenth of the variance; rays that are spread evenly have less.
    EXPECT_LT(many.variance, one.variance / 16.0);
    EXPECT_LT(std::abs(many.mean - one.mean), 4.0 * std::sqrt(many.meanVariance + one.meanVariance)) << "biased";
}

TEST(StepOcclusion, falls_exponentially_with_the_effort_and_its_strength) {
    scene::Scene scene = sphereInLight();
    setAll(scene, {{"renderer.ambient_occlusion", "none"}, {"subject.max_steps", "60"}});
    const auto open = rendered(scene)->layers();
    const auto effort = runOnScene(scene,
                                   "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                   "    Hit hit;\n"
                                   "    surface_trace(camera_ray(vec2(pixel) + 0.5 + camera_jitter(pixel)), hit);\n"
                                   "    a = vec4(hit.effort);\n"
                                   "}\n",
                                   {64, 64}, 1)[0];
    for (const double strength : {0.0, 1.0, 2.5}) {
        setAll(scene, {{"renderer.ambient_occlusion", "steps"}});
        scene.renderer.set("occlusion_strength", strength);
        const auto layers = rendered(scene)->layers();
        double darkest = 1.0;
        forEachPixel(layers.radiance, [&](int x, int y) {
            if (layers.albedo.at(x, y)[3] == 0.0F) return;
            const double factor = std::exp(-8.0 * effort.at(x, y)[0] * strength);
            const double truth = open.radiance.at(x, y)[1] * factor;
            darkest = std::min(darkest, factor);
            ASSERT_NEAR(layers.radiance.at(x, y)[1], truth, 1e-5) << strength;
        });
        EXPECT_LT(darkest, strength > 0.0 ? 0.5 : 1.1) << "rays that graze the sphere take many steps";
    }
}

TEST(FieldOcclusion, has_a_strength) {
    scene::Scene scene = darkSphere();
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    setAll(scene, {{"environment.color", "1,1,1"}, {"renderer.ambient_occlusion", "field"}});
    const auto one = rendered(scene)->layers();
    setAll(scene, {{"renderer.occlusion_strength", "2"}});
    const auto two = rendered(scene)->layers();
    forEachPixel(one.radiance, [&](int x, int y) {
        if (one.albedo.at(x, y)[3] == 0.0F) return;
        // Of a white environment, albedo 0.5 sends half back, times the openness; the harmonics are exact to 1e-3.
        const double openness = 2.0 * one.radiance.at(x, y)[0];
        ASSERT_NEAR(two.radiance.at(x, y)[0], 0.5 * openness * openness, 2e-3);
    });
}

} // namespace
} // namespace apeiron::test
