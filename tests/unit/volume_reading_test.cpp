#include "support.hpp"
#include "volume/generators.hpp"
#include "volume/reading.hpp"
#include "volume/voxels.hpp"

#include <cmath>
#include <limits>

namespace apeiron::volume {
namespace {

/// 3 + 2x - y + 0.5z + xyz/8 of the voxel's indices: what trilinear interpolation gives back exactly.
double trilinear(glm::dvec3 p) {
    return 3.0 + 2.0 * p.x - p.y + 0.5 * p.z + p.x * p.y * p.z / 8.0;
}

Volume trilinearVolume() {
    Volume volume = makeVolume({5, 4, 3}, VoxelType::Float32, 2);
    auto* voxel = mutableVoxels<float>(volume);
    for (int channel = 0; channel < 2; ++channel)
        for (int z = 0; z < 3; ++z)
            for (int y = 0; y < 4; ++y)
                for (int x = 0; x < 5; ++x)
                    *voxel++ = static_cast<float>((channel == 0 ? 1.0 : -10.0) * trilinear({x, y, z}));
    volume.slope = 2.0;
    volume.intercept = -7.0;
    volume.unit = "HU";
    volume.channelNames = {"one", "two"};
    return volume;
}

TEST(VolumeReading, is_linear_between_voxels_with_slope_and_intercept) {
    const Volume volume = trilinearVolume();
    for (const glm::dvec3 index :
         {glm::dvec3(0, 0, 0), glm::dvec3(4, 3, 2), glm::dvec3(1.25, 2.5, 0.125), glm::dvec3(3.999, 0.001, 1.5)}) {
        const auto reading = readingAtIndex(volume, index);
        ASSERT_TRUE(reading);
        // Voxels are single floats: values up to 200, of 24 bits.
        EXPECT_NEAR(reading->values.at(0), 2.0 * trilinear(index) - 7.0, 1e-5);
        EXPECT_NEAR(reading->values.at(1), -20.0 * trilinear(index) - 7.0, 1e-4);
        EXPECT_EQ(reading->voxel, glm::ivec3(glm::floor(index + 0.5)));
    }
    const auto nearest = readingAtIndex(volume, {1.3, 2.6, 0.4}, 0, Between::Nearest);
    ASSERT_TRUE(nearest);
    EXPECT_EQ(nearest->values.at(0), valueAt(volume, {1, 3, 0}));
    EXPECT_EQ(nearest->unit, "HU");
    EXPECT_EQ(nearest->names, (std::vector<std::string>{"one", "two"}));
}

TEST(VolumeReading, stays_as_it_is_up_to_the_border_and_ends_there) {
    const Volume volume = trilinearVolume();
    const auto border = readingAtIndex(volume, {-0.5, 3.5, 2.5});
    ASSERT_TRUE(border);
    EXPECT_EQ(border->values.at(0), valueAt(volume, {0, 3, 2}));
    EXPECT_EQ(border->voxel, glm::ivec3(0, 3, 2));
    for (const glm::dvec3 index : {glm::dvec3(-0.501, 0, 0), glm::dvec3(0, 3.501, 0), glm::dvec3(0, 0, 2.501),
                                   glm::dvec3(0, std::numeric_limits<double>::quiet_NaN(), 0)})
        EXPECT_FALSE(readingAtIndex(volume, index));
}

TEST(VolumeReading, is_found_in_an_oblique_and_sheared_world) {
    Volume volume = trilinearVolume();
    volume.indexToWorld = {{0.6, 0.8, 0, 0}, {-1.6, 1.2, 0.3, 0}, {0, 0.1, -2.5, 0}, {-30, 40, 55, 1}};
    const glm::dvec3 index(2.5, 1.75, 0.5);
    const glm::dvec3 world(volume.indexToWorld * glm::dvec4(index, 1.0));
    const auto reading = readingAt(volume, world);
    ASSERT_TRUE(reading);
    EXPECT_NEAR(reading->values.at(0), 2.0 * trilinear(index) - 7.0, 1e-5);
    EXPECT_LT(glm::distance(reading->position, world), 1e-12 * glm::length(world));
    EXPECT_FALSE(readingAt(volume, world + glm::dvec3(0, 0, 100)));
}

TEST(VolumeReading, of_the_marschner_lobb_signal_is_the_signal_at_its_voxels) {
    const Volume volume = marschnerLobb(41);
    const double half = 0.5 * kGeneratedExtent; // voxels' boxes fill [-1, 1]³
    const glm::dvec3 centre(volume.indexToWorld * glm::dvec4(10, 20, 30, 1));
    const auto reading = readingAt(volume, centre);
    ASSERT_TRUE(reading);
    EXPECT_EQ(reading->voxel, glm::ivec3(10, 20, 30));
    EXPECT_EQ(reading->values.at(0), valueAt(volume, {10, 20, 30}));
    EXPECT_NEAR(reading->values.at(0), marschnerLobbValue(centre / half), 1e-6) << "single floats in [0, 1]";
}

TEST(VolumeReading, of_the_head_phantom_is_in_hounsfield_units) {
    const Volume volume = sheppLogan(64);
    const auto brain = readingAt(volume, {0, 0, 0});
    ASSERT_TRUE(brain);
    EXPECT_EQ(brain->unit, "HU");
    EXPECT_DOUBLE_EQ(brain->values.at(0), 20.0); // Kak & Slaney's table: 1.02 times water
}

TEST(VolumeReading, leaves_out_what_has_no_part_in_it_and_says_where_a_value_is_no_number) {
    Volume volume = makeVolume({2, 1, 1}, VoxelType::Float32);
    mutableVoxels<float>(volume)[0] = 4.0F;
    mutableVoxels<float>(volume)[1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(readingAtIndex(volume, {0, 0, 0})->values.at(0), 4.0);
    const auto between = readingAtIndex(volume, {0.5, 0, 0});
    EXPECT_TRUE(std::isnan(between->values.at(0)));
    EXPECT_EQ(toJson(*between).dump(),
              R"({"position":[0.5,0.0,0.0],"voxel":[1,0,0],"unit":"","values":[{"name":"","value":null}]})");
}

TEST(VolumeReading, knows_points_of_time) {
    Volume volume = makeVolume({1, 1, 1}, VoxelType::UInt8, 1, 3);
    for (std::size_t t = 0; t < 3; ++t)
        mutableVoxels<std::uint8_t>(volume)[t] = static_cast<std::uint8_t>(10 * t);
    EXPECT_EQ(readingAtIndex(volume, {0, 0, 0}, 2)->values.at(0), 20.0);
}

} // namespace
} // namespace apeiron::volume
