#include "../unit/support.hpp"
#include "io/volume_file.hpp"
#include "io/volume_kind.hpp"
#include "io/volumes/volumes.hpp"
#include "volume/voxels.hpp"
#include "volume_files.hpp"

#include <fmt/format.h>

#include <sys/stat.h>

// What front ends use: bare voxels, and files by way of the reader's process.
namespace apeiron::io {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::HasSubstr;
using volume::Volume;
using volume::VoxelType;

class VolumeFileTest : public testing::Test {
  protected:
    Volume readRaw(const std::string& form, std::string_view bytes) const {
        writeFile(folder_ / "a.raw", bytes);
        return readVolume({folder_ / "a.raw", form, {}, 0});
    }
    std::string problemOf(const std::filesystem::path& file, std::size_t memory = 0) const {
        return messageOf([&] { readVolume({file, {}, {}, memory}); });
    }

    TemporaryFolder folder_;
};

TEST_F(VolumeFileTest, bare_voxels_are_read_in_both_byte_orders_behind_their_header) {
    const std::vector<std::uint16_t> values{1, 65535, 256, 7, 8, 9};
    for (const bool big : {false, true}) {
        const Volume volume = readRaw(fmt::format("3x2x1:uint16:{}:offset=5:spacing=1x2x3", big ? "big" : "little"),
                                      "12345" + bytesOf(values, big));
        EXPECT_EQ(bytesOf(volume), bytesOf(values));
        EXPECT_EQ(volume::spacing(volume), glm::dvec3(1, 2, 3));
        EXPECT_EQ(placeOf(volume, {1, 0.5, 0}), glm::dvec3(0)) << "the middle is the world's origin";
    }
    const Volume halves = readRaw("2x1x1:float16", bytesOf(std::vector<std::uint16_t>{0x3C00, 0xC000}));
    EXPECT_EQ(volume::valueAt(halves, {0, 0, 0}), 1.0);
    EXPECT_EQ(volume::valueAt(halves, {1, 0, 0}), -2.0);
    const Volume more = readRaw("1x1x1:uint8:channels=2:times=2", "abcd");
    EXPECT_EQ(volume::valueAt(more, {0, 0, 0}, 1, 1), 'd');
}

TEST_F(VolumeFileTest, bare_voxels_of_another_number_are_told) {
    EXPECT_THAT(messageOf([&] { readRaw("4x4x4:uint8", "few"); }),
                HasSubstr("a.raw: has 3 bytes, and 4x4x4:uint8 needs 64"));
    EXPECT_TRUE(says(readRaw("1x1x1:uint8", "few"), "2 bytes behind the voxels were left out"));
    EXPECT_THAT(messageOf([&] { readRaw("0x4x4:uint8", "few"); }), HasSubstr("cannot be"));
    EXPECT_THAT(messageOf([&] { readRaw("4x4:uint8", "few"); }), HasSubstr("is not three sizes"));
    EXPECT_THAT(messageOf([&] { readRaw("4x4x4:uint9", "few"); }), HasSubstr("\"uint9\" is none of"));
    EXPECT_THAT(messageOf([&] { readRaw("60000x60000x60000:float32", "few"); }), HasSubstr("need 8.64e+05 GB"));
}

TEST_F(VolumeFileTest, what_the_readers_process_sends_is_what_the_reader_read) {
    Nifti header;
    header.dim = {4, 3, 2, 2};
    header.datatype = 4;
    header.bits = 16;
    header.pixdim = {2, 3, 4, 1.5F};
    header.sform = {0, -3, 0, 10, 2, 0, 0, 20, 0, 0, 4, 30};
    std::vector<std::int16_t> values;
    for (int i = 0; i < 48; ++i)
        values.push_back(static_cast<std::int16_t>(i * 3001));
    writeFile(folder_ / "a.nii", niftiFile(header, bytesOf(values)));
    const Volume here = volumes::read({folder_ / "a.nii", {}, {}, 0}, 1 << 20);
    const Volume sent = readVolume({folder_ / "a.nii", {}, {}, 0});
    EXPECT_EQ(bytesOf(sent), bytesOf(values));
    EXPECT_EQ(sent.size, here.size);
    EXPECT_EQ(sent.timePoints, 2);
    EXPECT_EQ(sent.timeStep, here.timeStep);
    EXPECT_EQ(sent.indexToWorld, here.indexToWorld);
    EXPECT_EQ(sent.type, here.type);
    EXPECT_TRUE(here.oriented);
    EXPECT_TRUE(sent.oriented);
    EXPECT_EQ(sent.name, (folder_ / "a.nii").string());
    EXPECT_EQ(sent.messages, here.messages);
}

TEST_F(VolumeFileTest, problems_are_one_line_that_begins_with_the_file) {
    writeFile(folder_ / "a.nrrd", "NRRD0004\ntype: nonsense\n\n");
    const std::string problem = problemOf(folder_ / "a.nrrd");
    EXPECT_THAT(problem, testing::StartsWith((folder_ / "a.nrrd").string() + ": "));
    EXPECT_EQ(problem.find('\n'), std::string::npos);
    EXPECT_THAT(problemOf(folder_ / "none.nrrd"), HasSubstr("there is no such file"));
    writeFile(folder_ / "a.txt", "only text");
    EXPECT_THAT(problemOf(folder_ / "a.txt"), HasSubstr("is no volume that can be read"));
    std::filesystem::create_directory(folder_ / "empty");
    EXPECT_THAT(problemOf(folder_ / "empty"), HasSubstr("is a folder without DICOM or TIFF files"));
}

TEST_F(VolumeFileTest, no_more_memory_than_allowed_is_taken) {
    writeFile(folder_ / "a.mha", "ObjectType = Image\nNDims = 3\nDimSize = 100 100 100\nElementType = MET_UCHAR\n"
                                 "ElementDataFile = LOCAL\n" +
                                     std::string(1'000'000, 'x'));
    EXPECT_THAT(problemOf(folder_ / "a.mha", 999'999), HasSubstr("asks for 0.001 GB of memory"));
    EXPECT_EQ(problemOf(folder_ / "a.mha", 1'000'000), "no error");
}

TEST_F(VolumeFileTest, kinds_are_known_by_their_first_bytes) {
    const auto kindOf = [&](const std::string& name, const std::string& bytes) {
        writeFile(folder_ / name, bytes);
        return volumeKind(folder_ / name);
    };
    EXPECT_EQ(kindOf("a", "NRRD0005\n"), VolumeKind::Nrrd);
    EXPECT_EQ(kindOf("a", "ObjectType = Image\n"), VolumeKind::MetaImage);
    EXPECT_EQ(kindOf("a.MHD", "NDims = 3\n"), VolumeKind::MetaImage);
    EXPECT_EQ(kindOf("a", niftiFile({}, "")), VolumeKind::Nifti);
    EXPECT_EQ(kindOf("a.nii.gz", gzip("x")), VolumeKind::Nifti);
    EXPECT_EQ(kindOf("a.gz", gzip("x")), std::nullopt);
    EXPECT_EQ(kindOf("a", dicomFile({})), VolumeKind::Dicom);
    EXPECT_EQ(kindOf("a", tiffFile({})), VolumeKind::Tiff);
    EXPECT_EQ(kindOf("a", "text"), std::nullopt);
    EXPECT_EQ(kindOf("a", ""), std::nullopt);
    // Something that would have to be waited for.
    ASSERT_EQ(mkfifo((folder_ / "pipe.nrrd").c_str(), 0600), 0);
    EXPECT_EQ(volumeKind(folder_ / "pipe.nrrd"), std::nullopt);
}

} // namespace
} // namespace apeiron::io
