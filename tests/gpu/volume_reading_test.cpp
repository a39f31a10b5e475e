// The numbers behind a volume's picture: values where a pixel shows it, histograms, what editors begin with.

#include "volume_support.hpp"

#include "volume/source.hpp"

#include <cmath>

namespace apeiron::test {
namespace {

/// Value x + 1000 y + 1e6 z of the place [mm]: the value tells the place.
double tellingPlace(glm::dvec3 p, int channel) {
    return (channel == 0 ? 1.0 : -1.0) * (p.x + 1e3 * p.y + 1e6 * p.z);
}

TEST(VolumeReadingGpu, tells_value_place_and_voxel_of_what_is_seen) {
    provide("telling", 16, tellingPlace, 2);
    // A box from -8 to 8 mm, solid where one of the channels is in the upper half, from the front and above.
    scene::Scene scene = volumeScene("telling", 30.0, {40, 40});
    setAll(scene, {{"renderer.type", "iso"},
                   {"renderer.values", "0.5,0,0,0"},
                   {"renderer.opacities", "1,0,0,0"},
                   {"subject.transfer", "grey"},
                   {"output.samples", "1"}});
    scene.set("camera.position", Json{"0", "-60", "80"});
    const auto session = rendered(scene);
    int seen = 0;
    for (int y = 2; y < 40; y += 4) {
        for (int x = 2; x < 40; x += 4) {
            const auto point = session->pointAt({x, y});
            const auto reading = session->valueAt({x, y});
            ASSERT_EQ(point.has_value(), reading.has_value()) << x << ", " << y;
            if (!reading) continue;
            ++seen;
            // Rays go through a random point of the pixel: the box's faces are where they are to less than a pixel.
            const glm::dvec3 place = glm::clamp(*point + glm::dvec3(0, -60, 80), glm::dvec3(-8.0), glm::dvec3(8.0));
            EXPECT_LT(glm::distance(reading->position, place), 1e-9);
            EXPECT_EQ(reading->voxel, glm::clamp(glm::ivec3(glm::floor(place + 8.0)), glm::ivec3(0), glm::ivec3(15)));
            // Linear between centres, and constant beyond the outermost. Voxels are single floats up to 8e6: half a
            // unit.
            const glm::dvec3 inside = glm::clamp(place, glm::dvec3(-7.5), glm::dvec3(7.5));
            EXPECT_NEAR(reading->values.at(0), tellingPlace(inside, 0), 1.0);
            EXPECT_NEAR(reading->values.at(1), tellingPlace(inside, 1), 1.0);
        }
    }
    EXPECT_GT(seen, 10) << "nothing was seen, nothing compared";
    EXPECT_LT(seen, 90) << "the background has values";
}

TEST(VolumeReadingGpu, tells_the_isovalue_on_an_isosurface) {
    // A ball: values fall from its centre on.
    provide("ball", 24, [](glm::dvec3 p, int) { return 20.0 - glm::length(p); });
    scene::Scene scene = volumeScene("ball", 24.0, {24, 24});
    setAll(scene, {{"renderer.type", "raymarch"},
                   {"output.samples", "1"},
                   {"subject.iso_units", "value"},
                   {"subject.isovalue", "12"}});
    const auto session = rendered(scene);
    const auto middle = session->valueAt({12, 12});
    ASSERT_TRUE(middle);
    // A ray through the pixel's random point of one sample, seen at half a pixel (0.5 mm) from its middle at most: the
    // ball curves away by 0.5²/(2·8) = 0.02 mm.
    EXPECT_NEAR(middle->values.at(0), 12.0, 0.1);
    EXPECT_LT(middle->position.y, -7.0) << "its front";
    EXPECT_FALSE(session->valueAt({0, 0})) << "its corner shows background";
}

TEST(VolumeReadingGpu, in_perspective_is_where_the_ray_is) {
    provide("ball", 24, [](glm::dvec3 p, int) { return 20.0 - glm::length(p); });
    scene::Scene scene = volumeScene("ball", 24.0, {33, 33});
    setAll(scene, {{"renderer.type", "raymarch"},
                   {"output.samples", "1"},
                   {"camera.projection", "perspective"},
                   {"subject.iso_units", "value"},
                   {"subject.isovalue", "11"}});
    const auto session = rendered(scene);
    for (const glm::ivec2 pixel : {glm::ivec2(16, 16), glm::ivec2(10, 20), glm::ivec2(22, 13)}) {
        const auto reading = session->valueAt(pixel);
        ASSERT_TRUE(reading);
        // Half a pixel is 0.36 mm; off the middle the surface is inclined by up to 45 degrees.
        EXPECT_NEAR(reading->values.at(0), 11.0, 0.5);
    }
}

TEST(VolumeReadingGpu, is_nothing_for_other_subjects_and_for_background) {
    const auto sphere = rendered(darkSphere({8, 8}));
    EXPECT_TRUE(sphere->pointAt({4, 4}));
    EXPECT_FALSE(sphere->valueAt({4, 4}));
    EXPECT_FALSE(sphere->volume());
    EXPECT_FALSE(sphere->histogram(0, 16));
}

TEST(VolumeReadingGpu, histograms_count_the_voxels_of_a_channel) {
    // Half of it 0, half of it 1: the border between is two voxels thick for central differences, of slope 1/2.
    provide(
        "halves", 8, [](glm::dvec3 p, int channel) { return (p.x > 0 ? 1.0 : 0.0) + 5.0 * channel; }, 2);
    scene::Scene scene = volumeScene("halves", 10.0, {8, 8});
    scene.set("output.samples", Json(1));
    const auto session = rendered(scene);
    const auto values = session->histogram(1, 2);
    ASSERT_TRUE(values);
    EXPECT_EQ(values->voxels, 512);
    EXPECT_EQ(values->at(0), 256);
    EXPECT_EQ(values->at(1), 256);
    EXPECT_DOUBLE_EQ(values->low, 5.0);
    EXPECT_DOUBLE_EQ(values->high, 6.0);
    const auto joint = session->histogram(0, 2, 4);
    ASSERT_TRUE(joint);
    for (int side = 0; side < 2; ++side) {
        EXPECT_EQ(joint->at(side, 0), 192) << "flat";
        EXPECT_EQ(joint->at(side, 3), 64) << "the border";
    }
    EXPECT_NE(errorOf([&] { session->histogram(2, 4); })->what(), std::string());
    EXPECT_TRUE(errorOf([&] { session->histogram(-1, 4); }));
    EXPECT_TRUE(errorOf([&] { session->histogram(0, 0); }));
    EXPECT_TRUE(errorOf([&] { session->histogram(0, 1 << 20, 1 << 20); }));
}

TEST(VolumeReadingGpu, what_an_editor_begins_with_gives_the_same_picture) {
    scene::Scene scene(session::catalogue());
    scene.set("subject", Json{{"type", "volume"}, {"source", "hydrogen"}, {"resolution", 24}});
    setAll(scene, {{"renderer.type", "mip"}, {"output.width", "48"}, {"output.height", "32"}, {"output.samples", "1"}});
    for (const char* transfer : {"auto", "boundaries", "microscopy"}) {
        scene.set("subject.transfer", std::string_view(transfer));
        const auto session = rendered(scene);
        const Image<float> byName = session->layers().radiance;
        const Json data = toJson(*session->volume());
        ASSERT_EQ(data.at("channels").size(), 1U);
        session->set("subject.transfer", data.at("channels").at(0).at("transfer"));
        finish(*session);
        // Windows are written out as values in double: an entry of the table may round to the next of 24 bits.
        EXPECT_LT(largestDifference(byName, session->layers().radiance), 1e-4) << transfer;
    }
}

} // namespace
} // namespace apeiron::test
