#include "../unit/support.hpp"
#include "io/volume_file.hpp"
#include "volume/orientation.hpp"
#include "volume/statistics.hpp"
#include "volume_files.hpp"

#include <cmath>

// Real files, which are not in this repository: a folder shared/data beside it, or beside a folder around it.
namespace apeiron::io {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::ElementsAre;
using volume::Volume;
using volume::VoxelType;

std::filesystem::path dataFolder() {
    const std::filesystem::path source = APEIRON_SOURCE_DIR;
    for (std::filesystem::path folder = source.parent_path(); folder != folder.parent_path();
         folder = folder.parent_path())
        if (std::filesystem::exists(folder / "shared/data/README.txt")) return folder / "shared/data";
    return {};
}

class RealDataTest : public testing::Test {
  protected:
    void SetUp() override {
        if (dataFolder().empty()) GTEST_SKIP() << "there is no folder shared/data beside this repository";
    }
    static Volume read(const std::string& name) { return readVolume({dataFolder() / name, {}, {}, 0}); }
};

void expectLike(const Volume& volume, glm::ivec3 size, VoxelType type, glm::dvec3 spacing, double low, double high) {
    EXPECT_EQ(volume.size, size);
    EXPECT_EQ(volume.type, type);
    // Headers have six digits of the spacing.
    EXPECT_LT(glm::length(volume::spacing(volume) - spacing), 1e-3 * glm::length(spacing));
    const volume::ChannelStatistics values = volume::statistics(volume);
    EXPECT_EQ(values.min, low);
    EXPECT_EQ(values.max, high);
}

TEST_F(RealDataTest, bytes_of_nifti) {
    expectLike(read("bonsai.nii.gz"), {256, 256, 256}, VoxelType::UInt8, {1, 1, 1}, 0, 255);
    expectLike(read("engine.nii.gz"), {256, 256, 128}, VoxelType::UInt8, {1, 1, 1}, 0, 255);
    expectLike(read("fuel.nii.gz"), {64, 33, 32}, VoxelType::UInt8, {1, 1, 1}, 0, 255);
    expectLike(read("T1.nii.gz"), {124, 160, 140}, VoxelType::UInt8, {1, 1, 1}, 0, 252);
}

TEST_F(RealDataTest, sixteen_bits_of_metaimage) {
    const Volume head = read("headsq_quarter.mhd");
    expectLike(head, {64, 64, 93}, VoxelType::Int16, {3.2, 3.2, 1.5}, 0, 3926);
    // The same voxels without the header.
    const Volume raw =
        readVolume({dataFolder() / "headsq_quarter_64x64x93_int16le.raw", "64x64x93:int16:spacing=3.2x3.2x1.5", {}, 0});
    EXPECT_EQ(bytesOf(raw), bytesOf(head));
}

TEST_F(RealDataTest, nrrd_and_nifti_of_the_same_brain_agree_at_every_place_in_the_world) {
    const Volume nifti = read("FLAIR.nii.gz");
    const Volume nrrd = read("FLAIR.nrrd");
    ASSERT_EQ(nifti.size, nrrd.size);
    std::size_t different = 0;
    double farthest = 0;
    const glm::dmat4 fromWorld = glm::inverse(nifti.indexToWorld);
    for (int z = 0; z < nrrd.size.z; ++z)
        for (int y = 0; y < nrrd.size.y; ++y)
            for (int x = 0; x < nrrd.size.x; ++x) {
                const glm::dvec3 place(fromWorld * glm::dvec4(placeOf(nrrd, {x, y, z}), 1));
                const glm::ivec3 voxel = glm::round(place);
                farthest = std::max(farthest, glm::length(place - glm::dvec3(voxel)));
                if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
                    glm::any(glm::greaterThanEqual(voxel, nifti.size))) {
                    ++different;
                    continue;
                }
                if (volume::valueAt(nrrd, {x, y, z}) != volume::valueAt(nifti, voxel)) ++different;
            }
    EXPECT_EQ(different, 0U);
    EXPECT_LT(farthest, 1e-3); // both headers have single precision
}

TEST_F(RealDataTest, brains_lie_in_the_same_place) {
    EXPECT_EQ(read("T1.nii.gz").indexToWorld, read("FLAIR.nii.gz").indexToWorld);
    EXPECT_FALSE(volume::orientationOf(read("T1.nii.gz")).mirrored);
}

TEST_F(RealDataTest, a_ct_with_a_tilted_gantry_and_uneven_slices_is_sheared_and_resampled) {
    const Volume head = read("dcm_ct_head_GE");
    EXPECT_EQ(glm::ivec2(head.size), glm::ivec2(512, 512));
    EXPECT_GT(head.size.z, 28);
    EXPECT_EQ(head.type, VoxelType::Int16);
    EXPECT_EQ(head.modality, volume::Modality::Ct);
    EXPECT_EQ(head.unit, "HU");
    EXPECT_TRUE(says(head, "tilted by 18.5 degrees"));
    EXPECT_TRUE(says(head, "resampled linearly from 28"));
    EXPECT_NEAR(volume::orientationOf(head).shear, 18.5, 0.1);
    EXPECT_NEAR(volume::spacing(head).x, 0.488, 1e-3);
    // In Hounsfield units: air, and bone.
    const volume::ChannelStatistics values = volume::statistics(head);
    EXPECT_LE(values.min, -1000);
    EXPECT_GT(values.max, 1500);
}

TEST_F(RealDataTest, cells_in_four_colours) {
    const Volume cells = read("AICS-10_5_5_4ch.ome.tif");
    EXPECT_EQ(cells.size, glm::ivec3(204, 292, 65));
    EXPECT_EQ(cells.channels, 4);
    EXPECT_EQ(cells.type, VoxelType::UInt8);
    EXPECT_EQ(cells.modality, volume::Modality::Microscopy);
    EXPECT_THAT(cells.channelNames, ElementsAre("TL Brightfield", "SEG_STRUCT", "SEG_Memb", "SEG_DNA"));
    // Micrometres, in the world's millimetres.
    EXPECT_LT(glm::length(1e3 * volume::spacing(cells) - glm::dvec3(0.0974, 0.110, 0.29)), 1e-3);
}

TEST_F(RealDataTest, ome_sample_of_three_channels) {
    const Volume sample = read("multi-channel-z-series.ome.tif");
    EXPECT_EQ(sample.size, glm::ivec3(439, 167, 5));
    EXPECT_EQ(sample.channels, 3);
    EXPECT_EQ(sample.type, VoxelType::Int8);
}

} // namespace
} // namespace apeiron::io
