#include "../unit/support.hpp"
#include "io/volumes/volumes.hpp"
#include "volume_files.hpp"

#include <openvdb/openvdb.h>

namespace apeiron::io::volumes {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::ElementsAre;
using testing::HasSubstr;
using volume::Volume;

constexpr std::size_t kLimit = std::size_t{1} << 26;

class VdbTest : public testing::Test {
  protected:
    VdbTest() { openvdb::initialize(); }
    Volume read(const openvdb::GridPtrVec& grids, const std::string& name = {}, std::size_t limit = kLimit) const {
        const std::filesystem::path file = folder_ / "a.vdb";
        openvdb::io::File(file.string()).write(grids);
        return volumes::read({file, {}, name, 0}, limit);
    }

    TemporaryFolder folder_;
};

openvdb::FloatGrid::Ptr floats(const std::string& name, const openvdb::Coord& first, const openvdb::Coord& last) {
    auto grid = openvdb::FloatGrid::create(-1.0F);
    grid->setName(name);
    grid->getAccessor().setValue(first, 2.5F);
    grid->getAccessor().setValue(last, 3.5F);
    return grid;
}

TEST_F(VdbTest, active_voxels_are_dense_in_their_box_and_the_rest_is_background) {
    const auto grid = floats("density", {-2, 5, 10}, {1, 7, 10});
    auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    transform->postTranslate({1, 2, 3});
    grid->setTransform(transform);
    const Volume volume = read({grid});
    EXPECT_EQ(volume.size, glm::ivec3(4, 3, 1));
    EXPECT_EQ(volume.type, volume::VoxelType::Float32);
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 0}), 2.5);
    EXPECT_EQ(volume::valueAt(volume, {3, 2, 0}), 3.5);
    EXPECT_EQ(volume::valueAt(volume, {1, 1, 0}), -1);
    EXPECT_EQ(placeOf(volume, {0, 0, 0}), glm::dvec3(0, 4.5, 8));
    EXPECT_EQ(placeOf(volume, {2, 1, 0}), glm::dvec3(1, 5, 8));
    EXPECT_TRUE(volume.messages.empty());
}

TEST_F(VdbTest, grids_are_chosen_by_name_and_the_others_are_told) {
    const auto a = floats("density", {0, 0, 0}, {1, 0, 0});
    const auto b = floats("heat", {0, 0, 0}, {2, 0, 0});
    EXPECT_EQ(read({a, b}, "heat").size.x, 3);
    const Volume first = read({a, b});
    EXPECT_EQ(first.size.x, 2);
    EXPECT_TRUE(says(first, "the grid \"density\" of 2 is shown; all: \"density\", \"heat\""));
    EXPECT_THAT(messageOf([&] { read({a, b}, "smoke"); }), HasSubstr("has no grid \"smoke\""));
}

TEST_F(VdbTest, vectors_are_three_channels) {
    auto grid = openvdb::Vec3SGrid::create();
    grid->setName("velocity");
    grid->getAccessor().setValue({0, 0, 0}, {1, 2, 3});
    grid->getAccessor().setValue({1, 0, 0}, {4, 5, 6});
    const Volume volume = read({grid});
    ASSERT_EQ(volume.channels, 3);
    EXPECT_THAT(volume.channelNames, ElementsAre("x", "y", "z"));
    for (int channel = 0; channel < 3; ++channel)
        for (int x = 0; x < 2; ++x)
            EXPECT_EQ(volume::valueAt(volume, {x, 0, 0}, channel), 1 + channel + 3 * x);
}

TEST_F(VdbTest, what_cannot_be_shown_is_refused) {
    EXPECT_THAT(messageOf([&] { read({openvdb::FloatGrid::create()}); }), HasSubstr("has no active voxels"));
    EXPECT_THAT(messageOf([&] { read({openvdb::MaskGrid::create()}); }), HasSubstr("none of its grids holds numbers"));
    // Two voxels that are far apart: sparse in the file, dense in memory.
    const auto wide = floats("density", {0, 0, 0}, {60000, 60000, 60000});
    EXPECT_THAT(messageOf([&] { read({wide}); }), HasSubstr("asks for 8.64e+05 GB of memory"));
}

} // namespace
} // namespace apeiron::io::volumes
