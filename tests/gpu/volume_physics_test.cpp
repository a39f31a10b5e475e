// Light in volumes against closed forms, quadrature, and itself by other ways of sampling. Seeds are fixed: statistical
// tests pass or fail for good. z-tests at 4 sigma: by chance, one in 16,000 fails.

#include "volume_support.hpp"

#include "volume/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSigmas = 4.0;
constexpr double kRounding = 2e-4; ///< of single precision and of the transfer function's texels, relative

void expectMean(const MeanOf& mean, double truth, const std::string& what) {
    const double sigma = std::sqrt(mean.variance);
    EXPECT_LT(std::abs(mean.value - truth), kSigmas * sigma + kRounding * truth)
        << what << ": " << mean.value << " instead of " << truth << ", sigma " << sigma;
}

void expectSame(const MeanOf& a, const MeanOf& b, const std::string& what) {
    const double sigma = std::sqrt(a.variance + b.variance);
    EXPECT_LT(std::abs(a.value - b.value), kSigmas * sigma + kRounding * b.value)
        << what << ": " << a.value << " and " << b.value << ", sigma " << sigma;
}

/// A box of 8 mm full of the same stuff; density is its optical depth.
scene::Scene slab(double depth, double color) {
    provide("slab", 8, [](glm::dvec3, int) { return 1.0; });
    scene::Scene scene = volumeScene("slab", 4.0);
    scene.set("subject.density", Json(depth));
    scene.set("subject.transfer", uniformTransfer(color));
    return scene;
}

/// Noise of many sizes, with holes.
void provideClumps() {
    provide("clumps", 32, [](glm::dvec3 p, int) {
        const double wave = std::sin(0.7 * p.x) + std::sin(0.9 * p.y + 1.0) + std::sin(0.8 * p.z + 0.5 * p.x);
        return std::clamp(0.4 * wave, 0.0, 1.0);
    });
}

scene::Scene clumps(double color) {
    provideClumps();
    scene::Scene scene = volumeScene("clumps", 40.0);
    scene.set("subject.density", Json(40.0));
    scene.set("subject.transfer", fmt::format(R"({{"window": "none", "space": "linear", "points": [
                  {{"value": 0.05, "color": [{0}, {0}, {0}], "opacity": 0}}, {{"value": 1, "color": [{0}, {0}, {0}], "opacity": 1}}]}})",
                                              color));
    return scene;
}

TEST(VolumePhysics, a_slab_lets_through_what_beer_and_lambert_say) {
    for (const double depth : {0.1, 1.0, 3.0}) {
        for (const char* renderer : {"eam", "mcs", "mcm"}) {
            scene::Scene scene = slab(depth, 0.0);
            setAll(scene, {{"renderer.type", renderer}, {"environment.color", "1,1,1"}});
            expectMean(meanOf(scene), std::exp(-depth), fmt::format("{} at depth {}", renderer, depth));
        }
    }
}

TEST(VolumePhysics, emission_and_absorption_does_not_depend_on_the_step) {
    for (const char* step : {"0.1", "1", "4"}) {
        scene::Scene scene = slab(2.0, 1.0);
        setAll(scene, {{"renderer.type", "eam"}, {"renderer.sky_light", "0"}, {"subject.emission", "1"}});
        scene.set("renderer.step", std::string_view(step));
        // The last step of a ray is cut by the box: that is a part of a step, not more.
        EXPECT_NEAR(meanOf(scene).value, 1.0 - std::exp(-2.0),
                    0.5 * 2.0 / 8.0 * std::stod(step) * std::exp(-2.0) + 1e-3)
            << step;
    }
}

TEST(VolumePhysics, lighting_one_place_of_a_ray_has_the_mean_of_lighting_all) {
    // Without shadows and light of the sky lao is eam, of which each sample lights but one place.
    for (const double density : {4.0, 60.0}) {
        scene::Scene scene = clumps(0.8);
        scene.set("subject.density", Json(density));
        scene.set("subject.transfer", R"({"window": "none", "space": "linear", "points": [
                  {"value": 0.05, "color": [0.1, 0.1, 0.1], "opacity": 0},
                  {"value": 1, "color": [0.9, 0.9, 0.9], "opacity": 1, "emission": 0.5}]})");
        scene.set("lights", Json::parse(R"([{"type": "sun", "elevation": 30, "azimuth": -60, "intensity": 3}])"));
        setAll(scene, {{"renderer.type", "eam"}, {"renderer.sky_light", "0"}, {"output.samples", "64"}});
        const MeanOf all = meanOf(scene);
        setAll(scene, {{"renderer.type", "lao"}, {"renderer.sky_light", "0"}, {"renderer.shadows", "false"}});
        EXPECT_GT(all.value, 0.05) << "nothing to be seen";
        expectSame(meanOf(scene), all, fmt::format("density {}", density));
    }
}

TEST(VolumePhysics, emission_of_a_slab_is_one_minus_its_transmittance) {
    scene::Scene scene = slab(1.5, 1.0);
    // Without light from elsewhere, and paths that end at once: what is scattered is lost.
    setAll(scene, {{"renderer.bounces", "1"}, {"subject.emission", "1"}, {"output.samples", "64"}});
    expectMean(meanOf(scene), 1.0 - std::exp(-1.5), "emission");
}

TEST(VolumePhysics, channels_add_their_extinctions) {
    provide(
        "two", 8, [](glm::dvec3, int channel) { return channel == 0 ? 0.25 : 0.5; }, 2);
    for (const char* renderer : {"eam", "mcm"}) {
        scene::Scene scene = volumeScene("two", 4.0);
        scene.set("subject.density", Json(2.0));
        scene.set("subject.transfer",
                  R"({"window": "none", "space": "linear", "points": [{"value": 0, "color": [0, 0, 0], "opacity": 0},
                     {"value": 1, "color": [0, 0, 0], "opacity": 1}]})");
        setAll(scene, {{"renderer.type", renderer}, {"environment.color", "1,1,1"}, {"output.samples", "64"}});
        expectMean(meanOf(scene), std::exp(-2.0 * 0.75), renderer);
    }
}

TEST(VolumePhysics, a_box_scatters_the_sun_once_as_its_closed_form_says) {
    // Light from straight above, seen from the side: the way down to a place is the same all along a ray.
    constexpr double kDepth = 2.0;
    constexpr double kSun = 3.0;
    for (const double g : {-0.8, 0.0, 0.8}) {
        scene::Scene scene = slab(kDepth, 0.7);
        scene.set("lights",
                  Json::parse(R"([{"type": "sun", "elevation": 90, "color": [1, 1, 1], "intensity": 3, "size": 0}])"));
        scene.set("subject.anisotropy", Json(g));
        setAll(scene, {{"renderer.type", "mcs"}, {"output.samples", "64"}});
        const double phase = (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g, 1.5)); // at a right angle
        // Mean over the picture, 4 mm about the middle: from 2 to 6 mm below the top.
        const double sigma = kDepth / 8.0;
        const double down = (std::exp(-2.0 * sigma) - std::exp(-6.0 * sigma)) / (4.0 * sigma);
        expectMean(meanOf(scene), 0.7 * phase * kSun * down * (1.0 - std::exp(-kDepth)), fmt::format("g {}", g));
    }
}

TEST(VolumePhysics, a_sphere_scatters_the_sun_once_as_quadrature_says) {
    // A sphere by a sharp step at its surface, in a field that is exact within a voxel of it.
    constexpr double kRadius = 11.0;
    provide("sphere", 32, [](glm::dvec3 p, int) { return std::clamp(kRadius - glm::length(p), -2.0, 2.0); });
    constexpr double kExtinction = 0.1; // [1/mm]
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.0, -std::cos(0.5), std::sin(0.5)));
    for (const double g : {-0.8, 0.0, 0.8}) {
        scene::Scene scene = volumeScene("sphere", 20.0);
        scene.set("subject.transfer", R"({"window": "none", "space": "linear", "points": [
            {"value": -0.001, "color": [1, 1, 1], "opacity": 0}, {"value": 0.001, "color": [1, 1, 1], "opacity": 1}]})");
        scene.set(
            "lights",
            Json::parse(fmt::format(
                R"([{{"type": "sun", "azimuth": 270, "elevation": {}, "color": [1, 1, 1], "intensity": 2, "size": 0}}])",
                glm::degrees(0.5))));
        scene.set("subject.density", Json(kExtinction * 32.0));
        scene.set("subject.anisotropy", Json(g));
        setAll(scene, {{"renderer.type", "mcs"}, {"output.samples", "64"}});
        // Light travels along -sun, then along -y to the camera.
        const double cosine = glm::dot(-sun, glm::dvec3(0.0, -1.0, 0.0));
        const double phase = (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
        constexpr int kLines = 120;
        constexpr int kSteps = 400;
        double sum = 0.0;
        for (int i = 0; i < kLines; ++i) {
            for (int j = 0; j < kLines; ++j) {
                const double x = 20.0 * ((i + 0.5) / kLines - 0.5);
                const double z = 20.0 * ((j + 0.5) / kLines - 0.5);
                const double half2 = kRadius * kRadius - x * x - z * z;
                if (half2 <= 0.0) continue;
                const double half = std::sqrt(half2);
                double line = 0.0;
                for (int k = 0; k < kSteps; ++k) {
                    const double s = 2.0 * half * (k + 0.5) / kSteps;
                    const glm::dvec3 p(x, s - half, z);
                    const double along = glm::dot(p, sun);
                    const double out = -along + std::sqrt(along * along + kRadius * kRadius - glm::dot(p, p));
                    line += std::exp(-kExtinction * (s + out));
                }
                sum += line * kExtinction * 2.0 * half / kSteps;
            }
        }
        // The trilinear field's surface is up to h²/8r inside the sphere: 0.01 mm, a thousandth of the radius.
        const MeanOf mean = meanOf(scene);
        const double truth = 2.0 * phase * sum / (kLines * kLines);
        EXPECT_LT(std::abs(mean.value - truth), kSigmas * std::sqrt(mean.variance) + 2e-3 * truth)
            << "g " << g << ": " << mean.value << " instead of " << truth;
    }
}

TEST(VolumeFurnace, a_white_volume_cannot_be_seen_in_a_white_world) {
    for (const char* sampling : {"mis", "light", "scattering"}) {
        for (const char* g : {"-0.8", "0", "0.8"}) {
            scene::Scene scene = clumps(1.0);
            setAll(scene, {{"environment.color", "1,1,1"},
                           {"renderer.bounces", "10000"},
                           {"renderer.roulette", "10000"},
                           {"output.samples", "8"}});
            scene.set("renderer.sampling", std::string_view(sampling));
            scene.set("subject.anisotropy", std::string_view(g));
            const MeanOf mean = meanOf(scene);
            EXPECT_LT(std::abs(mean.value - 1.0), 3.0 * std::sqrt(mean.variance) + 1e-3)
                << sampling << " g " << g << ": " << mean.value << ", sigma " << std::sqrt(mean.variance);
        }
    }
}

TEST(VolumeFurnace, paths_that_only_scatter_carry_exactly_the_worlds_light) {
    scene::Scene scene = clumps(1.0);
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"renderer.bounces", "10000"},
                   {"renderer.sampling", "scattering"},
                   {"output.samples", "2"}});
    const Image<float> radiance = rendered(scene)->layers().radiance;
    for (const float value : radiance.data())
        ASSERT_NEAR(value, 1.0F, 1e-5F);
}

TEST(VolumeScattering, more_scattering_is_never_darker_in_a_white_world) {
    scene::Scene scene = clumps(0.8);
    setAll(scene, {{"environment.color", "1,1,1"}, {"output.samples", "16"}});
    scene.set("renderer.type", "mcs");
    const MeanOf once = meanOf(scene);
    scene.set("renderer.type", "mcm");
    const MeanOf often = meanOf(scene);
    EXPECT_GT(often.value - once.value, kSigmas * std::sqrt(once.variance + often.variance));
    scene.set("renderer.bounces", "1");
    expectSame(meanOf(scene), once, "one collision");
}

TEST(VolumeScattering, all_ways_to_find_light_have_the_same_mean) {
    scene::Scene scene = clumps(0.8);
    // A lamp that paths meet by chance often enough, and an environment with a bright side.
    scene.set(
        "lights",
        Json::parse(
            R"([{"type": "sun", "elevation": 50, "azimuth": 200, "color": [1, 1, 1], "intensity": 3, "size": 40}])"));
    scene.set("environment.type", "gradient");
    setAll(scene, {{"environment.top", "6,6,6"},
                   {"environment.sharpness", "8"},
                   {"environment.bottom", "0,0,0"},
                   {"environment.horizon", "0.1,0.1,0.1"},
                   {"output.samples", "48"},
                   {"renderer.bounces", "16"},
                   {"subject.anisotropy", "0.3"}});
    const MeanOf both = meanOf(scene);
    scene.set("renderer.sampling", "light");
    expectSame(meanOf(scene), both, "lights alone");
    scene.set("renderer.sampling", "scattering");
    expectSame(meanOf(scene), both, "scattering alone");
    scene.set("renderer.sampling", "mis");
    scene.set("renderer.roulette", "0");
    expectSame(meanOf(scene), both, "early roulette");
}

TEST(VolumeScattering, borders_that_reflect_have_the_same_mean_by_all_ways_to_find_light) {
    scene::Scene scene = clumps(0.8);
    scene.set(
        "lights",
        Json::parse(
            R"([{"type": "sun", "elevation": 50, "azimuth": 200, "color": [1, 1, 1], "intensity": 3, "size": 40}])"));
    setAll(scene, {{"subject.surfaces", "10"}, {"output.samples", "48"}, {"renderer.bounces", "16"}});
    const MeanOf both = meanOf(scene);
    scene.set("renderer.sampling", "light");
    expectSame(meanOf(scene), both, "lights alone");
    scene.set("renderer.sampling", "scattering");
    expectSame(meanOf(scene), both, "scattering alone");
}

TEST(VolumeScattering, does_not_depend_on_the_size_of_bricks) {
    scene::Scene scene = clumps(0.8);
    setAll(scene, {{"environment.color", "1,1,1"}, {"output.samples", "32"}});
    const MeanOf eight = meanOf(scene);
    for (const char* side : {"4", "16", "32"}) {
        scene.set("subject.brick", std::string_view(side));
        expectSame(meanOf(scene), eight, fmt::format("bricks of {}", side));
    }
}

TEST(VolumeScattering, is_the_same_however_far_away_the_world_begins) {
    // The same volume, moved by kilometres: positions in the shader are relative to the camera.
    provideClumps();
    scene::Scene near = clumps(0.8);
    setAll(near, {{"environment.color", "1,1,1"}, {"output.samples", "8"}});
    volume::Volume moved = *provide("clumps", 32, [](glm::dvec3 p, int) {
        const double wave = std::sin(0.7 * p.x) + std::sin(0.9 * p.y + 1.0) + std::sin(0.8 * p.z + 0.5 * p.x);
        return std::clamp(0.4 * wave, 0.0, 1.0);
    });
    const MeanOf here = meanOf(near);
    moved.indexToWorld[3] += glm::dvec4(4e6, -2e6, 8e6, 0.0);
    volume::provideVolume("moved", std::make_shared<const volume::Volume>(moved));
    scene::Scene far = near;
    setAll(far, {{"subject.source", "moved"},
                 {"camera.position", "4000000,-2000100,8000000"},
                 {"camera.target", "4000000,-2000000,8000000"}});
    expectSame(meanOf(far), here, "moved");
}

/// Looking up into a haze that thins out, above a white floor: below it, paths would be lost in ever denser haze.
scene::Scene haze(const char* color) {
    scene::Scene scene = darkSphere({24, 24});
    scene.subject.set("formula", formulaOf("p.z", 1000.0));
    setAll(scene, {{"renderer.type", "pathtrace"},
                   {"renderer.haze", "true"},
                   {"renderer.haze_height", "2"},
                   {"renderer.haze_density", "0.2"},
                   {"renderer.haze_base", "3"},
                   {"renderer.haze_color", color},
                   {"environment.color", "1,1,1"},
                   {"camera.projection", "orthographic"},
                   {"camera.position", "0,0,4"},
                   {"camera.target", "3,0,8"},
                   {"output.samples", "64"}});
    return scene;
}

TEST(Haze, lets_through_what_the_integral_of_its_density_says) {
    // Extinction at the camera over the sine of the elevation, times the height of the scale.
    const double depth = 0.2 * std::exp(-0.5) * 2.0 / 0.8;
    expectMean(meanOf(haze("0,0,0")), std::exp(-depth), "black haze");
}

TEST(Haze, cannot_be_seen_when_it_is_white_in_a_white_world) {
    for (const char* sampling : {"mis", "light", "brdf"}) {
        scene::Scene scene = haze("1,1,1");
        setAll(scene, {{"subject.color_a", "1,1,1"},
                       {"renderer.bounces", "64"},
                       {"renderer.brdf", "lambert"},
                       {"output.samples", "16"}});
        scene.set("renderer.sampling", std::string_view(sampling));
        expectMean(meanOf(scene), 1.0, sampling);
    }
}

} // namespace
} // namespace apeiron::test
