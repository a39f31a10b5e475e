#include "../unit/support.hpp"
#include "io/volumes/volumes.hpp"
#include "volume_files.hpp"

#include <fmt/format.h>

#include <limits>
#include <numeric>

// NRRD, MetaImage and NIfTI.
namespace apeiron::io::volumes {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::HasSubstr;
using volume::Volume;
using volume::VoxelType;

constexpr std::size_t kLimit = std::size_t{1} << 26;
constexpr glm::ivec3 kSize{4, 3, 2};
constexpr std::size_t kVoxels = 24;

/// Every bit is used: extremes first, then numbers without a pattern.
template <class T> std::vector<T> numbers(std::size_t count = kVoxels) {
    std::vector<T> values{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max(), T{0}, T{1}};
    for (std::uint32_t i = 4; i < count; ++i) {
        if constexpr (std::is_floating_point_v<T>) {
            values.push_back(static_cast<T>(i) * static_cast<T>(-1.1e-3));
        } else {
            values.push_back(static_cast<T>(i * 2654435761U));
        }
    }
    return values;
}

template <class T> struct Kind {
    const char* nrrd;
    const char* meta;
    std::int16_t nifti;
    VoxelType type;
};

/// Calls `test` with numbers of every type that is kept as it is.
template <class Test> void forKinds(const Test& test) {
    test(numbers<std::uint8_t>(), Kind<std::uint8_t>{"uchar", "MET_UCHAR", 2, VoxelType::UInt8});
    test(numbers<std::int8_t>(), Kind<std::int8_t>{"signed char", "MET_CHAR", 256, VoxelType::Int8});
    test(numbers<std::uint16_t>(), Kind<std::uint16_t>{"ushort", "MET_USHORT", 512, VoxelType::UInt16});
    test(numbers<std::int16_t>(), Kind<std::int16_t>{"short", "MET_SHORT", 4, VoxelType::Int16});
    test(numbers<float>(), Kind<float>{"float", "MET_FLOAT", 16, VoxelType::Float32});
}

class ItkFileTest : public testing::Test {
  protected:
    Volume readBytes(const std::string& name, std::string_view bytes) const {
        writeFile(folder_ / name, bytes);
        return volumes::read({folder_ / name, {}, {}, 0}, kLimit);
    }
    std::string problemOf(const std::string& name, std::string_view bytes) const {
        return messageOf([&] { readBytes(name, bytes); });
    }

    TemporaryFolder folder_;
};

std::string nrrd(const std::string& type, const std::string& more, std::string_view voxels,
                 const std::string& sizes = "4 3 2") {
    const auto dimension = 1 + std::count(sizes.begin(), sizes.end(), ' ');
    return fmt::format("NRRD0004\ntype: {}\ndimension: {}\nsizes: {}\n{}\n", type, dimension, sizes, more) +
           std::string(voxels);
}

std::string metaImage(const std::string& type, const std::string& more, std::string_view voxels,
                      const std::string& sizes = "4 3 2", const std::string& file = "LOCAL") {
    const auto dimension = 1 + std::count(sizes.begin(), sizes.end(), ' ');
    return fmt::format("ObjectType = Image\nNDims = {}\nDimSize = {}\n{}BinaryData = True\nElementType = "
                       "{}\nElementDataFile = {}\n",
                       dimension, sizes, more, type, file) +
           std::string(voxels);
}

TEST_F(ItkFileTest, nrrd_keeps_every_bit_of_every_type_in_both_byte_orders) {
    forKinds([&](const auto& values, const auto& kind) {
        for (const bool big : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", kind.nrrd, big ? "big" : "little"));
            const std::string endian = big ? "endian: big\n" : "endian: little\n";
            const std::string bytes = bytesOf(values, big);
            for (const bool zipped : {false, true}) {
                const Volume volume =
                    readBytes("a.nrrd", nrrd(kind.nrrd, endian + (zipped ? "encoding: gzip\n" : "encoding: raw\n"),
                                             zipped ? gzip(bytes) : bytes));
                EXPECT_EQ(volume.size, kSize);
                EXPECT_EQ(volume.type, kind.type);
                EXPECT_EQ(bytesOf(volume), bytesOf(values));
            }
        }
    });
}

TEST_F(ItkFileTest, nrrd_may_be_text_and_lie_in_a_file_of_its_own) {
    const std::vector<std::int16_t> values{-5, 300, 7, 0, 1, 2};
    const Volume text = readBytes("a.nrrd", nrrd("short", "encoding: text\n", "-5 300 7 0 1 2\n", "3 2 1"));
    EXPECT_EQ(bytesOf(text), bytesOf(values));
    writeFile(folder_ / "voxels.raw", bytesOf(values));
    const Volume apart =
        readBytes("a.nhdr", nrrd("short", "endian: little\nencoding: raw\ndata file: voxels.raw\n", "", "3 2 1"));
    EXPECT_EQ(bytesOf(apart), bytesOf(values));
}

TEST_F(ItkFileTest, nrrd_spacing_and_oblique_mirrored_axes_become_one_map) {
    const std::string place = "space directions: (0.6,0.8,0) (-1.6,1.2,0) (0,0,-3)\nspace origin: (10,20,30)\n";
    const std::string bytes(kVoxels, 'x');
    const Volume lps =
        readBytes("a.nrrd", nrrd("uchar", "space: left-posterior-superior\nencoding: raw\n" + place, bytes));
    EXPECT_EQ(placeOf(lps, {0, 0, 0}), glm::dvec3(10, 20, 30));
    // Directions pass through ITK's orthonormalised matrix: a few rounding errors of double precision.
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-12; };
    EXPECT_PRED2(near, placeOf(lps, {1, 0, 0}), glm::dvec3(10.6, 20.8, 30));
    EXPECT_PRED2(near, placeOf(lps, {0, 1, 0}), glm::dvec3(8.4, 21.2, 30));
    EXPECT_PRED2(near, placeOf(lps, {0, 0, 1}), glm::dvec3(10, 20, 27));
    EXPECT_PRED2(near, volume::spacing(lps), glm::dvec3(1, 2, 3));
    // RAS is turned about z: x and y change their signs.
    const Volume ras =
        readBytes("a.nrrd", nrrd("uchar", "space: right-anterior-superior\nencoding: raw\n" + place, bytes));
    EXPECT_PRED2(near, placeOf(ras, {1, 1, 1}), glm::dvec3(-9, -22, 27));
    const Volume plain = readBytes("a.nrrd", nrrd("uchar", "spacings: 0.5 1.5 2.5\nencoding: raw\n", bytes));
    EXPECT_EQ(volume::spacing(plain), glm::dvec3(0.5, 1.5, 2.5));
}

TEST_F(ItkFileTest, nrrd_axes_that_are_not_space_are_channels) {
    std::vector<std::uint8_t> values(3 * kVoxels);
    std::iota(values.begin(), values.end(), std::uint8_t{0});
    const Volume volume = readBytes(
        "a.nrrd", nrrd("uchar", "kinds: vector domain domain domain\nencoding: raw\n", bytesOf(values), "3 4 3 2"));
    ASSERT_EQ(volume.channels, 3);
    EXPECT_EQ(volume.size, kSize);
    for (int channel = 0; channel < 3; ++channel)
        for (int i = 0; i < static_cast<int>(kVoxels); ++i)
            EXPECT_EQ(volume::valueAt(volume, {i % 4, i / 4 % 3, i / 12}, channel), 3 * i + channel);
    const Volume six = readBytes("a.nrrd", nrrd("uchar", "kinds: vector domain domain domain\nencoding: raw\n",
                                                std::string(6 * kVoxels, 'x'), "6 4 3 2"));
    EXPECT_EQ(six.channels, 4);
    EXPECT_TRUE(says(six, "the first 4 of 6 channels"));
}

TEST_F(ItkFileTest, wide_numbers_are_kept_exactly_where_they_fit_and_say_so_where_not) {
    const auto read = [&]<class T>(const char* type, const std::vector<T>& values) {
        return readBytes("a.nrrd", nrrd(type, "endian: little\nencoding: raw\n", bytesOf(values),
                                        fmt::format("{} 1 1", values.size())));
    };
    const Volume low = read("int", std::vector<std::int32_t>{-32768, 32767, 5});
    EXPECT_EQ(low.type, VoxelType::Int16);
    EXPECT_EQ(bytesOf(low), bytesOf(std::vector<std::int16_t>{-32768, 32767, 5}));
    EXPECT_EQ(read("uint", std::vector<std::uint32_t>{0, 65535}).type, VoxelType::UInt16);
    const Volume wide = read("longlong", std::vector<std::int64_t>{-32769, 16777216});
    EXPECT_EQ(bytesOf(wide), bytesOf(std::vector<float>{-32769, 16777216}));
    EXPECT_TRUE(wide.messages.empty());
    EXPECT_TRUE(says(read("uint", std::vector<std::uint32_t>{16777217}), "rounded to floats of 24 bits"));
    const Volume doubles = read("double", std::vector<double>{0.5, 0.1});
    EXPECT_EQ(bytesOf(doubles), bytesOf(std::vector<float>{0.5F, 0.1F}));
    EXPECT_TRUE(says(doubles, "rounded to floats of 24 bits"));
}

TEST_F(ItkFileTest, metaimage_keeps_every_bit_of_every_type_in_both_byte_orders) {
    forKinds([&](const auto& values, const auto& kind) {
        for (const bool big : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", kind.meta, big ? "big" : "little"));
            const std::string bytes = bytesOf(values, big);
            const std::string order = fmt::format("ElementByteOrderMSB = {}\n", big ? "True" : "False");
            const Volume one = readBytes("a.mha", metaImage(kind.meta, order, bytes));
            EXPECT_EQ(one.size, kSize);
            EXPECT_EQ(one.type, kind.type);
            EXPECT_EQ(bytesOf(one), bytesOf(values));
            writeFile(folder_ / "voxels.raw", bytes);
            const Volume two = readBytes("a.mhd", metaImage(kind.meta, order, "", "4 3 2", "voxels.raw"));
            EXPECT_EQ(bytesOf(two), bytesOf(values));
        }
    });
}

TEST_F(ItkFileTest, metaimage_may_be_compressed) {
    const std::string bytes = bytesOf(numbers<std::int16_t>());
    const std::string stream = zlib(bytes);
    const Volume volume = readBytes(
        "a.mha",
        metaImage("MET_SHORT", fmt::format("CompressedData = True\nCompressedDataSize = {}\n", stream.size()), stream));
    EXPECT_EQ(bytesOf(volume), bytes);
}

TEST_F(ItkFileTest, metaimage_has_spacing_axes_and_offset) {
    // The rows of TransformMatrix are the axes (MetaIO's documentation, "Direction cosines").
    const Volume volume =
        readBytes("a.mha", metaImage("MET_UCHAR",
                                     "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 5 6 7\nElementSpacing = 0.5 2 3\n",
                                     std::string(kVoxels, 'x')));
    EXPECT_EQ(placeOf(volume, {0, 0, 0}), glm::dvec3(5, 6, 7));
    EXPECT_EQ(placeOf(volume, {2, 0, 0}), glm::dvec3(5, 7, 7));
    EXPECT_EQ(placeOf(volume, {0, 1, 0}), glm::dvec3(3, 6, 7));
    EXPECT_EQ(placeOf(volume, {0, 0, 1}), glm::dvec3(5, 6, 10));
    EXPECT_TRUE(volume.oriented);
    EXPECT_FALSE(readBytes("a.mha", metaImage("MET_UCHAR", "", std::string(kVoxels, 'x'))).oriented);
}

TEST_F(ItkFileTest, metaimage_has_channels_and_a_fourth_dimension_is_time) {
    const std::vector<std::uint8_t> pairs{1, 2, 3, 4, 5, 6};
    const Volume two =
        readBytes("a.mha", metaImage("MET_UCHAR", "ElementNumberOfChannels = 2\n", bytesOf(pairs), "3 1 1"));
    EXPECT_EQ(two.channels, 2);
    EXPECT_EQ(bytesOf(two), bytesOf(std::vector<std::uint8_t>{1, 3, 5, 2, 4, 6}));
    std::vector<std::uint8_t> values(5 * kVoxels);
    std::iota(values.begin(), values.end(), std::uint8_t{0});
    const Volume series = readBytes("a.mha", metaImage("MET_UCHAR", "", bytesOf(values), "4 3 2 5"));
    EXPECT_EQ(series.timePoints, 5);
    EXPECT_EQ(volume::valueAt(series, {3, 2, 1}, 0, 4), 119);
}

TEST_F(ItkFileTest, nifti_keeps_every_bit_of_every_type_in_both_byte_orders) {
    forKinds([&](const auto& values, const auto& kind) {
        for (const bool big : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", kind.nifti, big ? "big" : "little"));
            Nifti header;
            header.dim = {4, 3, 2};
            header.datatype = kind.nifti;
            header.bits = static_cast<std::int16_t>(8 * sizeof(values.front()));
            header.bigEndian = big;
            const std::string file = niftiFile(header, bytesOf(values, big));
            for (const bool zipped : {false, true}) {
                const Volume volume = readBytes(zipped ? "a.nii.gz" : "a.nii", zipped ? gzip(file) : file);
                EXPECT_EQ(volume.size, kSize);
                EXPECT_EQ(volume.type, kind.type);
                EXPECT_EQ(bytesOf(volume), bytesOf(values));
            }
        }
    });
}

TEST_F(ItkFileTest, nifti_slope_and_intercept_give_the_values_as_they_were_measured) {
    Nifti header;
    header.dim = {3, 1, 1};
    header.datatype = 4;
    header.bits = 16;
    header.slope = 0.5F;
    header.intercept = -1024;
    const Volume volume = readBytes("a.nii", niftiFile(header, bytesOf(std::vector<std::int16_t>{-2, 0, 4001})));
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 0}), -1025.0);
    EXPECT_EQ(volume::valueAt(volume, {1, 0, 0}), -1024.0);
    EXPECT_EQ(volume::valueAt(volume, {2, 0, 0}), 976.5);
}

TEST_F(ItkFileTest, nifti_axes_are_turned_from_ras_to_lps) {
    Nifti header;
    header.dim = {4, 3, 2};
    header.pixdim = {2, 3, 4, 1};
    // Axes along +y, -x and +z of RAS.
    header.sform = {0, -3, 0, 10, 2, 0, 0, 20, 0, 0, 4, 30};
    const std::string voxels(kVoxels, 'x');
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) {
        return glm::length(a - b) < 1e-5; // the file has single precision
    };
    const Volume byMatrix = readBytes("a.nii", niftiFile(header, voxels));
    EXPECT_PRED2(near, placeOf(byMatrix, {0, 0, 0}), glm::dvec3(-10, -20, 30));
    EXPECT_PRED2(near, placeOf(byMatrix, {1, 0, 0}), glm::dvec3(-10, -22, 30));
    EXPECT_PRED2(near, placeOf(byMatrix, {0, 1, 0}), glm::dvec3(-7, -20, 30));
    EXPECT_PRED2(near, placeOf(byMatrix, {0, 0, 1}), glm::dvec3(-10, -20, 34));
    // The same by a quaternion: 90 degrees about z; then mirrored by qfac.
    header.sform.clear();
    header.quaternion = {0, 0, 0.70710678F, 10, 20, 30};
    const Volume turned = readBytes("a.nii", niftiFile(header, voxels));
    EXPECT_PRED2(near, placeOf(turned, {1, 1, 1}), placeOf(byMatrix, {1, 1, 1}));
    header.qfac = -1;
    const Volume mirrored = readBytes("a.nii", niftiFile(header, voxels));
    EXPECT_PRED2(near, placeOf(mirrored, {0, 0, 1}), glm::dvec3(-10, -20, 26));
}

TEST_F(ItkFileTest, nifti_axes_that_cannot_be_are_refused) {
    Nifti header;
    header.dim = {4, 3, 2};
    for (const float wrong : {1e30F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        header.sform = {1, 0, wrong, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        EXPECT_THAT(problemOf("a.nii", niftiFile(header, std::string(kVoxels, 'x'))), HasSubstr("cannot be"));
    }
}

TEST_F(ItkFileTest, nifti_has_points_of_time_with_their_step) {
    Nifti header;
    header.dim = {2, 2, 1, 3};
    header.pixdim = {1, 1, 1, 2.5F};
    std::vector<std::uint8_t> values(12);
    std::iota(values.begin(), values.end(), std::uint8_t{0});
    const Volume volume = readBytes("a.nii", niftiFile(header, bytesOf(values)));
    EXPECT_EQ(volume.timePoints, 3);
    EXPECT_EQ(volume.timeStep, 2.5);
    EXPECT_EQ(volume::valueAt(volume, {1, 1, 0}, 0, 2), 11);
}

TEST_F(ItkFileTest, headers_that_ask_for_more_memory_than_there_is_are_refused_before_it_is_taken) {
    const std::string needs =
        "asks for 1e+06 GB of memory (10000 x 10000 x 10000 voxels, 1 channels, 1000 points of time)";
    EXPECT_THAT(problemOf("a.mha", metaImage("MET_UCHAR", "", "", "10000 10000 10000 1000")), HasSubstr(needs));
    EXPECT_THAT(problemOf("a.nrrd", nrrd("uchar", "kinds: domain domain domain time\nencoding: gzip\n", "",
                                         "10000 10000 10000 1000")),
                HasSubstr(needs));
    Nifti header;
    header.dim = {10000, 10000, 10000, 1000};
    EXPECT_THAT(problemOf("a.nii", niftiFile(header, "")), HasSubstr(needs));
}

TEST_F(ItkFileTest, files_that_promise_more_than_they_hold_are_damaged) {
    const std::string few(10, 'x');
    EXPECT_THAT(problemOf("a.nrrd", nrrd("uchar", "encoding: raw\n", few)), HasSubstr("damaged"));
    EXPECT_THAT(problemOf("a.mha", metaImage("MET_UCHAR", "", few)), HasSubstr("damaged"));
    Nifti header;
    header.dim = {4, 3, 2};
    EXPECT_THAT(problemOf("a.nii", niftiFile(header, few)), HasSubstr("damaged"));
    EXPECT_THAT(problemOf("a.nii.gz", gzip(niftiFile(header, few))), HasSubstr("damaged"));
    EXPECT_THAT(problemOf("a.mhd", metaImage("MET_UCHAR", "", "", "4 3 2", "none.raw")),
                HasSubstr("none.raw\" is not there"));
    writeFile(folder_ / "few.raw", few);
    EXPECT_THAT(problemOf("a.mhd", metaImage("MET_UCHAR", "", "", "4 3 2", "few.raw")), HasSubstr("damaged"));
    writeFile(folder_ / "more.raw", few);
    EXPECT_THAT(problemOf("a.mhd", metaImage("MET_UCHAR", "", "few.raw\nmore.raw\n", "4 3 2", "LIST")),
                HasSubstr("promises 24 bytes of voxels, and there are 20"));
    const std::string compressed = zlib(std::string(kVoxels, 'x'));
    for (const std::size_t kept : {std::size_t{0}, std::size_t{4}, compressed.size() - 10})
        EXPECT_THAT(problemOf("a.mha", metaImage("MET_UCHAR",
                                                 fmt::format("CompressedData = True\nCompressedDataSize = {}\n",
                                                             compressed.size()),
                                                 compressed.substr(0, kept))),
                    HasSubstr("damaged"));
    EXPECT_THAT(problemOf("a.nhdr", nrrd("uchar", "encoding: raw\ndata file: none.raw\n", "")), HasSubstr("damaged"));
}

TEST_F(ItkFileTest, metaimage_headers_are_looked_through_before_metaio_sees_them) {
    const auto headed = [&](const std::string& lines) {
        return problemOf("a.mha",
                         "ObjectType = Image\n" + lines + "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nx");
    };
    EXPECT_THAT(headed("NDims = 99\nDimSize = 1 1 1\n"), HasSubstr("NDims = \"99\" in its header cannot be"));
    EXPECT_THAT(headed("NDims = -3\nDimSize = 1 1 1\n"), HasSubstr("NDims"));
    EXPECT_THAT(headed("NDims = three\nDimSize = 1 1 1\n"), HasSubstr("is no number: \"three\""));
    EXPECT_THAT(headed("NDims = 3\nDimSize = 1 1\n"), HasSubstr("DimSize in its header has 2 instead of 3"));
    EXPECT_THAT(headed("NDims = 3\nDimSize = 1 1 0\n"), HasSubstr("empty"));
    EXPECT_THAT(headed("NDims = 3\nDimSize = 1 1 1\nTransformMatrix = 1 0 0\n"), HasSubstr("3 instead of 9"));
    EXPECT_THAT(headed("DimSize = 1 1 1\n"), HasSubstr("has no NDims"));
    EXPECT_THAT(headed("NDims = 3\nDimSize = 1 1 1\nnonsense\n"), HasSubstr("line 4"));
    EXPECT_THAT(problemOf("a.mha", "ObjectType = Image\nNDims = 3\n"), HasSubstr("no ElementDataFile"));
}

} // namespace
} // namespace apeiron::io::volumes
