// The lens: blur against the thin-lens formula, in closed form.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDistance = 4.0; // of darkSphere()'s camera from the origin
constexpr double kRadius = 0.08;  // of the small bright sphere at the origin

/// A small sphere that shines, in the dark, and nothing else.
scene::Scene bright(int samples) {
    scene::Scene scene = darkSphere({64, 64});
    scene.subject.set("formula", formulaOf(fmt::format("length(p) - {}", kRadius), 0.1));
    setAll(scene, {{"subject.emission", "2"}});
    scene.output.set("samples", std::int64_t{samples});
    return scene;
}

/// Of light in a picture: its sum and its mean square distance from the middle [px].
struct Moments {
    double sum = 0.0;
    double square = 0.0;
};

Moments momentsOf(const Image<float>& image) {
    Moments moments;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const double dx = x + 0.5 - image.width() / 2.0;
            const double dy = y + 0.5 - image.height() / 2.0;
            const double light = image.at(x, y)[1];
            moments.sum += light;
            moments.square += light * (dx * dx + dy * dy);
        }
    }
    moments.square /= moments.sum;
    return moments;
}

/// Pixels that a unit of length at distance 1 takes.
double pixels(const scene::Scene& scene) {
    return 64.0 / (2.0 * std::tan(glm::radians(scene.camera.number("fov")) / 2.0));
}

/// Mean square radius of the sphere's own image, a disc, and of the box filter [px].
double sharp(const scene::Scene& scene) {
    const double radius = kRadius / kDistance * pixels(scene) + 0.05; // darkSphere()'s threshold of a hit
    return radius * radius / 2.0 + 1.0 / 6.0;
}

TEST(Lens, blurs_by_the_circle_of_confusion_of_a_thin_lens) {
    const scene::Scene pinhole = bright(128);
    const double light = momentsOf(rendered(pinhole)->layers().radiance).sum;
    for (const char* projection : {"perspective", "orthographic"}) {
        for (const double focus : {3.0, 4.0, 6.0}) {
            scene::Scene scene = pinhole;
            setAll(scene, {{"camera.aperture", "0.2"}, {"camera.projection", projection}});
            scene.camera.set("focus", focus);
            const Moments moments = momentsOf(rendered(scene)->layers().radiance);
            // The lens' diameter, seen from the plane of focus, on the plane of the sphere.
            const double diameter = 0.2 * focus * std::abs(kDistance - focus) / focus;
            const double radius = 0.5 * diameter / kDistance * pixels(scene);
            const double truth = radius * radius / 2.0 + sharp(scene);
            // The sphere gets about 10 pixels' 128 samples: some 3 percent of noise.
            EXPECT_NEAR(moments.square, truth, 0.05 * truth) << projection << " focus " << focus;
            EXPECT_NEAR(moments.sum, light, 0.1 * light) << projection << " focus " << focus << ": light is lost";
        }
    }
}

TEST(Lens, with_blades_is_a_polygon) {
    scene::Scene scene = bright(128);
    setAll(scene, {{"camera.aperture", "0.3"}, {"camera.focus", "6"}, {"camera.blades", "5"}});
    const Image<float> image = rendered(scene)->layers().radiance;
    const double radius = 0.5 * 0.3 * (6.0 - kDistance) / kDistance * pixels(scene);
    // Of a regular polygon about its middle: R² (2 + cos(2 pi / n)) / 6.
    const double truth = radius * radius * (2.0 + std::cos(2.0 * kPi / 5.0)) / 6.0 + sharp(scene);
    EXPECT_NEAR(momentsOf(image).square, truth, 0.05 * truth);
    // One corner is at the top of the lens, hence at the bottom of a picture in front of the plane of focus.
    const auto lit = [&](int y) { return image.at(31, y)[1] + image.at(32, y)[1] > 0.0F; };
    int up = 0;
    int down = 0;
    while (up < 31 && lit(31 - up))
        ++up;
    while (down < 31 && lit(32 + down))
        ++down;
    EXPECT_GT(std::abs(up - down), static_cast<int>(0.12 * radius)) << "cos(pi / 5) is 0.81";
}

TEST(Lens, focuses_on_the_target_unless_told_otherwise) {
    scene::Scene scene = bright(16);
    setAll(scene, {{"camera.aperture", "0.5"}});
    const Image<float> itself = rendered(scene)->layers().radiance;
    EXPECT_NEAR(momentsOf(itself).square, sharp(scene), 0.1 * sharp(scene));
    setAll(scene, {{"camera.focus", "4"}});
    EXPECT_TRUE(identical(itself, rendered(scene)->layers().radiance));
}

TEST(Lens, of_no_aperture_is_the_pinhole_bit_by_bit) {
    scene::Scene scene = darkSphere();
    setAll(scene, {{"camera.focus", "1.7"}, {"camera.blades", "6"}});
    const auto images = runOnScene(scene,
                                   "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                                   "    Ray ray = camera_sample(pixel);\n"
                                   "    Ray pinhole = camera_ray(vec2(pixel) + 0.5 + camera_jitter(pixel));\n"
                                   "    a = vec4(ray.direction, length(ray.origin));\n"
                                   "    b = vec4(pinhole.direction, 0.0);\n"
                                   "}\n",
                                   {64, 64}, 2);
    EXPECT_TRUE(identical(images[0], images[1]));
}

TEST(Lens, rays_of_a_pixel_meet_in_the_plane_of_focus) {
    scene::Scene scene = darkSphere({64, 32});
    setAll(scene, {{"camera.aperture", "0.4"}, {"camera.focus", "2.5"}});
    const auto images = runOnScene(scene,
                                   "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                                   "    Ray ray = camera_sample(pixel);\n"
                                   "    Ray pinhole = camera_ray(vec2(pixel) + 0.5 + camera_jitter(pixel));\n"
                                   "    vec3 ahead = -camera_basis[2];\n"
                                   "    vec3 p = ray.origin + ray.direction * (2.5 / dot(ray.direction, ahead));\n"
                                   "    vec3 q = pinhole.direction * (2.5 / dot(pinhole.direction, ahead));\n"
                                   "    a = vec4(p - q, length(ray.origin));\n"
                                   "    b = vec4(vec3(dot(ray.origin, ahead)), 1.0);\n"
                                   "}\n",
                                   {64, 32}, 2);
    double widest = 0.0;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) {
            ASSERT_LT(glm::length(rgb(images[0].at(x, y))), 2e-6);
            ASSERT_NEAR(images[1].at(x, y)[0], 0.0, 1e-7) << "the lens is flat";
            widest = std::max(widest, static_cast<double>(images[0].at(x, y)[3]));
        }
    }
    EXPECT_LE(widest, 0.5 * 0.4 * 2.5 + 1e-6);
    EXPECT_GT(widest, 0.95 * 0.5 * 0.4 * 2.5);
}

TEST(Focus, is_put_on_what_is_seen_at_a_pixel) {
    // A wall across the view, 4.8 from the camera: whatever the pixel, its plane is the same.
    scene::Scene scene = darkSphere({64, 32});
    scene.subject.set("formula", formulaOf("abs(p.y - 1.0) - 0.2", 50.0));
    session::Session session(context(), scene);
    finish(session);
    for (const glm::ivec2 pixel : {glm::ivec2(32, 16), glm::ivec2(0, 0), glm::ivec2(60, 3)}) {
        session.setCamera(scene::Camera(scene.camera));
        ASSERT_TRUE(session.focusAt(pixel));
        EXPECT_NEAR(session.camera().focus(), 4.8, 0.01) << pixel.x << "," << pixel.y;
        EXPECT_EQ(session.samples(), 1) << "a pinhole has no focus: nothing changes";
    }
    session.set("camera.aperture", std::string_view("0.1"));
    finish(session);
    ASSERT_EQ(session.samples(), 1);
    session.set("camera.focus", std::string_view("2"));
    EXPECT_EQ(session.samples(), 0) << "with a lens the picture is another one";
    finish(session);
    EXPECT_TRUE(session.focusAt({5, 5}));
    EXPECT_EQ(session.samples(), 0);
}

TEST(Focus, stays_where_nothing_is_seen) {
    scene::Scene scene = darkSphere();
    const auto session = rendered(scene);
    const double focus = session->camera().focus();
    EXPECT_FALSE(session->focusAt({0, 0}));
    EXPECT_EQ(session->camera().focus(), focus);
    EXPECT_TRUE(session->focusAt({32, 32}));
    EXPECT_NEAR(session->camera().focus(), kDistance - 1.0, 0.01);
}

} // namespace
} // namespace apeiron::test
