#include "../unit/support.hpp"
#include "io/volume_file.hpp"
#include "io/volumes/volumes.hpp"
#include "volume/orientation.hpp"
#include "volume_files.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::io::volumes {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these
using testing::HasSubstr;
using volume::Volume;
using volume::VoxelType;

constexpr std::size_t kLimit = std::size_t{1} << 26;
constexpr int kColumns = 4;
constexpr int kRows = 3;

/// Stored values of a slice: which one they are of is seen from each.
std::string pixelsOf(int slice) {
    std::vector<std::int16_t> values;
    for (int i = 0; i < kColumns * kRows; ++i)
        values.push_back(static_cast<std::int16_t>(100 * slice + i));
    return bytesOf(values);
}

class DicomTest : public testing::Test {
  protected:
    void add(const std::string& name, const DicomSlice& slice) { writeFile(folder_ / name, dicomFile(slice)); }
    /// Slices 2 mm apart along z, the first at the bottom.
    void addStack(int count, const DicomSlice& common = {}) {
        for (int i = 0; i < count; ++i) {
            DicomSlice slice = common;
            slice.instance = i + 1;
            slice.position += glm::dvec3(0, 0, 2 * i);
            slice.pixels = pixelsOf(i);
            add(fmt::format("{}.dcm", i), slice);
        }
    }
    Volume read() const { return volumes::read({folder_.path(), {}, {}, 0}, kLimit); }
    std::string problem() const {
        return messageOf([&] { read(); });
    }

    TemporaryFolder folder_;
};

bool near(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::length(a - b) < 1e-9; // positions are decimal text of 6 digits and more
}

TEST_F(DicomTest, slices_are_sorted_by_their_place_whatever_their_names_and_numbers_say) {
    const std::vector<int> order{2, 0, 3, 1};
    for (int i = 0; i < 4; ++i) {
        DicomSlice slice;
        slice.instance = 10 - i;
        slice.position = {5, 6, 2.0 * order[static_cast<std::size_t>(i)]};
        slice.spacing = {0.5, 0.75};
        slice.pixels = pixelsOf(order[static_cast<std::size_t>(i)]);
        add(fmt::format("{}.dcm", i), slice);
    }
    const Volume volume = read();
    EXPECT_EQ(volume.size, glm::ivec3(kColumns, kRows, 4));
    EXPECT_EQ(volume.type, VoxelType::Int16);
    for (int z = 0; z < 4; ++z)
        EXPECT_EQ(volume::valueAt(volume, {1, 2, z}), 100 * z + 9);
    EXPECT_PRED2(near, placeOf(volume, {0, 0, 0}), glm::dvec3(5, 6, 0));
    EXPECT_PRED2(near, volume::spacing(volume), glm::dvec3(0.5, 0.75, 2));
    EXPECT_EQ(volume.modality, volume::Modality::Ct);
    EXPECT_EQ(volume.unit, "HU");
    EXPECT_TRUE(volume.messages.empty()) << volume.messages.front();
}

TEST_F(DicomTest, slope_and_intercept_give_hounsfield_units) {
    DicomSlice slice;
    slice.isSigned = false;
    slice.intercept = -1024;
    addStack(2, slice);
    const Volume whole = read();
    EXPECT_EQ(whole.type, VoxelType::Int16);
    EXPECT_EQ(volume::valueAt(whole, {0, 0, 0}), -1024);
    EXPECT_EQ(volume::valueAt(whole, {3, 2, 1}), -1024 + 111);
    slice.slope = 0.25;
    addStack(2, slice);
    EXPECT_EQ(volume::valueAt(read(), {3, 2, 1}), -1024 + 0.25 * 111);
}

TEST_F(DicomTest, eight_bits_are_kept) {
    for (int i = 0; i < 2; ++i) {
        DicomSlice slice;
        slice.bits = 8;
        slice.isSigned = false;
        slice.modality = "MR";
        slice.instance = i;
        slice.position.z = i;
        slice.pixels = std::string(12, static_cast<char>(200 + i));
        add(std::to_string(i), slice);
    }
    const Volume volume = read();
    EXPECT_EQ(volume.type, VoxelType::UInt8);
    EXPECT_EQ(volume.modality, volume::Modality::Mri);
    EXPECT_EQ(volume::valueAt(volume, {3, 2, 1}), 201);
}

TEST_F(DicomTest, oblique_slices_keep_their_axes) {
    DicomSlice slice;
    slice.row = {0.6, 0.8, 0};
    slice.column = {0, 0, -1};
    for (int i = 0; i < 3; ++i) {
        slice.instance = i;
        slice.position = 2.0 * i * glm::dvec3(-0.8, 0.6, 0) + glm::dvec3(1, 2, 3);
        slice.pixels = pixelsOf(i);
        add(std::to_string(i), slice);
    }
    const Volume volume = read();
    EXPECT_PRED2(near, placeOf(volume, {1, 0, 0}) - placeOf(volume, {0, 0, 0}), glm::dvec3(0.6, 0.8, 0));
    EXPECT_PRED2(near, placeOf(volume, {0, 1, 0}) - placeOf(volume, {0, 0, 0}), glm::dvec3(0, 0, -1));
    // Every voxel is where its slice says that it is.
    for (int z = 0; z < 3; ++z) {
        const auto of = static_cast<int>(volume::valueAt(volume, {0, 0, z}) / 100);
        EXPECT_PRED2(near, placeOf(volume, {0, 0, z}), 2.0 * of * glm::dvec3(-0.8, 0.6, 0) + glm::dvec3(1, 2, 3));
    }
    EXPECT_TRUE(volume.messages.empty());
}

TEST_F(DicomTest, a_tilted_gantry_shears_the_grid_and_says_so) {
    // Slices lie 18.5 degrees off the table's direction, along which they are moved by 2 mm.
    const double tilt = 18.5 * 3.14159265358979 / 180;
    DicomSlice slice;
    slice.column = {0, std::cos(tilt), std::sin(tilt)};
    for (int i = 0; i < 5; ++i) {
        slice.instance = i;
        slice.position = {-7, -8, 2.0 * i};
        slice.pixels = pixelsOf(i);
        add(std::to_string(i), slice);
    }
    const Volume volume = read();
    EXPECT_TRUE(says(volume, "tilted by 18.5 degrees"));
    for (int z = 0; z < 5; ++z)
        for (int y = 0; y < kRows; ++y) {
            // ITK makes the axes of a slice orthonormal from decimal text of 6 digits.
            const glm::dvec3 expected = glm::dvec3(-7, -8, 2.0 * z) + slice.column * static_cast<double>(y);
            EXPECT_LT(glm::length(placeOf(volume, {0, y, z}) - expected), 1e-5);
            EXPECT_EQ(volume::valueAt(volume, {0, y, z}), 100 * z + 4 * y);
        }
    EXPECT_NEAR(volume::orientationOf(volume).shear, 18.5, 1e-3);
}

TEST_F(DicomTest, uneven_distances_are_resampled_linearly_and_say_so) {
    // Values are linear in the place: so must be what lies between.
    for (const int place : {0, 2, 4, 8, 10}) {
        DicomSlice slice;
        slice.instance = place;
        slice.position.z = place;
        slice.pixels = bytesOf(std::vector<std::int16_t>(12, static_cast<std::int16_t>(10 * place)));
        add(std::to_string(place), slice);
    }
    const Volume volume = read();
    EXPECT_TRUE(says(volume, "slices are 2 to 4 mm apart: resampled linearly from 5 to 6 slices, 2 mm apart"));
    ASSERT_EQ(volume.size.z, 6);
    for (int z = 0; z < 6; ++z) {
        EXPECT_EQ(volume::valueAt(volume, {0, 0, z}), 20 * z);
        EXPECT_PRED2(near, placeOf(volume, {0, 0, z}), glm::dvec3(0, 0, 2 * z));
    }
}

TEST_F(DicomTest, slices_that_are_not_in_one_line_are_refused) {
    addStack(4);
    DicomSlice slice;
    slice.position = {1.5, 0, 2};
    slice.pixels = pixelsOf(1);
    add("1.dcm", slice);
    EXPECT_THAT(problem(), HasSubstr("its slices are not in one line: 1.dcm is 1.5 mm beside it"));
}

TEST_F(DicomTest, slices_at_the_same_places_are_points_of_time_in_the_order_of_their_numbers) {
    for (int time = 0; time < 3; ++time)
        for (int z = 0; z < 2; ++z) {
            DicomSlice slice;
            slice.instance = 100 - 10 * time + z;
            slice.position.z = z;
            slice.pixels = pixelsOf(10 * time + z);
            add(fmt::format("{}{}", time, z), slice);
        }
    const Volume volume = read();
    ASSERT_EQ(volume.timePoints, 3);
    for (int time = 0; time < 3; ++time)
        for (int z = 0; z < 2; ++z)
            EXPECT_EQ(volume::valueAt(volume, {0, 0, z}, 0, 2 - time), 100 * (10 * time + z));
    std::filesystem::remove(folder_ / "11");
    EXPECT_THAT(problem(), HasSubstr("several slices at some places and not at others"));
}

TEST_F(DicomTest, of_several_series_the_largest_is_shown) {
    addStack(4);
    DicomSlice scout;
    scout.series = "9.9";
    scout.row = {0, 1, 0};
    scout.column = {0, 0, -1};
    scout.pixels = pixelsOf(7);
    add("scout", scout);
    writeFile(folder_ / "notes.txt", "not DICOM at all");
    const Volume volume = read();
    EXPECT_EQ(volume.size.z, 4);
    EXPECT_TRUE(says(volume, "the largest of 2 stacks of slices is shown, which has 4 of 5 files"));
}

TEST_F(DicomTest, one_file_is_a_volume_of_one_slice) {
    DicomSlice slice;
    slice.position = {1, 2, 3};
    slice.pixels = pixelsOf(3);
    add("a.dcm", slice);
    const Volume volume = volumes::read({folder_ / "a.dcm", {}, {}, 0}, kLimit);
    EXPECT_EQ(volume.size, glm::ivec3(kColumns, kRows, 1));
    EXPECT_EQ(volume::valueAt(volume, {3, 2, 0}), 311);
    EXPECT_TRUE(says(volume, "name the folder"));
    // The folder is the same.
    EXPECT_EQ(bytesOf(read()), bytesOf(volume));
}

TEST_F(DicomTest, files_that_are_cut_off_anywhere_are_errors_that_name_them) {
    addStack(3);
    DicomSlice slice;
    slice.position.z = 2;
    slice.pixels = pixelsOf(1);
    const std::string file = dicomFile(slice);
    // GDCM aborts on some of these: they are read by the reader's process.
    for (const std::size_t size : {file.size() - 10, file.size() / 2, std::size_t{200}, std::size_t{140}}) {
        writeFile(folder_ / "1.dcm", file.substr(0, size));
        // In a series it ends in an error, or is left out; both name it.
        EXPECT_THAT(messageOf([&] {
                        const Volume volume = io::readVolume({folder_.path(), {}, {}, 0});
                        throw Error(ErrorKind::Io, fmt::format("{}", fmt::join(volume.messages, "\n")));
                    }),
                    HasSubstr("1.dcm"))
            << size;
        EXPECT_THAT(messageOf([&] { io::readVolume({folder_ / "1.dcm", {}, {}, 0}); }), HasSubstr("damaged")) << size;
    }
}

} // namespace
} // namespace apeiron::io::volumes
