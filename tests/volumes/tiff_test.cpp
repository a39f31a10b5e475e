#include "../unit/support.hpp"
#include "io/volumes/volumes.hpp"
#include "volume_files.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>

namespace apeiron::io::volumes {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::ElementsAre;
using testing::HasSubstr;
using volume::Volume;
using volume::VoxelType;

constexpr std::size_t kLimit = std::size_t{1} << 26;
constexpr std::size_t kPixels = 12;

class TiffTest : public testing::Test {
  protected:
    Volume read(const Tiff& tiff) const {
        writeFile(folder_ / "a.tif", tiffFile(tiff));
        return volumes::read({folder_ / "a.tif", {}, {}, 0}, kLimit);
    }
    std::string problemOf(const Tiff& tiff) const {
        return messageOf([&] { read(tiff); });
    }

    TemporaryFolder folder_;
};

/// Pages of one value each: their number.
std::vector<std::string> numbered(int count) {
    std::vector<std::string> pages;
    for (int i = 0; i < count; ++i)
        pages.emplace_back(kPixels, static_cast<char>(i));
    return pages;
}

std::string ome(const std::string& attributes, const std::string& inside = "<TiffData/>") {
    return "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image "
           "ID=\"Image:0\">"
           "<Pixels ID=\"Pixels:0\" Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" " +
           attributes + ">" + inside + "</Pixels></Image></OME>";
}

template <class T> void expectExact(const TiffTest& /*test*/, int format, VoxelType type, const auto& read) {
    std::vector<T> values{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()};
    for (std::uint32_t i = 2; i < 2 * kPixels; ++i)
        values.push_back(
            static_cast<T>(std::is_floating_point_v<T> ? static_cast<T>(i) / T{7} : static_cast<T>(i * 2654435761U)));
    for (const bool big : {false, true}) {
        SCOPED_TRACE(fmt::format("{} {}", volume::toString(type), big ? "big" : "little"));
        const std::string bytes = bytesOf(values, big);
        const std::size_t half = bytes.size() / 2;
        Tiff tiff;
        tiff.bits = 8 * static_cast<int>(sizeof(T));
        tiff.format = format;
        tiff.bigEndian = big;
        tiff.pages = {bytes.substr(0, half), bytes.substr(half)};
        const Volume volume = read(tiff);
        EXPECT_EQ(volume.size, glm::ivec3(4, 3, 2));
        EXPECT_EQ(volume.type, type);
        EXPECT_EQ(bytesOf(volume), bytesOf(values));
    }
}

TEST_F(TiffTest, pages_are_slices_and_every_bit_is_kept_in_both_byte_orders) {
    const auto read = [this](const Tiff& tiff) { return this->read(tiff); };
    expectExact<std::uint8_t>(*this, 1, VoxelType::UInt8, read);
    expectExact<std::int8_t>(*this, 2, VoxelType::Int8, read);
    expectExact<std::uint16_t>(*this, 1, VoxelType::UInt16, read);
    expectExact<std::int16_t>(*this, 2, VoxelType::Int16, read);
    expectExact<float>(*this, 3, VoxelType::Float32, read);
}

TEST_F(TiffTest, samples_of_a_pixel_are_channels) {
    Tiff tiff;
    tiff.samples = 3;
    for (int page = 0; page < 2; ++page) {
        std::string pixels;
        for (std::size_t i = 0; i < 3 * kPixels; ++i)
            pixels += static_cast<char>(100 * page + static_cast<int>(i));
        tiff.pages.push_back(pixels);
    }
    const Volume volume = read(tiff);
    ASSERT_EQ(volume.channels, 3);
    EXPECT_EQ(volume.size.z, 2);
    EXPECT_EQ(volume::valueAt(volume, {3, 2, 1}, 2), 135);
    EXPECT_EQ(volume::valueAt(volume, {1, 0, 0}, 1), 4);
}

TEST_F(TiffTest, every_order_of_dimensions_is_understood) {
    constexpr int kZ = 2;
    constexpr int kC = 3;
    constexpr int kT = 2;
    for (const std::string order : {"XYZCT", "XYZTC", "XYCZT", "XYCTZ", "XYTZC", "XYTCZ"}) {
        SCOPED_TRACE(order);
        Tiff tiff;
        tiff.pages = numbered(kZ * kC * kT);
        tiff.description =
            ome(fmt::format("DimensionOrder=\"{}\" SizeZ=\"{}\" SizeC=\"{}\" SizeT=\"{}\"", order, kZ, kC, kT));
        const Volume volume = read(tiff);
        ASSERT_EQ(volume.size.z, kZ);
        ASSERT_EQ(volume.channels, kC);
        ASSERT_EQ(volume.timePoints, kT);
        const std::map<char, int> sizes{{'Z', kZ}, {'C', kC}, {'T', kT}};
        for (int z = 0; z < kZ; ++z)
            for (int c = 0; c < kC; ++c)
                for (int t = 0; t < kT; ++t) {
                    const std::map<char, int> at{{'Z', z}, {'C', c}, {'T', t}};
                    // The letter behind XY counts fastest.
                    const int page =
                        at.at(order[2]) + sizes.at(order[2]) * (at.at(order[3]) + sizes.at(order[3]) * at.at(order[4]));
                    EXPECT_EQ(volume::valueAt(volume, {0, 0, z}, c, t), page);
                }
    }
}

TEST_F(TiffTest, ome_pages_may_be_named_one_by_one_and_missing_ones_are_told) {
    Tiff tiff;
    tiff.pages = numbered(3);
    tiff.description = ome("DimensionOrder=\"XYZCT\" SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\"",
                           "<TiffData IFD=\"0\" FirstZ=\"2\"/><TiffData IFD=\"2\" FirstZ=\"0\"/>");
    const Volume volume = read(tiff);
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 0}), 2);
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 1}), 0);
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 2}), 0);
    EXPECT_TRUE(says(volume, "1 planes are not in the file"));
}

TEST_F(TiffTest, ome_sizes_names_and_times_are_read) {
    Tiff tiff;
    tiff.pages = numbered(4);
    tiff.description = ome("DimensionOrder=\"XYZCT\" SizeZ=\"1\" SizeC=\"2\" SizeT=\"2\" PhysicalSizeX=\"0.5\" "
                           "PhysicalSizeY=\"250\" PhysicalSizeYUnit=\"nm\" PhysicalSizeZ=\"0.002\" "
                           "PhysicalSizeZUnit=\"mm\" TimeIncrement=\"40\" TimeIncrementUnit=\"ms\"",
                           "<Channel Name=\"DAPI\"/><Channel Name=\"GFP\"/><TiffData/>");
    const Volume volume = read(tiff);
    EXPECT_THAT(volume.channelNames, ElementsAre("DAPI", "GFP"));
    EXPECT_EQ(volume.modality, volume::Modality::Microscopy);
    EXPECT_DOUBLE_EQ(volume.timeStep, 0.04);
    // Micrometres where no unit is named.
    EXPECT_LT(glm::length(volume::spacing(volume) - glm::dvec3(0.5e-3, 0.25e-3, 2e-3)), 1e-15);
}

TEST_F(TiffTest, imagej_describes_hyperstacks) {
    Tiff tiff;
    tiff.pages = numbered(12);
    tiff.resolution = 4;
    tiff.description =
        "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nunit=um\nspacing=1.5\n"
        "finterval=0.5\n";
    const Volume volume = read(tiff);
    ASSERT_EQ(volume.size.z, 3);
    ASSERT_EQ(volume.channels, 2);
    ASSERT_EQ(volume.timePoints, 2);
    EXPECT_EQ(volume.timeStep, 0.5);
    // Channels count fastest, then slices, then frames.
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 2}, 1, 1), 1 + 2 * (2 + 3 * 1));
    EXPECT_LT(glm::length(volume::spacing(volume) - glm::dvec3(0.25e-3, 0.25e-3, 1.5e-3)), 1e-9); // float tags
}

TEST_F(TiffTest, a_folder_is_a_stack_in_the_order_of_numbers) {
    for (const int number : {1, 2, 10}) {
        Tiff tiff;
        tiff.pages = {std::string(kPixels, static_cast<char>(number))};
        writeFile(folder_ / fmt::format("slice{}.tif", number), tiffFile(tiff));
    }
    const Volume volume = volumes::read({folder_.path(), {}, {}, 0}, kLimit);
    ASSERT_EQ(volume.size, glm::ivec3(4, 3, 3));
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 1}), 2);
    EXPECT_EQ(volume::valueAt(volume, {0, 0, 2}), 10);
    EXPECT_TRUE(says(volume, "taken as 1 mm"));
}

TEST_F(TiffTest, what_makes_no_sense_is_refused) {
    Tiff tiff;
    tiff.pages = numbered(2);
    tiff.description = ome("DimensionOrder=\"XYZCT\" SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\"");
    EXPECT_THAT(problemOf(tiff), HasSubstr("promises 3 x 1 x 1 planes, and it has 2"));
    tiff.description = ome("DimensionOrder=\"YXZCT\" SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\"");
    EXPECT_THAT(problemOf(tiff), HasSubstr("no order of dimensions"));
    tiff.description = "<OME><Image>";
    EXPECT_THAT(problemOf(tiff), HasSubstr("OME-XML"));
    tiff.description = ome("DimensionOrder=\"XYZCT\" SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\"", "<TiffData IFD=\"7\"/>");
    EXPECT_THAT(problemOf(tiff), HasSubstr("names pages that are not there"));
    tiff.description.clear();
    const std::string file = tiffFile(tiff);
    for (const std::size_t size : {std::size_t{8}, file.size() / 2, file.size() - 3}) {
        writeFile(folder_ / "short.tif", file.substr(0, size));
        EXPECT_THAT(messageOf([&] {
                        volumes::read({folder_ / "short.tif", {}, {}, 0}, kLimit);
                    }),
                    HasSubstr("damaged"))
            << size;
    }
}

} // namespace
} // namespace apeiron::io::volumes
