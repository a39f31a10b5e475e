// The path integrator against closed forms, quadrature, the raymarch renderer, and itself by other ways of sampling.
// Shapes are exact distances. Statistical tests use fixed seeds: they pass or fail for good.

#include "gpu_support.hpp"

#include "render/environment_distribution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kAlbedo = 0.5;
constexpr const char* kTwoSpheres = "min(length(p) - 1.0, length(p - vec3(0.5, -0.9, 0.9)) - 0.4)";
/// A box with a square hole through it, seen into.
constexpr const char* kTunnel = "max(max(abs(p.x), max(abs(p.y), abs(p.z))) - 0.9, 0.5 - max(abs(p.x), abs(p.z)))";

/// darkSphere() by paths of Lambertian reflections.
scene::Scene pathScene(const std::string& distance, glm::ivec2 size = {40, 40}) {
    scene::Scene scene = darkSphere(size);
    scene.subject.set("formula", formulaOf(distance, 2.0));
    setAll(scene, {{"renderer.type", "pathtrace"}, {"renderer.brdf", "lambert"}});
    return scene;
}

/// Means of pixels, channel 1, and the variances of these; of those that no edge crosses, in which every sample hit.
struct Estimate {
    std::vector<double> pixels;
    std::vector<double> variances; ///< negative: a pixel that does not count
    double mean = 0.0;
    double variance = 0.0; ///< of the mean
};

Estimate estimate(const scene::Scene& scene) {
    const render::Accumulation a = rendered(scene)->accumulation();
    EXPECT_TRUE(allFinite(a.mean));
    Estimate e;
    double count = 0.0;
    for (std::size_t i = 0; i < a.mean.data().size(); i += 4) {
        const double n = a.mean.data()[i + 3];
        const double value = a.mean.data()[i + 1];
        // Stratified samples err less than independent ones, of which this is the variance.
        const double variance = n > 1.0 ? a.spread.data()[i + 1] / n / (n - 1.0) : 0.0;
        const bool counts = a.albedo.data()[i + 3] >= 1.0F;
        e.pixels.push_back(value);
        e.variances.push_back(counts ? variance : -1.0);
        if (!counts) continue;
        e.mean += value;
        e.variance += variance;
        count += 1.0;
    }
    EXPECT_GT(count, 100.0);
    e.mean /= count;
    e.variance /= count * count;
    return e;
}

/// Two estimates of the same picture, as a whole and in strips of 64 pixels: single pixels that a rare event misses
/// know nothing of their variance. The slack, a part of the mean, is for what is systematic.
void expectSame(const Estimate& a, const Estimate& b, double slack = 1e-4) {
    struct Sum {
        double difference = 0.0;
        double variance = 0.0;
        double count = 0.0;
    };
    Sum all;
    std::vector<Sum> strips(1);
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (a.variances[i] < 0.0 || b.variances[i] < 0.0) continue;
        if (strips.back().count >= 64.0) strips.emplace_back();
        for (Sum* sum : {&all, &strips.back()}) {
            sum->difference += a.pixels[i] - b.pixels[i];
            sum->variance += a.variances[i] + b.variances[i];
            sum->count += 1.0;
        }
    }
    EXPECT_LT(std::abs(all.difference), 4.0 * std::sqrt(all.variance) + slack * all.count * b.mean)
        << "off by " << all.difference / all.count / b.mean << ", noise "
        << std::sqrt(all.variance) / all.count / b.mean;
    double squares = 0.0;
    for (const Sum& strip : strips) {
        const double off = std::max(0.0, std::abs(strip.difference) - slack * strip.count * b.mean);
        squares += off * off / (strip.variance + 1e-12);
    }
    const auto n = static_cast<double>(strips.size());
    EXPECT_LT(squares / n, 1.0 + 4.0 * std::sqrt(2.0 / n)) << "strips differ by more than their noise";
}

TEST(PathFurnace, white_bodies_cannot_be_seen_whatever_their_shape) {
    // By sampling the reflection model alone, every path carries exactly the furnace's radiance, until it is cut.
    for (const char* shape : {"length(p) - 1.0", kTwoSpheres, kTunnel}) {
        scene::Scene scene = pathScene(shape);
        setAll(scene, {{"environment.color", "1,1,1"},
                       {"subject.color_a", "1,1,1"},
                       {"renderer.sampling", "brdf"},
                       {"renderer.bounces", "64"},
                       {"renderer.roulette", "64"},
                       {"output.samples", "4"}});
        const Image<float> radiance = rendered(scene)->layers().radiance;
        for (std::size_t i = 0; i < radiance.data().size(); ++i)
            ASSERT_NEAR(radiance.data()[i], 1.0F, 2e-5F) << shape << " at " << i / 4;
    }
}

TEST(PathFurnace, is_white_on_average_by_light_sampling_and_roulette_too) {
    for (const char* shape : {"length(p) - 1.0", kTunnel}) {
        for (const char* sampling : {"mis", "light", "brdf"}) {
            scene::Scene scene = pathScene(shape);
            setAll(scene, {{"environment.color", "1,1,1"},
                           {"subject.color_a", "1,1,1"},
                           {"renderer.bounces", "64"},
                           {"renderer.roulette", "1"},
                           {"output.samples", "32"}});
            scene.set("renderer.sampling", std::string_view(sampling));
            const Estimate e = estimate(scene);
            EXPECT_LT(std::abs(e.mean - 1.0), 4.0 * std::sqrt(e.variance) + 1e-5) << shape << " " << sampling;
        }
    }
}

TEST(PathFurnace, inside_a_glowing_sphere_light_is_a_geometric_series) {
    // Emission 0.5, albedo 0.5: every reflection adds half of the last one.
    scene::Scene scene = pathScene("1.0 - length(p)", {24, 24});
    setAll(scene, {{"camera.position", "0.2,-0.3,0.1"}, {"subject.emission", "1"}, {"renderer.roulette", "64"}});
    double sum = 0.5;
    double term = 0.5;
    for (int bounces = 1; bounces <= 12; ++bounces) {
        term *= kAlbedo;
        sum += term;
        if (bounces > 3 && bounces < 12) continue;
        scene.renderer.set("bounces", std::int64_t{bounces});
        const Image<float> radiance = rendered(scene)->layers().radiance;
        for (std::size_t i = 0; i < radiance.data().size(); i += 4)
            ASSERT_NEAR(radiance.data()[i], sum, 1e-5) << bounces << " bounces";
    }
    setAll(scene, {{"renderer.bounces", "64"}, {"renderer.roulette", "1"}, {"output.samples", "64"}});
    const Estimate e = estimate(scene);
    EXPECT_GT(e.variance, 0.0);
    EXPECT_LT(std::abs(e.mean - 0.5 / (1.0 - kAlbedo)), 4.0 * std::sqrt(e.variance));
}

class EverySampling : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Path, EverySampling, testing::Values("mis", "light", "brdf"),
                         [](const auto& instance) { return std::string(instance.param); });

/// Radiance of pixels against `truth` of their normal, where that is not negative. Normals know the place on the unit
/// sphere.
/// The slack is for what is systematic: samples of a pixel have normals of their own.
void expectTruth(const scene::Scene& scene, const std::function<double(const glm::dvec3&)>& truth,
                 double slack = 1e-3) {
    const auto session = rendered(scene);
    const render::Accumulation a = session->accumulation();
    double difference = 0.0;
    double variance = 0.0;
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < a.mean.data().size(); i += 4) {
        if (a.albedo.data()[i + 3] < 1.0F) continue;
        const double expected = truth(glm::normalize(rgb(a.normal.data().data() + i)));
        if (expected < 0.0) continue;
        const double n = a.mean.data()[i + 3];
        difference += a.mean.data()[i + 1] - expected;
        variance += a.spread.data()[i + 1] / n / (n - 1.0);
        sum += expected;
        ++count;
    }
    EXPECT_GT(count, 150);
    EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(variance) + slack * sum) << difference / sum << " of the truth";
}

TEST_P(EverySampling, irradiance_of_a_large_sun_is_that_of_its_centre) {
    // A disc of uniform radiance that is above the horizon as a whole lights as its centre does, whatever its size.
    scene::Scene scene = pathScene("length(p) - 1.0");
    setAll(scene, {{"lights", R"([{"type": "sun", "azimuth": 250, "elevation": 30, "color": [1, 1, 1], "intensity": 3,
                                   "size": 50}])"},
                   {"output.samples", "64"}});
    scene.set("renderer.sampling", std::string_view(GetParam()));
    const double a = glm::radians(250.0);
    const double e = glm::radians(30.0);
    const glm::dvec3 l(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    expectTruth(scene, [&](const glm::dvec3& n) {
        const double cosine = glm::dot(n, l);
        return cosine > std::sin(glm::radians(25.5)) ? kAlbedo / kPi * 3.0 * cosine : -1.0;
    });
}

TEST_P(EverySampling, irradiance_of_a_large_bulb_falls_with_the_square_of_its_distance) {
    // So does that of a sphere which is above the horizon as a whole.
    scene::Scene scene = pathScene("length(p) - 1.0");
    setAll(scene, {{"lights", R"([{"type": "point", "position": [0.5, -2.5, 1], "color": [1, 1, 1], "intensity": 7,
                                   "radius": 0.7}])"},
                   {"output.samples", "64"}});
    scene.set("renderer.sampling", std::string_view(GetParam()));
    expectTruth(scene, [&](const glm::dvec3& n) {
        const glm::dvec3 to = glm::dvec3(0.5, -2.5, 1.0) - n;
        const double cosine = glm::dot(n, glm::normalize(to));
        return cosine * glm::length(to) > 0.72 ? kAlbedo / kPi * 7.0 / glm::dot(to, to) * cosine : -1.0;
    });
}

TEST_P(EverySampling, lights_without_size_are_lights) {
    scene::Scene scene = pathScene("length(p) - 1.0");
    setAll(scene, {{"lights", R"([{"type": "sun", "azimuth": 250, "elevation": 30, "color": [1, 1, 1], "intensity": 3,
                                   "size": 0}])"},
                   {"output.samples", "2"}});
    scene.set("renderer.sampling", std::string_view(GetParam()));
    const double a = glm::radians(250.0);
    const double e = glm::radians(30.0);
    const glm::dvec3 l(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    expectTruth(
        scene, [&](const glm::dvec3& n) { return glm::dot(n, l) > 0.1 ? kAlbedo / kPi * 3.0 * glm::dot(n, l) : -1.0; });
}

TEST(PathFurnace, white_metal_gives_back_what_facets_throw_at_each_other) {
    // A single reflection by GGX facets sends back 84 to 92 % at a roughness of 0.5, 31 to 56 % at 1; the rest is
    // between facets.
    for (const char* roughness : {"0.5", "1"}) {
        scene::Scene scene = pathScene("length(p) - 1.0");
        setAll(scene, {{"environment.color", "1,1,1"},
                       {"subject.color_a", "1,1,1"},
                       {"subject.metalness", "1"},
                       {"renderer.brdf", "ggx"},
                       {"output.samples", "32"}});
        scene.set("subject.roughness", std::string_view(roughness));
        SCOPED_TRACE(roughness);
        // The fit of what is lost is off by up to 0.013.
        expectTruth(
            scene,
            [&](const glm::dvec3& n) {
                return glm::dot(n, glm::normalize(glm::dvec3(0, -4, 0) - n)) > 0.3 ? 1.0 : -1.0;
            },
            0.015);
    }
}

/// Everything that light can do, between two bodies.
scene::Scene playground(const char* brdf) {
    scene::Scene scene = pathScene(kTwoSpheres);
    setAll(scene, {{"environment.type", "gradient"},
                   {"subject.metalness", "0.5"},
                   {"subject.roughness", "0.4"},
                   {"subject.color_a", "0.8,0.8,0.8"},
                   {"lights", R"([{"type": "sun", "azimuth": -50, "elevation": 50, "color": [1, 1, 1], "intensity": 2,
                                   "size": 12},
                                  {"type": "point", "position": [-1, -1.5, 1], "color": [1, 1, 1], "intensity": 3,
                                   "radius": 0.3}])"},
                   {"output.samples", "48"}});
    scene.set("renderer.brdf", std::string_view(brdf));
    return scene;
}

TEST_P(EverySampling, has_the_same_mean_for_every_reflection_model) {
    for (const char* brdf : {"lambert", "phong", "ggx"}) {
        scene::Scene scene = playground(brdf);
        setAll(scene, {{"renderer.bounces", "4"}, {"output.seed", "1"}});
        const Estimate truth = estimate(scene);
        setAll(scene, {{"output.seed", "2"}});
        scene.set("renderer.sampling", std::string_view(GetParam()));
        SCOPED_TRACE(brdf);
        // Shadow rays and the path's own rays stop at slightly different distances from the surface.
        expectSame(estimate(scene), truth, 2e-3);
    }
}

TEST(Path, of_one_bounce_is_the_direct_light_of_raymarch) {
    for (const char* brdf : {"lambert", "phong", "ggx"}) {
        scene::Scene scene = playground(brdf);
        setAll(scene, {{"renderer.bounces", "1"}});
        // Raymarch knows the sky in glossy surfaces by approximation only.
        if (std::string(brdf) != "lambert") setAll(scene, {{"environment.intensity", "0"}});
        const Estimate paths = estimate(scene);
        setAll(scene, {{"renderer.type", "raymarch"},
                       {"renderer.shadow", "sampled"},
                       {"renderer.ambient_occlusion", "sampled"},
                       {"output.seed", "5"}});
        scene.set("renderer.brdf", std::string_view(brdf));
        SCOPED_TRACE(brdf);
        expectSame(paths, estimate(scene), 2e-3);
    }
}

TEST(Path, roulette_changes_noise_but_not_light) {
    scene::Scene scene = playground("ggx");
    scene.subject.set("formula", formulaOf(kTunnel, 2.0));
    setAll(scene, {{"renderer.bounces", "6"}, {"renderer.roulette", "64"}});
    const Estimate without = estimate(scene);
    setAll(scene, {{"renderer.roulette", "1"}, {"output.seed", "3"}});
    expectSame(estimate(scene), without);
}

TEST(Path, error_falls_at_least_with_the_root_of_the_samples) {
    scene::Scene scene = playground("ggx");
    setAll(scene, {{"renderer.bounces", "4"}, {"output.samples", "512"}, {"output.seed", "9"}});
    const Estimate truth = estimate(scene);
    std::vector<double> errors;
    for (const char* samples : {"4", "64"}) {
        setAll(scene, {{"output.samples", samples}, {"output.seed", "0"}});
        const Estimate e = estimate(scene);
        double squares = 0.0;
        double count = 0.0;
        for (std::size_t i = 0; i < e.pixels.size(); ++i) {
            if (e.variances[i] < 0.0 || truth.variances[i] < 0.0) continue;
            squares += (e.pixels[i] - truth.pixels[i]) * (e.pixels[i] - truth.pixels[i]);
            count += 1.0;
        }
        errors.push_back(std::sqrt(squares / count));
        RecordProperty(std::string("rmse_") + samples, std::to_string(errors.back() / truth.mean));
    }
    // 16 times the samples: a quarter of the error, and the reference's own error, sqrt(1/8) of the smaller one.
    EXPECT_LT(errors[1], 0.25 * 1.1 * errors[0]);
    EXPECT_LT(errors[1], 0.1 * truth.mean);
}

TEST(Path, combining_ways_of_sampling_is_better_than_the_worse_and_nearly_as_good_as_the_better) {
    // A mirror under a large sun is a matter of the reflection model, chalk under a small sun of the light (Veach &
    // Guibas 1995).
    for (const auto& [roughness, size, worse] : {std::tuple{"0.15", "40", "light"}, std::tuple{"0.7", "2", "brdf"}}) {
        scene::Scene scene = pathScene("length(p) - 1.0");
        setAll(scene, {{"renderer.brdf", "ggx"},
                       {"subject.metalness", "1"},
                       {"renderer.bounces", "1"},
                       {"output.samples", "64"}});
        scene.set("subject.roughness", std::string_view(roughness));
        scene.set("lights", std::string_view(fmt::format(R"([{{"type": "sun", "azimuth": 250, "elevation": 40,
            "color": [1, 1, 1], "intensity": 3, "size": {}}}])",
                                                         size)));
        const Estimate mis = estimate(scene);
        scene.set("renderer.sampling", std::string_view(worse));
        const Estimate one = estimate(scene);
        EXPECT_LT(mis.variance, 0.2 * one.variance) << worse;
        EXPECT_LT(std::abs(mis.mean - one.mean), 4.0 * std::sqrt(mis.variance + one.variance) + 1e-3 * mis.mean);
    }
}

TEST(Path, a_small_spot_in_the_environment_is_found_by_its_distribution) {
    // Radiance 1000 within 2 degrees of -y: an irradiance of 1000 pi sin^2 times the cosine, by closed form.
    scene::Scene scene = pathScene("length(p) - 1.0");
    scene.environment.set("type",
                          parameter::ModuleReference{"spot", "vec3 radiance(vec3 d) {\n"
                                                             "    return vec3(d.y < -0.99939083 ? 1000.0 : 0.0);\n"
                                                             "}\n"});
    setAll(scene, {{"output.samples", "64"}});
    const double sine = std::sin(glm::radians(2.0));
    expectTruth(scene, [&](const glm::dvec3& n) { return n.y < -0.1 ? kAlbedo * 1000.0 * sine * sine * -n.y : -1.0; });
    const double mis = estimate(scene).variance;
    setAll(scene, {{"renderer.sampling", "brdf"}});
    EXPECT_GT(estimate(scene).variance, 10.0 * mis);
}

TEST(Path, darkness_and_transparency_are_what_they_are) {
    scene::Scene scene = pathScene("length(p) - 1.0");
    setAll(scene, {{"environment.background", "transparent"}, {"output.samples", "2"}});
    const auto dark = rendered(scene)->layers();
    for (std::size_t i = 0; i < dark.radiance.data().size(); i += 4) {
        ASSERT_EQ(dark.radiance.data()[i], 0.0F);
        ASSERT_NEAR(dark.radiance.data()[i + 3], dark.albedo.data()[i + 3], 1e-6);
    }
    EXPECT_EQ(dark.radiance.at(0, 0)[3], 0.0F);
    EXPECT_EQ(dark.radiance.at(20, 20)[3], 1.0F);
}

TEST(Path, geometry_and_albedo_are_those_of_raymarch) {
    scene::Scene scene = playground("ggx");
    setAll(scene, {{"output.samples", "2"}, {"renderer.bounces", "1"}});
    const auto paths = rendered(scene)->layers();
    setAll(scene, {{"renderer.type", "raymarch"}});
    const auto direct = rendered(scene)->layers();
    // The same rays; the two kernels may round differently.
    EXPECT_LT(largestDifference(paths.geometry, direct.geometry), 1e-3);
    EXPECT_LT(largestDifference(paths.albedo, direct.albedo), 1e-6);
}

TEST(Path, limit_takes_light_only_from_reflections_of_reflections) {
    scene::Scene scene = playground("lambert");
    setAll(scene, {{"renderer.bounces", "1"}, {"output.samples", "8"}});
    const Image<float> direct = rendered(scene)->layers().radiance;
    setAll(scene, {{"renderer.limit", "0.001"}});
    EXPECT_TRUE(identical(rendered(scene)->layers().radiance, direct));
    setAll(scene, {{"renderer.bounces", "3"}});
    const Image<float> limited = rendered(scene)->layers().radiance;
    double most = 0.0;
    for (std::size_t i = 0; i < direct.data().size(); i += 4)
        most = std::max(most, static_cast<double>(limited.data()[i] - direct.data()[i]));
    // At the second surface and at the third: what one light sends there, and what the ray that leaves it meets.
    EXPECT_LT(most, 0.005);
    EXPECT_GT(most, 0.0);
}

// ------------------------------------------------------------------ parts

class EveryModel : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(BrdfSampling, EveryModel, testing::Values(0, 1, 2), [](const auto& instance) {
    return std::string(std::array{"lambert", "phong", "ggx"}[static_cast<std::size_t>(instance.param)]);
});

TEST_P(EveryModel, draws_directions_by_its_density_and_the_mean_is_the_integral) {
    const auto images = runText({"render/glsl/brdf.glsl", "render/glsl/random.glsl"},
                                fmt::format(R"(
const int model = {};
void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {{
    float nv = (float(pixel.x) + 0.5) / 8.0;
    Material m = Material(vec3(0.9, 0.5, 0.2), 0.3 + 0.7 * float(pixel.y & 3) / 3.0, 0.5 * float(pixel.y >> 2), vec3(0.0));
    vec3 n = normalize(vec3(0.3, -0.5, 0.7));
    mat3 frame = brdf_frame(n);
    vec3 v = frame * vec3(sqrt(1.0 - nv * nv), 0.0, nv);
    float gloss = brdf_gloss(model, m, n, v);
    const int steps = 192;
    float density = 0.0;
    float reflected = 0.0;
    for (int i = 0; i < steps; ++i) {{
        for (int k = 0; k < steps; ++k) {{
            float z = (float(i) + 0.5) / float(steps);
            // Steps are small about the mirrored direction, where lobes are narrow.
            float s = 2.0 * (float(k) + 0.5) / float(steps) - 1.0;
            float phi = 3.14159265 * (1.0 + s * s * s);
            vec3 l = frame * vec3(sqrt(1.0 - z * z) * vec2(cos(phi), sin(phi)), z);
            density += 3.0 * s * s * brdf_pdf(model, gloss, m, n, v, l);
            reflected += 3.0 * s * s * brdf_value(model, m, n, v, l).r;
        }}
    }}
    const int samples = 8192;
    float above = 0.0;
    float mean = 0.0;
    float squares = 0.0;
    for (int i = 0; i < samples; ++i) {{
        vec3 l = brdf_sample(model, gloss, m, n, v, random_pair(pixel + ivec2(8 * i, 0), 0u), random_pair(pixel + ivec2(8 * i, 0), 1u).x);
        float pdf = brdf_pdf(model, gloss, m, n, v, l);
        if (pdf <= 0.0) continue;
        float weight = brdf_value(model, m, n, v, l).r / pdf;
        above += 1.0;
        mean += weight;
        squares += weight * weight;
    }}
    float part = 6.2831853 / float(steps * steps);
    mean /= float(samples);
    float variance = (squares / float(samples) - mean * mean) / float(samples);
    a = vec4(density * part, above / float(samples), reflected * part, mean);
    b = vec4(variance, float(samples), 0.0, 0.0);
}}
)",
                                            GetParam()),
                                {8, 12}, 2);
    double squares = 0.0;
    for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
        const float* a = images[0].data().data() + i;
        const float* b = images[1].data().data() + i;
        const double part = a[1];
        // The sum over the hemisphere is good to 0.004 for lobes of roughness 0.3.
        EXPECT_NEAR(a[0], part, 5.0 * std::sqrt(part * (1.0 - part) / b[1]) + 4e-3) << "density at " << i / 4;
        EXPECT_NEAR(a[2], a[3], 5.0 * std::sqrt(b[0]) + 4e-3) << "reflected light at " << i / 4;
        EXPECT_LE(a[0], 1.004);
        squares += b[0];
    }
    if (GetParam() == 0) {
        EXPECT_LT(squares, 1e-5) << "a perfect match has no variance but by rounding";
    }
}

/// Sessions upload the environment's table; tests of it alone do it here.
std::vector<Image<float>> runOnTable(const Image<float>& power, const std::string& text, glm::ivec2 size,
                                     std::size_t outputs) {
    gpu::Texture table(context(), gpu::PixelFormat::RGBA32F, {power.width(), power.height()}, "table");
    table.upload(render::environmentTable(power));
    return runText({"render/glsl/environment_distribution.glsl", "render/glsl/random.glsl"}, text, size, outputs,
                   [&](gpu::Kernel& kernel) {
                       kernel.set("environment_cells", table.size());
                       kernel.set("environment_distribution", table);
                   });
}

Image<float> powerOf(const std::function<float(int, int)>& value) {
    Image<float> power(16, 8, 4);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 16; ++x)
            power.at(x, y)[0] = value(x, y);
    }
    return power;
}

TEST(EnvironmentDistribution, is_a_density_in_proportion_to_the_light) {
    const Image<float> power = powerOf([](int x, int y) { return static_cast<float>(x * y); });
    const std::vector<float> table = render::environmentTable(power);
    double sum = 0.0;
    for (std::size_t i = 0; i < table.size(); i += 4)
        sum += table[i + 1] * 4.0 * kPi / 128.0;
    EXPECT_NEAR(sum, 1.0, 1e-6);
    const double mean = 7.5 * 3.5;
    EXPECT_NEAR(table[3], mean, 1e-4);
    // 2 % go everywhere alike.
    EXPECT_NEAR(table[4 * (7 * 16 + 15) + 1] * 4.0 * kPi, 0.98 * 15.0 * 7.0 / mean + 0.02, 1e-4);
    EXPECT_NEAR(table[1] * 4.0 * kPi, 0.02, 1e-6);
    EXPECT_EQ(table[4 * 15], 1.0F) << "rows end at 1";
    EXPECT_EQ(table[table.size() - 2], 1.0F) << "columns end at 1";
}

TEST(EnvironmentDistribution, of_darkness_and_of_what_is_no_number_is_uniform) {
    for (const float value :
         {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const std::vector<float> table = render::environmentTable(powerOf([&](int, int) { return value; }));
        for (std::size_t i = 0; i < table.size(); i += 4) {
            ASSERT_NEAR(table[i + 1], 1.0 / (4.0 * kPi), 1e-7);
            ASSERT_EQ(table[i + 3], 0.0F);
        }
    }
}

TEST(EnvironmentDistribution, samples_follow_the_density) {
    const auto one = [](int x, int y) { return x == 11 && y == 2 ? 5.0F : 0.0F; };
    const auto many = [](int x, int y) { return static_cast<float>((x * 7 + y * 3) % 5) + (y == 6 ? 9.0F : 0.0F); };
    const auto none = [](int, int) { return 0.0F; };
    for (const auto& shape : std::vector<std::function<float(int, int)>>{one, many, none}) {
        const auto images = runOnTable(
            powerOf(shape),
            "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
            "    float pdf;\n"
            "    vec3 direction = environment_sample(random_pair(pixel, 0u), pdf);\n"
            "    a = vec4(direction, pdf);\n"
            "    b = vec4(vec2(environment_cell(direction)), environment_pdf(direction), environment_mean());\n"
            "}\n",
            {256, 256}, 2);
        const std::vector<float> table = render::environmentTable(powerOf(shape));
        std::vector<double> counts(128);
        int elsewhere = 0;
        for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
            const float* b = images[1].data().data() + i;
            const auto cell = static_cast<std::size_t>(b[1]) * 16 + static_cast<std::size_t>(b[0]);
            ++counts[cell];
            ASSERT_NEAR(glm::length(rgb(images[0].data().data() + i)), 1.0, 1e-5);
            elsewhere += images[0].data()[i + 3] != b[2];
        }
        // Rounding may put a direction on the far side of its cell's edge.
        EXPECT_LT(elsewhere, 20);
        double chi2 = 0.0;
        for (std::size_t cell = 0; cell < 128; ++cell) {
            const double expected = 65536.0 * table[4 * cell + 1] * 4.0 * kPi / 128.0;
            chi2 += (counts[cell] - expected) * (counts[cell] - expected) / expected;
        }
        EXPECT_LT(chi2, 127.0 + 5.0 * std::sqrt(2.0 * 127.0)); // 127 degrees of freedom
    }
}

} // namespace
} // namespace apeiron::test
