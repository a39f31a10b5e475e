// Slices: the right values at the right pixels, hidden by what is in front, hiding what is behind.

#include "volume_support.hpp"

#include "volume/source.hpp"

#include <cmath>

namespace apeiron::test {
namespace {

/// Renderers that show slices.
const std::vector<std::string> kRenderers{"eam", "lao", "mip", "iso", "depth", "mcs", "mcm"};

/// A ramp that no renderer shows anything of but by slices: values x + 3 y + 9 z [mm], all transparent. The box is
/// from -10 to 10 mm; the camera looks along +y and shows 20 mm: one pixel is 0.5 mm.
scene::Scene rampScene(const std::string& renderer) {
    provide("ramp", 20, [](glm::dvec3 p, int) { return p.x + 3.0 * p.y + 9.0 * p.z; });
    scene::Scene scene = volumeScene("ramp", 20.0, {40, 40});
    setAll(scene, {{"renderer.type", renderer.c_str()},
                   {"subject.transfer", R"({"window": "none", "points": [{"value": 0, "opacity": 0}]})"},
                   {"subject.slice_units", "mm"},
                   {"subject.slice_position", "0,0,0"},
                   {"subject.slice_window", "0,300"},
                   {"output.samples", "1"}});
    if (renderer == "mip") setAll(scene, {{"renderer.low", "1"}});
    if (renderer == "iso") setAll(scene, {{"renderer.opacities", "0,0,0,0"}});
    return scene;
}

/// Where the middle of a pixel is, in the picture of rampScene() [mm].
glm::dvec2 placeOf(int x, int y) {
    return {0.5 * (x + 0.5) - 10.0, 10.0 - 0.5 * (y + 0.5)};
}

class VolumeSliceTest : public testing::TestWithParam<std::string> {};

TEST_P(VolumeSliceTest, shows_the_values_of_its_plane) {
    if (GetParam() == "depth") GTEST_SKIP() << "shows distances";
    scene::Scene scene = rampScene(GetParam());
    setAll(scene, {{"subject.slice_y", "true"}, {"subject.slice_position", "0,4,0"}});
    const auto session = rendered(scene);
    const Image<float> picture = session->layers().radiance;
    int compared = 0;
    for (int y = 2; y < 38; ++y) {
        for (int x = 2; x < 38; ++x) {
            const glm::dvec2 place = placeOf(x, y);
            const double value = place.x + 3.0 * 4.0 + 9.0 * place.y;
            // One sample is somewhere in the pixel: 0.25 mm times 10 per mm, of 300.
            ASSERT_NEAR(picture.at(x, y)[1], (value + 150.0) / 300.0, 2.6 / 300.0) << x << ", " << y;
            ++compared;
        }
    }
    EXPECT_EQ(compared, 36 * 36);
}

TEST_P(VolumeSliceTest, the_value_under_the_cursor_is_the_slices) {
    scene::Scene scene = rampScene(GetParam());
    setAll(
        scene,
        {{"subject.slice_oblique", "true"}, {"subject.slice_normal", "0.3,-0.8,0.5"}, {"subject.slice_offset", "1.5"}});
    const auto session = rendered(scene);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.8, 0.5));
    int compared = 0;
    for (int y = 3; y < 38; y += 5) {
        for (int x = 3; x < 38; x += 5) {
            const glm::dvec2 place = placeOf(x, y);
            const double depth = (1.5 - normal.x * place.x - normal.z * place.y) / normal.y;
            if (std::abs(depth) > 9.4) continue; // beyond the last voxels' centres values stay as they are
            const auto reading = session->valueAt({x, y});
            ASSERT_TRUE(reading) << x << ", " << y;
            // Exactly on the plane, although the sample was somewhere in the pixel.
            EXPECT_NEAR(glm::dot(normal, reading->position), 1.5, 1e-9);
            EXPECT_NEAR(reading->position.x, place.x, 1e-9);
            EXPECT_NEAR(reading->position.z, place.y, 1e-9);
            // Voxels are single floats up to 130.
            EXPECT_NEAR(reading->values.at(0), place.x + 3.0 * depth + 9.0 * place.y, 2e-5);
            ++compared;
        }
    }
    EXPECT_GT(compared, 30);
}

TEST_P(VolumeSliceTest, is_cut_by_the_clipping_box_and_seen_in_a_clipping_plane) {
    scene::Scene scene = rampScene(GetParam());
    setAll(scene, {{"subject.slice_y", "true"},
                   {"subject.clip", "true"},
                   {"subject.clip_low", "-5,-10,-2.5"},
                   {"subject.clip_high", "2.5,10,10"},
                   {"environment.background", "transparent"}});
    const Image<float> boxed = rendered(scene)->layers().radiance;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
            const bool inside = x >= 10 && x < 25 && y < 25;
            ASSERT_EQ(boxed.at(x, y)[3] > 0.5F, inside) << x << ", " << y;
        }
    }
    // All in front of the slice is cut away, right up to it.
    setAll(scene, {{"subject.clip", "false"},
                   {"subject.clip_planes", "1"},
                   {"subject.clip_normal_1", "0,-1,0"},
                   {"subject.clip_offsets", "0,0,0"}});
    const Image<float> cut = rendered(scene)->layers().radiance;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x)
            ASSERT_GT(cut.at(x, y)[3], 0.5F) << x << ", " << y;
}

TEST_P(VolumeSliceTest, hides_what_is_behind_and_is_hidden_by_what_is_in_front) {
    if (GetParam() == "mip") GTEST_SKIP() << "the brightest is seen, wherever it is";
    // A wall from y = -2 to 2, of value 1, in nothing.
    provide("wall", 20, [](glm::dvec3 p, int) { return std::abs(p.y) < 2.0 ? 1.0 : 0.0; });
    scene::Scene scene = volumeScene("wall", 20.0, {8, 8});
    setAll(scene, {{"renderer.type", GetParam().c_str()},
                   {"subject.transfer",
                    R"({"window": "none", "points": [{"value": 0.4, "opacity": 0}, {"value": 0.6, "opacity": 1}]})"},
                   {"subject.density", "2000"},
                   {"subject.slice_y", "true"},
                   {"subject.slice_units", "mm"},
                   {"output.samples", "4"}});
    if (GetParam() == "iso") setAll(scene, {{"renderer.values", "0.5,0,0,0"}, {"renderer.opacities", "1,0,0,0"}});
    const auto depthWith = [&](const char* position) {
        scene.set("subject.slice_position", std::string_view(position));
        const auto session = rendered(scene);
        const std::optional<double> distance = session->distanceAt({4, 4});
        return distance ? *distance : -1.0;
    };
    // The camera is 100 mm before the middle. Of the wall one sees the first steps, of up to a voxel each.
    EXPECT_NEAR(depthWith("0,-6,0"), 94.0, 1e-3) << "in front of the wall";
    EXPECT_NEAR(depthWith("0,6,0"), 98.5, 1.2) << "behind the wall";
}

TEST_P(VolumeSliceTest, of_part_opacity_lets_so_much_through) {
    if (GetParam() == "mip" || GetParam() == "depth") GTEST_SKIP() << "have no transparency";
    scene::Scene scene = rampScene(GetParam());
    // Two white slices before a background of 0.5: 0.3 + 0.7 * (0.3 + 0.7 * 0.5) = 0.755.
    setAll(scene, {{"environment.color", "0.5,0.5,0.5"},
                   {"subject.slice_y", "true"},
                   {"subject.slice_oblique", "true"},
                   {"subject.slice_normal", "0,1,0"},
                   {"subject.slice_offset", "5"},
                   {"subject.slice_window", "-1000,1"},
                   {"subject.slice_opacity", "0.3"},
                   {"output.samples", "16"}});
    const Image<float> picture = rendered(scene)->layers().radiance;
    double sum = 0.0;
    for (int y = 4; y < 36; ++y)
        for (int x = 4; x < 36; ++x)
            sum += picture.at(x, y)[1] / (32.0 * 32.0);
    // Paths stop at random: 0 or 1 of 16 * 1024 samples, a standard deviation of at most 0.5 / 128; five of them.
    EXPECT_NEAR(sum, 0.755, GetParam().starts_with("mc") ? 0.02 : 1e-5);
}

INSTANTIATE_TEST_SUITE_P(, VolumeSliceTest, testing::ValuesIn(kRenderers), [](const auto& test) { return test.param; });

TEST(VolumeSlice, parts_count_through_the_box_and_colours_are_the_transfer_functions) {
    scene::Scene scene = rampScene("eam");
    setAll(scene, {{"subject.slice_units", "part"},
                   {"subject.slice_y", "true"},
                   {"subject.slice_position", "0.5,0.75,0.5"},
                   {"subject.slice_color", "transfer"},
                   {"subject.slice_ground", "false"},
                   {"subject.density", "0"},
                   {"subject.transfer", R"({"window": "none", "space": "linear", "points": [
                       {"value": 0, "color": [1, 0.5, 0.25], "opacity": 0},
                       {"value": 1e-6, "color": [1, 0.5, 0.25], "opacity": 1}]})"},
                   {"environment.background", "transparent"}});
    const auto session = rendered(scene);
    const Image<float> picture = session->layers().radiance;
    // y = 5: values x + 15 + 9 z are above 0 where z is above -(x + 15) / 9.
    for (const auto& [x, y] : {std::pair(20, 10), std::pair(5, 20), std::pair(35, 5)}) {
        EXPECT_NEAR(picture.at(x, y)[0], 1.0F, 1e-5F);
        EXPECT_NEAR(picture.at(x, y)[1], 0.5F, 1e-5F);
        EXPECT_NEAR(picture.at(x, y)[2], 0.25F, 1e-5F);
        EXPECT_NEAR(*session->distanceAt({x, y}), 105.0, 1e-3);
    }
    for (const auto& [x, y] : {std::pair(20, 30), std::pair(5, 38), std::pair(35, 35)})
        EXPECT_EQ(picture.at(x, y)[3], 0.0F) << "nothing is there";
}

TEST(VolumeSlice, of_an_oblique_grid_lies_across_the_worlds_axes) {
    // The ramp's grid turned by 30 degrees about z: a slice across x holds x = 2 in the world.
    provide("turned", 20, [](glm::dvec3 p, int) { return p.x; });
    volume::Volume turned = *volume::loadVolume({"turned", {}, {}, 0});
    const double c = std::cos(glm::radians(30.0));
    const double s = std::sin(glm::radians(30.0));
    turned.indexToWorld = glm::dmat4(c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1) * turned.indexToWorld;
    turned.oriented = true;
    volume::provideVolume("turned", std::make_shared<const volume::Volume>(std::move(turned)));
    scene::Scene scene = rampScene("eam");
    setAll(scene, {{"subject.source", "turned"}, {"subject.slice_x", "true"}, {"subject.slice_position", "2,0,0"}});
    scene.set("camera.position", Json{"100", "0", "0"});
    const auto session = rendered(scene);
    const auto reading = session->valueAt({12, 17});
    ASSERT_TRUE(reading);
    EXPECT_NEAR(reading->position.x, 2.0, 1e-9);
    // In the grid's own frame x is c * x + s * y.
    EXPECT_NEAR(reading->values.at(0), c * 2.0 + s * reading->position.y, 1e-5);
}

TEST(VolumeSlice, renderers_of_surfaces_say_that_they_show_none) {
    scene::Scene scene = rampScene("eam");
    setAll(scene, {{"subject.slice_x", "true"}});
    EXPECT_TRUE(rendered(scene)->notes().empty());
    setAll(scene, {{"renderer.type", "raymarch"}});
    EXPECT_FALSE(rendered(scene)->notes().empty());
}

} // namespace
} // namespace apeiron::test
