// Pictures whose truth is known: spheres under simple light. Shapes are exact distances, so that nothing but the engine
// can be wrong.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kAlbedo = 0.5;   // of darkSphere()
constexpr double kDistance = 4.0; // of its camera from the sphere's centre
constexpr double kDetail = 0.05;  // its hit threshold [px]

/// Height of a pixel of darkSphere() at distance 1.
double pixelSize(const scene::Scene& scene) {
    return 2.0 * std::tan(glm::radians(scene.camera.number("fov")) / 2.0) /
           static_cast<double>(scene.output.integer("height"));
}

/// Area in pixels of the image of a sphere of that radius, whose centre is `distance` away and `beta` off the axis: the
/// ellipse in which a plane cuts the cone of tangents.
double imageArea(double radius, double distance, double beta, double pixel) {
    const double s = radius / distance;
    const double c = std::sqrt(1.0 - s * s);
    const double q = std::cos(beta) * std::cos(beta) - s * s;
    return kPi * (s * c / q) * (s / std::sqrt(q)) / (pixel * pixel);
}

double sumOfAlpha(const Image<float>& image) {
    double sum = 0.0;
    for (std::size_t i = 3; i < image.data().size(); i += 4)
        sum += static_cast<double>(image.data()[i]);
    return sum;
}

/// A silhouette is as large as it is true, or larger by up to `detail` pixels all around: rays that come that close
/// have hit. Stratified samples err by some 0.06 of each pixel on the edge; those errors are independent.
void expectArea(double area, double truth, double detail) {
    const double rim = 2.0 * std::sqrt(kPi * truth);
    const double noise = 5.0 * 0.06 * std::sqrt(rim);
    EXPECT_GE(area, truth - noise);
    EXPECT_LE(area, truth + 1.15 * detail * rim + noise); // 1.15: pixels cover less of a sphere off the axis
}

scene::Scene silhouette(double detail) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"environment.background", "transparent"}, {"output.samples", "16"}});
    scene.subject.set("detail", detail);
    return scene;
}

TEST(Silhouette, has_the_area_of_the_projected_sphere) {
    const scene::Scene scene = silhouette(kDetail);
    const double area = sumOfAlpha(rendered(scene)->layers().radiance);
    expectArea(area, imageArea(1.0, kDistance, 0.0, pixelSize(scene)), kDetail);
}

TEST(Silhouette, off_the_axis_is_the_ellipse_of_a_perspective) {
    scene::Scene scene = silhouette(kDetail);
    setAll(scene, {{"camera.fov", "70"}, {"camera.target", "1.3,0,0.7"}});
    const glm::dvec3 forward = glm::normalize(glm::dvec3(1.3, 4.0, 0.7));
    const double beta = std::acos(glm::dot(forward, glm::dvec3(0, 1, 0)));
    const double area = sumOfAlpha(rendered(scene)->layers().radiance);
    const double truth = imageArea(1.0, kDistance, beta, pixelSize(scene));
    EXPECT_GT(truth, 1.15 * imageArea(1.0, kDistance, 0.0, pixelSize(scene))) << "the test would not see a difference";
    expectArea(area, truth, kDetail);
}

TEST(Silhouette, of_a_parallel_projection_does_not_depend_on_the_distance) {
    scene::Scene scene = silhouette(kDetail);
    setAll(scene, {{"camera.projection", "orthographic"}});
    const double pixel = kDistance * pixelSize(scene);
    expectArea(sumOfAlpha(rendered(scene)->layers().radiance), kPi / (pixel * pixel), kDetail);
}

TEST(Silhouette, is_wider_than_the_truth_by_at_most_the_detail) {
    const scene::Scene scene = silhouette(1.0);
    expectArea(sumOfAlpha(rendered(scene)->layers().radiance), imageArea(1.0, kDistance, 0.0, pixelSize(scene)), 1.0);
}

TEST(Coverage, is_the_part_of_the_samples_that_hit) {
    scene::Scene scene = silhouette(kDetail);
    setAll(scene, {{"environment.color", "3,3,3"}});
    const auto session = rendered(scene);
    const auto layers = session->layers();
    const Image<float> picture = session->picture();
    int partial = 0;
    for (std::size_t i = 0; i < layers.radiance.data().size(); i += 4) {
        const float alpha = layers.radiance.data()[i + 3];
        EXPECT_NEAR(alpha, layers.albedo.data()[i + 3], 1e-6);
        EXPECT_NEAR(picture.data()[i + 3], alpha, 1e-6);
        // Premultiplied: the environment that is not shown adds no light, what is seen is lit by it.
        EXPECT_NEAR(layers.radiance.data()[i], alpha * 3.0F * static_cast<float>(kAlbedo), 2e-3F);
        partial += alpha > 0.0F && alpha < 1.0F;
    }
    EXPECT_GT(partial, 50) << "edges";
    EXPECT_EQ(layers.radiance.at(0, 0)[3], 0.0F);
    EXPECT_EQ(layers.radiance.at(32, 32)[3], 1.0F);
    setAll(scene, {{"environment.background", "environment"}});
    EXPECT_THAT(rendered(scene)->layers().radiance.at(0, 0)[3], 1.0F);
}

TEST(Picture, has_up_at_the_top_and_right_at_the_right) {
    scene::Scene scene = silhouette(kDetail);
    scene.subject.set("formula", formulaOf("length(p - vec3(0.8, 0.0, 0.5)) - 0.2", 2.0));
    const Image<float> image = rendered(scene)->layers().radiance;
    glm::dvec2 centre(0.0);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            centre += static_cast<double>(image.at(x, y)[3]) * (glm::dvec2(x, y) + 0.5);
        }
    }
    centre /= sumOfAlpha(image);
    const double scale = 1.0 / (kDistance * pixelSize(scene));
    // A sphere's image lies a little further out than that of its centre: half a pixel is enough to tell.
    EXPECT_NEAR(centre.x, 32.0 + 0.8 * scale, 0.5);
    EXPECT_NEAR(centre.y, 32.0 - 0.5 * scale, 0.5);
}

TEST(SurfaceTrace, finds_spheres_where_they_are_and_misses_what_is_not_there) {
    for (const double detail : {kDetail, 1.0}) {
        scene::Scene scene = darkSphere();
        scene.subject.set("detail", detail);
        const auto images = runOnScene(scene,
                                       "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                                       "    Ray ray = camera_ray(vec2(pixel) + 0.5);\n"
                                       "    Hit hit;\n"
                                       "    bool found = surface_trace(ray, hit);\n"
                                       "    vec3 n = found ? surface_normal(hit, ray.direction) : vec3(0.0);\n"
                                       "    a = vec4(ray.direction, found ? hit.t : -1.0);\n"
                                       "    b = vec4(n, found ? hit.footprint : 0.0);\n"
                                       "}\n",
                                       {64, 64}, 2);
        const glm::dvec3 eye(0, -kDistance, 0);
        double worst = 0.0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                SCOPED_TRACE(testing::Message() << x << "," << y);
                const glm::dvec3 direction = rgb(images[0].at(x, y));
                const double size = 2.0 * std::tan(glm::radians(20.0));
                const glm::dvec3 truth =
                    glm::normalize(glm::dvec3((x + 0.5 - 32) / 64 * size, 1.0, (32 - y - 0.5) / 64 * size));
                ASSERT_LT(glm::length(direction - truth), 2e-7);
                const double along = -glm::dot(eye, truth);
                const double aside = glm::length(eye + along * truth);
                const double threshold = detail * pixelSize(scene) * kDistance;
                const double t = images[0].at(x, y)[3];
                if (aside < 1.0) {
                    ASSERT_GT(t, 0.0);
                }
                if (aside > 1.0 + threshold) {
                    ASSERT_LT(t, 0.0);
                }
                if (t < 0.0) continue;
                const glm::dvec3 point = eye + t * truth;
                // Never inside by more than rounding (coordinates up to 4), never further off than the threshold.
                ASSERT_GT(glm::length(point), 1.0 - 1e-6);
                ASSERT_LT(glm::length(point), 1.0 + threshold);
                ASSERT_NEAR(images[1].at(x, y)[3], detail * pixelSize(scene) * t, 1e-6);
                const glm::dvec3 n = rgb(images[1].at(x, y));
                ASSERT_NEAR(glm::length(n), 1.0, 1e-6);
                worst = std::max(worst, std::acos(std::min(glm::dot(n, glm::normalize(point)), 1.0)));
            }
        }
        // Four distances, each rounded to 2.4e-7 (positions are up to 4 large), over half a footprint h; and the
        // curvature 1 of the sphere, which four taps feel over about half of h.
        const double h = 0.5 * detail * pixelSize(scene) * 3.0;
        EXPECT_LT(worst, 4.0 * 2.4e-7 / h + 0.7 * h) << "normals [rad]";
    }
}

TEST(Sun, lights_lambertian_surfaces_by_the_cosine) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"lights", R"([{"type": "sun", "azimuth": 200, "elevation": 30, "color": [1, 0.5, 0.25],
                                   "intensity": 3, "size": 0}])"}});
    const glm::dvec3 l(std::cos(glm::radians(30.0)) * std::cos(glm::radians(200.0)),
                       std::cos(glm::radians(30.0)) * std::sin(glm::radians(200.0)), std::sin(glm::radians(30.0)));
    const auto layers = rendered(scene)->layers();
    int lit = 0;
    int dark = 0;
    int terminator = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (layers.albedo.at(x, y)[3] == 0.0F) continue;
            const double cosine = glm::dot(rgb(layers.geometry.at(x, y)), l);
            const glm::dvec3 expected = kAlbedo / kPi * 3.0 * std::max(cosine, 0.0) * glm::dvec3(1, 0.5, 0.25);
            // The one sample's own normal: nothing but float rounding is left.
            ASSERT_LT(glm::length(rgb(layers.radiance.at(x, y)) - expected), 1e-6) << x << "," << y;
            lit += cosine > 0.05;
            dark += cosine < -0.05;
            terminator += std::abs(cosine) <= 0.05;
        }
    }
    EXPECT_GT(lit, 200);
    EXPECT_GT(dark, 200);
    EXPECT_GT(terminator, 20);
}

TEST(PointLight, falls_with_the_square_of_the_distance) {
    for (const char* place : {"0,-2,1", "0,-5,3", "-20,-30,10"}) {
        scene::Scene scene = darkSphere();
        scene.set("lights",
                  std::string_view(fmt::format(
                      R"([{{"type": "point", "position": [{}], "color": [1, 1, 1], "intensity": 7}}])", place)));
        const auto& position = scene.lights[0].get<parameter::Decimal3>("position");
        const glm::dvec3 light(position[0].toDouble(), position[1].toDouble(), position[2].toDouble());
        const auto layers = rendered(scene)->layers();
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                if (layers.albedo.at(x, y)[3] == 0.0F) continue;
                const glm::dvec3 n = rgb(layers.geometry.at(x, y)); // and the point: the sphere is the unit sphere
                const glm::dvec3 to = light - n;
                const double cosine = std::max(glm::dot(n, glm::normalize(to)), 0.0);
                const double expected = kAlbedo / kPi * 7.0 / glm::dot(to, to) * cosine;
                // The point found is up to the hit threshold, 2e-3, nearer to a light that is at least 1.2 away.
                ASSERT_NEAR(layers.radiance.at(x, y)[0], expected, 5e-3 * 7.0 * kAlbedo / kPi / glm::dot(to, to))
                    << x << "," << y << " " << place;
            }
        }
    }
}

class EveryOcclusion : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Environment, EveryOcclusion, testing::Values("none", "field", "sampled"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(EveryOcclusion, a_convex_white_body_in_a_furnace_cannot_be_seen) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"subject.color_a", "1,1,1"},
                   {"renderer.ambient_occlusion", GetParam()},
                   {"output.samples", "4"}});
    for (const char* detail : {"0.05", "1"}) {
        scene.set("subject.detail", std::string_view(detail));
        const Image<float> radiance = rendered(scene)->layers().radiance;
        double sum = 0.0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                // A sphere blocks no light of its own: every sample is 1. The irradiance comes from 1,024 directions.
                ASSERT_NEAR(radiance.at(x, y)[1], 1.0, 2e-3) << x << "," << y << " detail " << detail;
                sum += radiance.at(x, y)[1];
            }
        }
        EXPECT_NEAR(sum / 4096.0, 1.0, 5e-4);
    }
}

TEST(Environment, turns_around_z_with_its_rotation) {
    scene::Scene scene = darkSphere();
    scene.environment.set("type", parameter::ModuleReference{
                                      "axes", "vec3 radiance(vec3 direction) { return 0.5 + 0.5 * direction; }\n"});
    setAll(scene, {{"environment.rotation", "90"}, {"environment.intensity", "2"}});
    const auto images = runOnScene(scene,
                                   "void kernel_main(ivec2 pixel, out vec4 a) {\n"
                                   "    vec3 d[3] = vec3[3](vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));\n"
                                   "    a = vec4(environment_at(d[pixel.x]), 1.0);\n"
                                   "}\n",
                                   {3, 1}, 1);
    // What stood at +x now stands at +y.
    EXPECT_LT(glm::length(rgb(images[0].at(1, 0)) - glm::dvec3(2, 1, 1)), 1e-6);
    EXPECT_LT(glm::length(rgb(images[0].at(0, 0)) - glm::dvec3(1, 0, 1)), 1e-6);
    EXPECT_LT(glm::length(rgb(images[0].at(2, 0)) - glm::dvec3(1, 1, 2)), 1e-6);
}

/// environments/gradient.glsl with its default values, by its documentation.
glm::dvec3 gradient(const glm::dvec3& direction) {
    const double h = std::clamp(direction.z, -1.0, 1.0);
    const glm::dvec3 horizon(0.85, 0.85, 0.9);
    return glm::mix(horizon, h > 0.0 ? glm::dvec3(0.35, 0.45, 0.65) : glm::dvec3(0.12, 0.11, 0.1), std::abs(h));
}

/// Integral of radiance times cosine over the hemisphere about n.
glm::dvec3 irradiance(const glm::dvec3& n) {
    const glm::dvec3 helper = std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, n));
    const glm::dvec3 y = glm::cross(n, x);
    constexpr int kSteps = 48;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < kSteps; ++i) {
        // Equal steps of the squared sine are equal parts of the cosine-weighted hemisphere.
        const double r = std::sqrt((i + 0.5) / kSteps);
        for (int k = 0; k < 2 * kSteps; ++k) {
            const double phi = kPi * (k + 0.5) / kSteps;
            sum += gradient(r * std::cos(phi) * x + r * std::sin(phi) * y + std::sqrt(1.0 - r * r) * n);
        }
    }
    return sum * (kPi / (2.0 * kSteps * kSteps));
}

TEST(Environment, irradiance_of_a_gradient_is_its_integral) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"environment.type", "gradient"}});
    const auto layers = rendered(scene)->layers();
    for (int y = 4; y < 64; y += 7) {
        for (int x = 4; x < 64; x += 7) {
            if (layers.albedo.at(x, y)[3] == 0.0F) continue;
            const glm::dvec3 expected = kAlbedo / kPi * irradiance(rgb(layers.geometry.at(x, y)));
            const glm::dvec3 difference = rgb(layers.radiance.at(x, y)) - expected;
            // Harmonics up to degree 2 leave out about 1 % of what a cosine keeps (Ramamoorthi & Hanrahan 2001).
            ASSERT_LT(glm::length(difference), 0.015 * glm::length(expected)) << x << "," << y;
        }
    }
}

TEST(Environment, irradiance_of_a_quadratic_is_exact) {
    // Harmonics up to degree 2 hold it all; a cosine keeps 2/3 of degree 1 and 1/4 of degree 2 (Ramamoorthi & Hanrahan
    // 2001).
    scene::Scene scene = darkSphere();
    scene.environment.set("type", parameter::ModuleReference{"quadratic", R"(vec3 radiance(vec3 d) {
    return vec3(1.0 + 0.9 * d.z, 1.0 + 0.9 * d.x - 0.4 * d.y, 1.0 + d.x * d.y + 0.8 * d.y * d.z + 0.2 * (3.0 * d.z * d.z - 1.0) +
                                                                 0.5 * d.x * d.z + 0.3 * (d.x * d.x - d.y * d.y));
}
)"});
    const auto layers = rendered(scene)->layers();
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (layers.albedo.at(x, y)[3] == 0.0F) continue;
            const glm::dvec3 n = rgb(layers.geometry.at(x, y));
            const glm::dvec3 expected(1.0 + 0.6 * n.z, 1.0 + 0.6 * n.x - 0.8 / 3.0 * n.y,
                                      1.0 + 0.25 * (n.x * n.y + 0.8 * n.y * n.z + 0.2 * (3.0 * n.z * n.z - 1.0) +
                                                    0.5 * n.x * n.z + 0.3 * (n.x * n.x - n.y * n.y)));
            // The projection is a sum over 1,024 directions.
            ASSERT_LT(glm::length(rgb(layers.radiance.at(x, y)) - kAlbedo * expected), 2e-3) << x << "," << y;
        }
    }
}

TEST(Environment, sampled_light_has_the_integral_as_its_mean) {
    scene::Scene scene = darkSphere();
    setAll(scene,
           {{"environment.type", "gradient"}, {"renderer.ambient_occlusion", "sampled"}, {"output.samples", "32"}});
    const auto session = rendered(scene);
    const auto layers = session->layers();
    const auto accumulation = session->accumulation();
    double difference = 0.0;
    double variance = 0.0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (layers.albedo.at(x, y)[3] < 1.0F) continue;
            const double expected = kAlbedo / kPi * irradiance(rgb(layers.geometry.at(x, y))).y;
            difference += layers.radiance.at(x, y)[1] - expected;
            variance += accumulation.spread.at(x, y)[1] / 32.0 / 31.0;
        }
    }
    EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(variance)) << "biased";
}

constexpr const char* kTwoSpheres = "min(length(p) - 1.0, length(p - vec3(0.5, -0.9, 0.9)) - 0.4)";
const glm::dvec3 kSmall(0.5, -0.9, 0.9);
constexpr double kSmallRadius = 0.4;

/// How far the line from a point along l passes from the small sphere's surface; negative inside, large when it is
/// behind.
double clearance(const glm::dvec3& point, const glm::dvec3& l) {
    const glm::dvec3 to = kSmall - point;
    const double along = glm::dot(to, l);
    return along <= 0.0 ? 1e9 : glm::length(to - along * l) - kSmallRadius;
}

TEST(HardShadow, ends_where_the_ray_to_the_sun_grazes_the_occluder) {
    scene::Scene scene = darkSphere({128, 128});
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    setAll(scene, {{"renderer.shadow", "hard"},
                   {"lights", R"([{"type": "sun", "azimuth": -50, "elevation": 50, "color": [1, 1, 1], "intensity": 1,
                                   "size": 0}])"}});
    const double a = glm::radians(-50.0);
    const double e = glm::radians(50.0);
    const glm::dvec3 l(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    const auto layers = rendered(scene)->layers();
    const glm::dvec3 eye(0, -kDistance, 0);
    const double pixel = pixelSize(scene) * kDistance;
    int shadowed = 0;
    int lit = 0;
    int near = 0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            if (layers.albedo.at(x, y)[3] == 0.0F) continue;
            const glm::dvec3 n = rgb(layers.geometry.at(x, y));
            const double cosine = glm::dot(n, l);
            // Only the large sphere; there, the normal is the point.
            const glm::dvec3 direction =
                glm::normalize(glm::dvec3((x + 0.5 - 64) * pixelSize(scene), 1.0, (63.5 - y) * pixelSize(scene)));
            const glm::dvec3 seen = eye + static_cast<double>(layers.geometry.at(x, y)[3]) * direction;
            if (glm::length(seen - n) > 0.1 || cosine < 0.1) continue;
            const double gap = clearance(n, l);
            const double radiance = layers.radiance.at(x, y)[0];
            const double open = kAlbedo / kPi * cosine;
            // Rays leave 1.5 footprints above the surface, and what is nearer than a quarter of one blocks.
            if (std::abs(gap) < 2.0 * kDetail * pixel) {
                ++near;
            } else if (gap < 0.0) {
                ASSERT_EQ(radiance, 0.0) << x << "," << y << " gap " << gap;
                ++shadowed;
            } else {
                ASSERT_NEAR(radiance, open, 1e-5) << x << "," << y << " gap " << gap;
                ++lit;
            }
        }
    }
    EXPECT_GT(shadowed, 300);
    EXPECT_GT(lit, 1000);
    EXPECT_LT(near, 20);
}

/// The part of a disc of tangent `spread` about l that is seen past the small sphere.
double visiblePart(const glm::dvec3& point, const glm::dvec3& l, double spread) {
    const glm::dvec3 helper = std::abs(l.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, l));
    const glm::dvec3 y = glm::cross(l, x);
    constexpr int kSteps = 200;
    int seen = 0;
    for (int i = 0; i < kSteps; ++i) {
        for (int k = 0; k < kSteps; ++k) {
            const double r = spread * std::sqrt((i + 0.5) / kSteps);
            const double phi = 2.0 * kPi * (k + 0.5) / kSteps;
            seen += clearance(point, glm::normalize(l + r * std::cos(phi) * x + r * std::sin(phi) * y)) > 0.0;
        }
    }
    return static_cast<double>(seen) / (kSteps * kSteps);
}

TEST(SampledShadow, shows_the_part_of_the_suns_disc_that_is_not_covered) {
    // From a point in the open to a sun of 2 degrees that the small sphere's edge cuts, by from none to all of it.
    const double spread = std::tan(glm::radians(1.0));
    const glm::dvec3 point(0.0, -1.0, 0.0);
    const glm::dvec3 axis = glm::normalize(kSmall - point);
    const double cover = std::asin(kSmallRadius / glm::length(kSmall - point));
    const glm::dvec3 aside = glm::normalize(glm::cross(axis, glm::dvec3(0, 0, 1)));
    scene::Scene scene = darkSphere();
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    for (const double offset : {-1.2, -0.7, -0.3, 0.0, 0.3, 0.7, 1.2}) {
        const double angle = cover + offset * glm::radians(1.0);
        const glm::dvec3 l = std::cos(angle) * axis + std::sin(angle) * aside;
        const double truth = visiblePart(point, l, spread);
        if (offset == 0.0) {
            EXPECT_NEAR(truth, 0.5, 0.03) << "nearly a half plane";
        }
        const auto images = runOnScene(
            scene,
            "uniform vec3 from;\nuniform vec3 to;\nuniform float spread;\n"
            "void kernel_main(ivec2 pixel, out vec4 a) {\n"
            // The hit's footprint decides how far from it rays start.
            "    Hit hit = Hit(1.0, from, 1e-4, 0.0);\n"
            "    LightSample light = LightSample(to, 1e30, spread, vec3(1.0));\n"
            "    vec3 l = light_sample(light, random_pair(pixel, 8u)).direction;\n"
            "    a = vec4(surface_blocked(hit, vec3(0.0, -1.0, 0.0), l, 1e30) ? 0.0 : 1.0, dot(l, to), 0.0, 0.0);\n"
            "}\n",
            {64, 64}, 1, [&](gpu::Kernel& kernel) {
                kernel.set("from", glm::vec3(point - glm::dvec3(0, -kDistance, 0)));
                kernel.set("to", glm::vec3(l));
                kernel.set("spread", static_cast<float>(spread));
            });
        double sum = 0.0;
        for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
            sum += static_cast<double>(images[0].data()[i]);
            ASSERT_GE(images[0].data()[i + 1], std::cos(glm::radians(1.0)) - 1e-6) << "outside the disc";
        }
        const double n = 4096.0;
        // Rays start 1.5e-4 above the point and miss by half a footprint more, of a disc that is 0.012 in radius there.
        const double slack = 0.01 + 4.0 * std::sqrt(truth * (1.0 - truth) / n);
        EXPECT_NEAR(sum / n, truth, slack) << "offset " << offset;
    }
}

TEST(SoftShadow, by_one_ray_goes_from_dark_to_light_over_the_penumbra) {
    const double spread = std::tan(glm::radians(1.0));
    const glm::dvec3 point(0.0, -1.0, 0.0);
    const glm::dvec3 axis = glm::normalize(kSmall - point);
    const double cover = std::asin(kSmallRadius / glm::length(kSmall - point));
    const glm::dvec3 aside = glm::normalize(glm::cross(axis, glm::dvec3(0, 0, 1)));
    scene::Scene scene = darkSphere();
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    const auto images = runOnScene(
        scene,
        "uniform vec3 from;\nuniform vec3 axis;\nuniform vec3 aside;\nuniform float cover;\nuniform float spread;\n"
        "void kernel_main(ivec2 pixel, out vec4 a) {\n"
        "    float angle = cover + (float(pixel.x) - 32.0) / 16.0 * atan(spread);\n"
        "    vec3 to = normalize(cos(angle) * axis + sin(angle) * aside);\n"
        "    a = vec4(surface_visibility(Hit(1.0, from, 1e-4, 0.0), vec3(0.0, -1.0, 0.0), to, 1e30, spread));\n"
        "}\n",
        {65, 1}, 1, [&](gpu::Kernel& kernel) {
            kernel.set("from", glm::vec3(point - glm::dvec3(0, -kDistance, 0)));
            kernel.set("axis", glm::vec3(axis));
            kernel.set("aside", glm::vec3(aside));
            kernel.set("cover", static_cast<float>(cover));
            kernel.set("spread", static_cast<float>(spread));
        });
    double previous = 0.0;
    for (int x = 0; x < 65; ++x) {
        const double offset = (x - 32.0) / 16.0; // in radii of the sun, positive in the light
        const double visible = images[0].at(x, 0)[0];
        EXPECT_GE(visible, previous) << offset;
        // The estimate knows how near the one ray comes to the occluder, not how far it would go inside: its penumbra
        // lies outside the geometric edge, where the true one reaches as far to both sides.
        if (offset < -0.05) {
            EXPECT_EQ(visible, 0.0) << offset;
        }
        if (offset > 1.2) {
            EXPECT_EQ(visible, 1.0) << offset;
        }
        if (std::abs(offset - 0.5625) < 0.01) {
            EXPECT_NEAR(visible, 0.5, 0.05);
        }
        previous = visible;
    }
}

/// Directions, roughness and metalness from pixels; the sum of brdf * cosine over the hemisphere.
std::string albedoText(const char* brdf) {
    return fmt::format(R"(
void kernel_main(ivec2 pixel, out vec4 a) {{
    float nv = (float(pixel.x) + 0.5) / 16.0;
    Material m = Material(vec3(1.0), 0.2 + 0.8 * float(pixel.y & 7) / 7.0, pixel.y < 8 ? 0.0 : 1.0, vec3(0.0));
    vec3 n = vec3(0.0, 0.0, 1.0);
    vec3 v = vec3(sqrt(1.0 - nv * nv), 0.0, nv);
    const int steps = 192;
    float sum = 0.0;
    for (int i = 0; i < steps; ++i) {{
        for (int k = 0; k < steps; ++k) {{
            // Half of the azimuths: all is symmetric about the plane of n and v.
            float z = (float(i) + 0.5) / float(steps);
            float phi = 3.14159265 * (float(k) + 0.5) / float(steps);
            vec3 l = vec3(sqrt(1.0 - z * z) * vec2(cos(phi), sin(phi)), z);
            sum += ({}).r;
        }}
    }}
    a = vec4(sum * 6.28318531 / float(steps * steps), nv, m.roughness, m.metalness);
}}
)",
                       brdf);
}

class EveryBrdf : public testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Brdf, EveryBrdf,
                         testing::Values(std::pair{"lambert", "brdf_lambert(m, n, l)"},
                                         std::pair{"phong", "brdf_phong(m, n, v, l)"},
                                         std::pair{"ggx", "brdf_ggx(m, n, v, l)"}),
                         [](const auto& instance) { return std::string(instance.param.first); });

TEST_P(EveryBrdf, reflects_no_more_than_it_gets) {
    const auto images = runText({"render/glsl/brdf.glsl"}, albedoText(GetParam().second), {16, 16}, 1);
    double most = 0.0;
    for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
        const float* texel = images[0].data().data() + i;
        most = std::max(most, static_cast<double>(texel[0]));
        // The sum over the hemisphere is good to 0.003. What GGX facets leave for the base under them is known by
        // Karis' fit, which is up to 0.07 off at grazing angles; a metal has no base.
        // What is scattered between the facets is known by a fit that is up to 0.011 too high.
        const bool fitted = std::string(GetParam().first) == "ggx";
        const double limit = !fitted ? 1.003 : texel[3] == 0.0F ? 1.07 : 1.014;
        EXPECT_LE(texel[0], limit) << "cosine " << texel[1] << " roughness " << texel[2] << " metalness " << texel[3];
        EXPECT_GE(texel[0], 0.0F);
    }
    EXPECT_GT(most, 0.98) << "white is white";
}

TEST_P(EveryBrdf, does_not_care_which_way_light_goes) {
    const std::string one = GetParam().second;
    std::string other = one;
    if (const std::size_t at = other.find("v, l"); at != std::string::npos) other.replace(at, 4, "l, v");
    if (one.find("v, l") == std::string::npos) other = "brdf_lambert(m, n, v)";
    const auto images = runText({"render/glsl/brdf.glsl", "render/glsl/random.glsl"},
                                fmt::format(R"(
vec3 direction(vec2 u) {{
    float z = 0.05 + 0.95 * u.x;
    return vec3(sqrt(1.0 - z * z) * vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y)), z);
}}
void kernel_main(ivec2 pixel, out vec4 a) {{
    vec3 n = vec3(0.0, 0.0, 1.0);
    vec3 v = direction(random_pair(pixel, 0u));
    vec3 l = direction(random_pair(pixel, 1u));
    vec2 u = random_pair(pixel, 2u);
    Material m = Material(vec3(random_pair(pixel, 3u), 0.5), 0.1 + 0.9 * u.x, u.y, vec3(0.0));
    a = vec4(({}).r / l.z, ({}).r / v.z, 0.0, 0.0);
}}
)",
                                            one, other),
                                {32, 32}, 1);
    for (std::size_t i = 0; i < images[0].data().size(); i += 4) {
        const double there = images[0].data()[i];
        const double back = images[0].data()[i + 1];
        // Narrow lobes are the difference of nearly equal numbers in float.
        ASSERT_NEAR(there, back, 2e-3 * std::max(there, 1.0)) << i / 4;
    }
}

TEST_P(EveryBrdf, is_a_number_where_the_light_is_behind_the_eye) {
    // Half vectors then equal both directions, and rounding takes their cosines past 1.
    const auto images = runText({"render/glsl/brdf.glsl", "render/glsl/random.glsl"},
                                fmt::format(R"(
void kernel_main(ivec2 pixel, out vec4 a) {{
    vec2 u = random_pair(pixel, 0u);
    float z = 0.01 + 0.99 * u.x;
    vec3 n = vec3(0.0, 0.0, 1.0);
    vec3 v = normalize(vec3(sqrt(1.0 - z * z) * vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y)), z));
    vec3 l = v;
    Material m = Material(vec3(0.5), 0.45, 0.0, vec3(0.0));
    a = vec4({}, 1.0);
}}
)",
                                            GetParam().second),
                                {128, 128}, 1);
    for (const float value : images[0].data()) {
        ASSERT_TRUE(std::isfinite(value));
        ASSERT_GE(value, 0.0F);
    }
}

TEST(Ggx, white_metal_reflects_all_of_a_furnace_at_any_roughness_and_angle) {
    // Rows: roughness 0.15 to 1. Columns: cosines from 0.03 to 1. Every pixel is the mean of 4096 drawn directions.
    const auto images = runText({"render/glsl/brdf.glsl"},
                                R"(
void kernel_main(ivec2 pixel, out vec4 a) {
    vec3 n = vec3(0.0, 0.0, 1.0);
    float z = mix(0.03, 1.0, float(pixel.x) / 15.0);
    vec3 v = vec3(sqrt(1.0 - z * z), 0.0, z);
    Material m = Material(vec3(1.0), mix(0.15, 1.0, float(pixel.y) / 15.0), 1.0, vec3(0.0));
    float gloss = brdf_gloss(2, m, n, v);
    float sum = 0.0;
    for (int i = 0; i < 4096; ++i) {
        vec2 u = fract(vec2((float(i) + 0.5) / 4096.0, 0.618033989 * float(i)));
        float lobe = fract(0.754877666 * float(i) + 0.5);
        vec3 l = brdf_sample(2, gloss, m, n, v, u, lobe);
        float pdf = brdf_pdf(2, gloss, m, n, v, l);
        if (pdf > 0.0) sum += brdf_value(2, m, n, v, l).r / pdf;
    }
    a = vec4(sum / 4096.0, brdf_environment(m, n, v).r, gloss, 1.0);
}
)",
                                {16, 16}, 1);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            SCOPED_TRACE(testing::Message() << "column " << x << ", row " << y);
            // The fit is within 0.013 of the integral, the lattice of 4096 directions within 0.007.
            EXPECT_NEAR(images[0].at(x, y)[0], 1.0F, 0.02F);
            EXPECT_NEAR(images[0].at(x, y)[1], 1.0F, 1e-3F);
        }
    }
}

class EveryRoughness : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Furnace, EveryRoughness, testing::Values("0.1", "0.5", "1"), [](const auto& instance) {
    std::string name = instance.param;
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
});

TEST_P(EveryRoughness, no_material_outshines_a_furnace) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"subject.color_a", "1,1,1"},
                   {"renderer.brdf", "ggx"},
                   {"output.samples", "2"}});
    scene.set("subject.roughness", std::string_view(GetParam()));
    for (const char* brdf : {"ggx", "phong"}) {
        for (const char* occlusion : {"none", "sampled"}) {
            for (const char* metalness : {"0", "1"}) {
                setAll(scene, {{"renderer.brdf", brdf},
                               {"renderer.ambient_occlusion", occlusion},
                               {"subject.metalness", metalness}});
                const auto layers = rendered(scene, {.stage = {}, .specialise = false})->layers();
                float most = 0.0F;
                for (std::size_t i = 0; i < layers.radiance.data().size(); i += 4)
                    most = std::max(most, layers.radiance.data()[i]);
                // Karis' fit of the microfacets' albedo is good to about 2 %.
                EXPECT_LE(most, 1.02F) << brdf << " " << occlusion << " metalness " << metalness;
            }
        }
    }
}

/// An independent renderer: spheres, a Lambertian surface, a sun with a disc, sky light with one ray. In double, with
/// other random numbers, by intersection instead of marching.
class RayTracer {
  public:
    RayTracer(const glm::dvec3& l, double spread, double sun) : l_(l), spread_(spread), sun_(sun) {}

    double sample(const glm::dvec3& eye, const glm::dvec3& direction) {
        glm::dvec3 n;
        const double t = nearest(eye, direction, n);
        if (t == kNone) return gradient(direction).y;
        const glm::dvec3 p = eye + t * direction + 1e-9 * n;
        double sum = 0.0;
        const glm::dvec3 helper = std::abs(l_.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
        const glm::dvec3 x = glm::normalize(glm::cross(helper, l_));
        // Uniform in the disc's projected solid angle, which is what irradiance is about.
        const double r = std::sin(std::atan(spread_)) * std::sqrt(uniform());
        const double phi = 2.0 * kPi * uniform();
        const double along = std::sqrt(1.0 - r * r);
        const glm::dvec3 l = along * l_ + r * (std::cos(phi) * x + std::sin(phi) * glm::cross(l_, x));
        glm::dvec3 ignored;
        if (glm::dot(n, l) > 0.0 && nearest(p, l, ignored) == kNone)
            sum += kAlbedo / kPi * sun_ * glm::dot(n, l) / along;
        glm::dvec3 up;
        do {
            up = 2.0 * glm::dvec3(uniform(), uniform(), uniform()) - 1.0;
        } while (glm::dot(up, up) > 1.0 || glm::dot(up, up) < 1e-6);
        const glm::dvec3 sky = glm::normalize(n + glm::normalize(up));
        if (nearest(p, sky, ignored) == kNone) sum += kAlbedo * gradient(sky).y;
        return sum;
    }

    double uniform() { return std::uniform_real_distribution<double>()(random_); }

  private:
    static constexpr double kNone = 1e30;

    static double nearest(const glm::dvec3& from, const glm::dvec3& direction, glm::dvec3& normal) {
        double best = kNone;
        for (const auto& [centre, radius] : {std::pair{glm::dvec3(0.0), 1.0}, std::pair{kSmall, kSmallRadius}}) {
            const glm::dvec3 to = centre - from;
            const double along = glm::dot(to, direction);
            const glm::dvec3 aside = to - along * direction;
            const double h2 = radius * radius - glm::dot(aside, aside);
            if (h2 <= 0.0 || along - std::sqrt(h2) <= 0.0 || along - std::sqrt(h2) >= best) continue;
            best = along - std::sqrt(h2);
            normal = (from + best * direction - centre) / radius;
        }
        return best;
    }

    glm::dvec3 l_;
    double spread_;
    double sun_;
    std::mt19937_64 random_{1};
};

TEST(Picture, is_the_one_of_an_independent_ray_tracer) {
    constexpr int kSize = 48;
    constexpr int kSamples = 64;
    scene::Scene scene = darkSphere({kSize, kSize});
    scene.subject.set("formula", formulaOf(kTwoSpheres, 2.0));
    setAll(scene, {{"renderer.shadow", "sampled"},
                   {"renderer.ambient_occlusion", "sampled"},
                   {"environment.type", "gradient"},
                   {"lights", R"([{"type": "sun", "azimuth": -50, "elevation": 50, "color": [1, 1, 1], "intensity": 2,
                                   "size": 12}])"}});
    scene.output.set("samples", std::int64_t{kSamples});
    const auto session = rendered(scene);
    const auto layers = session->layers();
    const auto accumulation = session->accumulation();

    const double a = glm::radians(-50.0);
    const double e = glm::radians(50.0);
    RayTracer tracer(glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)),
                     std::tan(glm::radians(6.0)), 2.0);
    const double pixel = pixelSize(scene);
    constexpr int kTruth = 4 * kSamples;
    double sum = 0.0;
    double variance = 0.0;
    double squares = 0.0;
    int counted = 0;
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            double mean = 0.0;
            double spread = 0.0;
            for (int i = 0; i < kTruth; ++i) {
                const glm::dvec3 direction = glm::normalize(glm::dvec3(
                    (x + tracer.uniform() - 0.5 * kSize) * pixel, 1.0, (0.5 * kSize - y - tracer.uniform()) * pixel));
                const double value = tracer.sample({0, -kDistance, 0}, direction);
                const double before = value - mean;
                mean += before / (i + 1.0);
                spread += before * (value - mean);
            }
            // Of the same pixel by both: the engine's samples are stratified, so this is more than its variance.
            const double v = spread / kTruth;
            const double error2 = v / kTruth + v / kSamples + 1e-9;
            const double difference = layers.radiance.at(x, y)[1] - mean;
            const float hits = layers.albedo.at(x, y)[3];
            if (hits > 0.0F && hits < 1.0F) {
                // Surfaces are `detail` pixels too wide, at a contrast of up to 1.
                ASSERT_LT(std::abs(difference), 6.0 * std::sqrt(error2) + 1.5 * kDetail) << x << "," << y;
                continue;
            }
            ASSERT_LT(std::abs(difference), 6.0 * std::sqrt(error2)) << x << "," << y;
            sum += difference;
            variance += error2;
            squares += difference * difference / error2;
            ++counted;
        }
    }
    EXPECT_GT(counted, kSize * kSize * 9 / 10);
    EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(variance)) << "biased by " << sum / counted << " on average";
    EXPECT_LT(std::sqrt(squares / counted), 1.1);
    EXPECT_EQ(accumulation.samples(), kSamples);
}

} // namespace
} // namespace apeiron::test
