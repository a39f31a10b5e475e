#include "scene/camera.hpp"
#include "scene_support.hpp"

#include <cmath>
#include <random>

namespace apeiron::scene {
namespace {

using parameter::Decimal3;

/// Rounding of a few double operations on numbers near 1.
constexpr double kRounding = 1e-12;

Camera camera(std::initializer_list<std::pair<const char*, const char*>> settings = {}) {
    parameter::Node node(Catalogue().type("camera", ""));
    for (const auto& [name, text] : settings)
        node.setFromText(name, text);
    return Camera(node);
}

glm::dvec3 offset(const Decimal3& to, const Decimal3& from) {
    return {(to[0] - from[0]).toDouble(), (to[1] - from[1]).toDouble(), (to[2] - from[2]).toDouble()};
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = kRounding) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

void expectSameView(const Camera& a, const Camera& b) {
    expectNear(a.forward(), b.forward());
    expectNear(a.up(), b.up());
}

std::size_t digits(const Camera& camera) {
    return camera.position()[0].toString().size();
}

TEST(CameraTest, orbit_mode_looks_at_the_target_upright) {
    const Camera c = camera({{"position", "0,-5,0"}});
    expectNear(c.forward(), {0, 1, 0});
    expectNear(c.right(), {1, 0, 0});
    expectNear(c.up(), {0, 0, 1});
    EXPECT_DOUBLE_EQ(c.distance(), 5);
}

TEST(CameraTest, identity_orientation_is_the_camera_space_of_opengl) {
    const Camera c = camera({{"mode", "free"}});
    expectNear(c.forward(), {0, 0, -1});
    expectNear(c.up(), {0, 1, 0});
    expectNear(c.right(), {1, 0, 0});
}

TEST(CameraTest, free_orientation_of_any_length_is_a_rotation) {
    const Camera c = camera({{"mode", "free"}, {"orientation", "0,0,3e-200,3e-200"}});
    expectNear(c.right(), {0, 1, 0}); // a quarter turn around +z
    EXPECT_NEAR(glm::length(c.up()), 1, kRounding);
}

TEST(CameraTest, degenerate_views_are_still_orthonormal) {
    for (const char* position : {"0,0,5", "0,0,-5", "0,0,0"}) {
        const Camera c = camera({{"position", position}});
        EXPECT_NEAR(glm::length(c.forward()), 1, kRounding) << position;
        EXPECT_NEAR(glm::length(c.up()), 1, kRounding) << position;
        EXPECT_NEAR(glm::dot(c.up(), c.forward()), 0, kRounding) << position;
    }
    expectNear(camera({{"position", "0,0,5"}}).forward(), {0, 0, -1});
}

TEST(CameraTest, roll_turns_the_picture_counter_clockwise) {
    const Camera c = camera({{"position", "0,-5,0"}, {"roll", "90"}});
    expectNear(c.up(), {-1, 0, 0});
    expectNear(c.forward(), {0, 1, 0});
}

TEST(CameraTest, orbit_moves_to_its_right_and_up) {
    Camera c = camera({{"position", "0,-5,0"}});
    c.orbit(glm::radians(90.0), 0);
    expectNear(offset(c.position(), c.target()), {5, 0, 0});
    c.orbit(0, glm::radians(30.0));
    expectNear(offset(c.position(), c.target()), {5 * std::cos(glm::radians(30.0)), 0, 2.5});
}

TEST(CameraTest, orbit_of_a_rolled_camera_follows_the_picture) {
    Camera c = camera({{"position", "0,-5,0"}, {"roll", "90"}});
    const glm::dvec3 right = c.right();
    const glm::dvec3 before = offset(c.position(), c.target());
    c.orbit(1e-6, 0);
    expectNear((offset(c.position(), c.target()) - before) / 5e-6, right, 1e-5); // first order of a small step
}

TEST(CameraTest, orbit_keeps_the_distance) {
    Camera c = camera();
    const double distance = c.distance();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> angle(-1, 1);
    for (int i = 0; i < 1000; ++i)
        c.orbit(angle(random), angle(random));
    EXPECT_NEAR(c.distance(), distance, 1e-12 * distance);
    expectNear(c.forward(), -glm::normalize(offset(c.position(), c.target())));
    EXPECT_LT(digits(c), 40U) << "repeated moves must not lengthen the decimals";
}

TEST(CameraTest, orbit_stays_clear_of_the_poles) {
    Camera c = camera();
    const glm::dvec3 right = c.right();
    for (int i = 0; i < 10; ++i)
        c.orbit(0, 1);
    EXPECT_GT(offset(c.position(), c.target()).z, 0);
    expectNear(c.right(), right, 1e-9); // the picture does not flip; 1e-3 rad from the pole costs 3 digits
    for (int i = 0; i < 10; ++i)
        c.orbit(0, -1);
    EXPECT_LT(offset(c.position(), c.target()).z, 0);
    expectNear(c.right(), right, 1e-9);
}

TEST(CameraTest, orbit_starts_from_a_pole) {
    Camera c = camera({{"position", "0,0,5"}});
    const glm::dvec3 right = c.right();
    c.orbit(0, -0.5);
    expectNear(c.right(), right);
    EXPECT_NEAR(c.distance(), 5, kRounding);
}

TEST(CameraTest, orbit_from_a_free_view_does_not_jump) {
    Camera c = camera();
    c.look(0.3, -0.2, 0.7);
    const Camera before = c;
    c.orbit(0, 0);
    EXPECT_TRUE(c.orbiting());
    expectSameView(c, before);
    EXPECT_EQ(c.position(), before.position()) << "no yaw and no pitch";
}

TEST(CameraTest, zoom_multiplies_the_distance) {
    Camera c = camera();
    const double distance = c.distance();
    const Camera before = c;
    c.zoom(1e-10);
    EXPECT_NEAR(c.distance(), 1e-10 * distance, 1e-24 * distance);
    expectSameView(c, before);
    EXPECT_EQ(c.target(), before.target());
    c.zoom(1e10);
    EXPECT_NEAR(c.distance(), distance, 1e-12 * distance);
}

TEST(CameraTest, zoom_has_no_depth_limit_but_that_of_doubles) {
    Camera c = camera({{"target", "0.1,0.2,0.3"}});
    for (int i = 0; i < 900; ++i)
        c.zoom(0.5);
    EXPECT_NEAR(std::log2(c.distance()), -900 + std::log2(camera({{"target", "0.1,0.2,0.3"}}).distance()), 1e-9);
    expectSameView(c, camera({{"target", "0.1,0.2,0.3"}}));
    for (int i = 0; i < 900; ++i)
        c.zoom(0.5);
    EXPECT_GT(c.distance(), 0);
    for (int i = 0; i < 3000; ++i)
        c.zoom(2);
    EXPECT_TRUE(std::isfinite(c.distance()));
}

TEST(CameraTest, zoom_of_a_free_camera_goes_forward) {
    Camera c = camera({{"mode", "free"}, {"position", "0,0,0"}, {"target", "0,0,-8"}});
    c.zoom(0.25);
    expectNear(offset(c.position(), {}), {0, 0, -6});
    EXPECT_NEAR(c.distance(), 2, kRounding);
    EXPECT_FALSE(c.orbiting());
}

TEST(CameraTest, pan_keeps_view_and_distance_exactly) {
    Camera c = camera({{"position", "0,-5,0"}, {"fov", "90"}});
    c.pan(0.5, 0.25); // the picture is 10 units high at the target
    expectNear(offset(c.position(), {}), {5, -5, 2.5});
    EXPECT_EQ(c.distance(), 5);
    expectSameView(c, camera({{"position", "0,-5,0"}}));
}

TEST(CameraTest, fly_moves_in_camera_space_and_becomes_free) {
    Camera c = camera({{"position", "0,-5,0"}});
    const Camera before = c;
    c.fly({1, 2, -3});
    EXPECT_FALSE(c.orbiting());
    expectNear(offset(c.position(), before.position()), {1, 3, 2});
    expectSameView(c, before);
    EXPECT_EQ(c.distance(), before.distance());
}

TEST(CameraTest, fly_in_a_deep_zoom_keeps_all_digits) {
    const std::string deep = "0.5" + std::string(199, '1') + "7";
    const std::string position = deep + "," + deep + "," + deep;
    Camera c = camera({{"mode", "free"}, {"position", position.c_str()}, {"target", position.c_str()}});
    const Decimal3 start = c.position();
    c.fly({1e-200, 0, 0});
    EXPECT_EQ(c.position()[0] - start[0], Decimal(1e-200)) << "the step is added exactly";
    EXPECT_EQ(c.position()[1], start[1]);
    for (int i = 0; i < 1000; ++i)
        c.fly({1.23456789e-200, 0.1e-200, 3.3e-201});
    EXPECT_LT(digits(c), 240U) << "200 digits of depth, 20 below the step, and a few";
    for (int i = 0; i < 1000; ++i)
        c.fly({-1.23456789e-200, -0.1e-200, -3.3e-201});
    c.fly({-1e-200, 0, 0});
    EXPECT_EQ(c.position(), start) << "and back again";
}

TEST(CameraTest, moves_work_alike_at_every_depth) {
    for (const int depth : {0, 50, 250}) {
        const std::string scale = "e-" + std::to_string(depth);
        const std::string position = "0,-5" + scale + ",1" + scale;
        Camera c = camera({{"position", position.c_str()}});
        Camera reference = camera({{"position", "0,-5,1"}});
        for (Camera* moving : {&c, &reference}) {
            moving->orbit(0.4, 0.2);
            moving->pan(0.3, -0.1);
            moving->zoom(0.7);
            moving->look(0.1, 0.2, 0.3);
            moving->orbit(-0.2, 0.1);
        }
        expectSameView(c, reference);
        EXPECT_NEAR(c.distance() * std::pow(10.0, depth), reference.distance(), 1e-11) << depth;
    }
}

TEST(CameraTest, look_turns_in_place) {
    Camera c = camera({{"position", "0,-5,0"}});
    const Decimal3 position = c.position();
    c.look(glm::radians(90.0), 0, 0);
    expectNear(c.forward(), {-1, 0, 0}); // to the left
    expectNear(c.up(), {0, 0, 1});
    EXPECT_EQ(c.position(), position);
    EXPECT_NEAR(c.distance(), 5, kRounding);
    c.look(0, glm::radians(30.0), 0);
    EXPECT_NEAR(c.forward().z, 0.5, kRounding); // up
    Camera rolled = camera({{"position", "0,-5,0"}});
    rolled.look(0, 0, glm::radians(90.0));
    expectNear(rolled.up(), {-1, 0, 0}); // counter-clockwise
}

TEST(CameraTest, numbers_that_are_not_finite_change_nothing) {
    const double nan = std::nan("");
    Camera c = camera();
    const parameter::Node before = c.node();
    c.orbit(nan, 0);
    c.pan(nan, 0);
    c.fly({0, 0, nan});
    c.look(0, nan, 0);
    EXPECT_EQ(c.node(), before);
}

TEST(Camera, frames_points_so_that_they_just_fit) {
    std::mt19937 random(7); // NOLINT: the same numbers every time
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const glm::dvec3 center(10, -20, 30);
    for (const double aspect : {0.5, 1.0, 16.0 / 9.0}) {
        std::vector<glm::dvec3> points;
        for (int i = 0; i < 8; ++i)
            points.emplace_back(100.0 * number(random), 40.0 * number(random), 20.0 * number(random));
        Camera framed = camera();
        framed.frame(center, points, aspect, {0.4, -1.0, 0.3});
        EXPECT_GT(glm::dot(framed.forward(), glm::normalize(glm::dvec3(-0.4, 1.0, -0.3))), 1.0 - kRounding);
        const glm::dmat3 view = glm::mat3_cast(framed.orientation());
        glm::dvec2 low(1e9);
        glm::dvec2 high(-1e9);
        for (const glm::dvec3& point : points) {
            const auto& from = framed.position();
            const glm::dvec3 eye(from[0].toDouble(), from[1].toDouble(), from[2].toDouble());
            const glm::dvec3 p = glm::transpose(view) * (center + point - eye);
            ASSERT_LT(p.z, 0.0) << "before the camera";
            const glm::dvec2 place = glm::dvec2(p.x / aspect, p.y) / (-p.z * std::tan(framed.fov() / 2));
            low = glm::min(low, place);
            high = glm::max(high, place);
        }
        // In one direction they fill the picture but for the margin, to both sides alike; in the other they are inside.
        const glm::dvec2 reach = glm::max(glm::abs(low), glm::abs(high));
        EXPECT_NEAR(std::max(reach.x, reach.y), 1.0 / 1.08, 1e-9);
        const int axis = reach.x > reach.y ? 0 : 1;
        EXPECT_NEAR(low[axis], -high[axis], 1e-9);
    }
}

} // namespace
} // namespace apeiron::scene
