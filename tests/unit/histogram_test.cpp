#include "support.hpp"
#include "volume/defaults.hpp"
#include "volume/generators.hpp"
#include "volume/histogram.hpp"
#include "volume/voxels.hpp"

#include <cmath>
#include <numeric>

namespace apeiron::volume {
namespace {

/// value(x, y, z) as Float32, voxels of 2 x 1 x 0.5 mm.
template <class Value> Volume floats(glm::ivec3 size, const Value& value) {
    Volume volume = makeVolume(size, VoxelType::Float32);
    auto* voxel = mutableVoxels<float>(volume);
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                *voxel++ = static_cast<float>(value(x, y, z));
    centre(volume, {2.0, 1.0, 0.5});
    return volume;
}

TEST(HistogramTest, every_value_is_in_its_class) {
    Volume volume = floats({8, 5, 3}, [](int x, int, int) { return x; });
    volume.slope = 10;
    volume.intercept = -5;
    const Histogram histogram = valueHistogram(volume, -10, 70, 8);
    EXPECT_EQ(histogram.voxels, 8 * 5 * 3);
    for (int x = 0; x < 8; ++x)
        EXPECT_EQ(histogram.at(x), 15) << x; // values -5, 5, ... 65 are in the middle of their classes
}

TEST(HistogramTest, what_lies_outside_counts_to_the_ends_and_nan_to_nothing) {
    const Volume volume =
        floats({8, 1, 1}, [](int x, int, int) { return x == 3 ? std::numeric_limits<double>::quiet_NaN() : x; });
    const Histogram histogram = valueHistogram(volume, 2, 4, 2);
    EXPECT_EQ(histogram.voxels, 7);
    EXPECT_EQ(histogram.at(0), 3);
    EXPECT_EQ(histogram.at(1), 4);
}

TEST(HistogramTest, gradients_are_per_millimetre_in_the_worlds_space) {
    // 6 per voxel of 2 mm along x, 4 per voxel of 1 mm along y, 0 along z: |(3, 4, 0)| = 5.
    const Volume volume = floats({9, 9, 9}, [](int x, int y, int) { return 6 * x + 4 * y; });
    const Histogram gradients = gradientHistogram(volume, 10);
    EXPECT_NEAR(gradients.high, 5.0, 1e-9);
    EXPECT_EQ(gradients.at(9), 9 * 9 * 9) << "also at the borders, where differences are one-sided";
    const Histogram joint = jointHistogram(volume, 0, 80, 10, 4, 10);
    std::int64_t atFive = 0;
    for (int x = 0; x < 4; ++x)
        atFive += joint.at(x, 5) + joint.at(x, 4); // rounding may be on either side of 5
    EXPECT_EQ(atFive, joint.voxels);
}

TEST(HistogramTest, quantiles_are_linear_inside_a_class) {
    const Volume volume = floats({100, 1, 1}, [](int x, int, int) { return x + 0.5; });
    const Histogram histogram = valueHistogram(volume, 0, 100, 10);
    EXPECT_DOUBLE_EQ(quantile(histogram, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(quantile(histogram, 0.25), 25.0);
    EXPECT_DOUBLE_EQ(quantile(histogram, 1.0), 100.0);
}

TEST(HistogramTest, large_volumes_are_looked_at_in_part) {
    const Volume volume = makeVolume({200, 200, 200}, VoxelType::UInt8);
    const Histogram histogram = valueHistogram(volume, 0, 1, 4);
    EXPECT_LE(histogram.voxels, kHistogramVoxels);
    EXPECT_GE(histogram.voxels, kHistogramVoxels / 8);
    EXPECT_EQ(histogram.at(0), histogram.voxels);
}

TEST(HistogramTest, json_has_counts_and_what_is_shown) {
    const Volume volume = floats({4, 1, 1}, [](int x, int, int) { return x / 3; });
    const Json json = toJson(valueHistogram(volume, 0, 2, 2));
    EXPECT_EQ(json["counts"], Json::array({3, 1}));
    EXPECT_EQ(json["log"][0], 1.0);
    EXPECT_NEAR(json["log"][1].get<double>(), 0.5, 1e-4); // log 2 / log 4
}

TEST(DefaultsTest, windows_leave_out_the_background_and_its_noise) {
    // 7/8 noise around 10, 1/8 an object from 100 to 200.
    const Volume volume = floats({64, 64, 64}, [](int x, int y, int z) {
        if (x < 32 && y < 32 && z < 32) return 100.0 + 100.0 * x / 31.0;
        return 10.0 + ((x * 7 + y * 13 + z * 29) % 11 - 5);
    });
    const DataRange range = dataRanges(volume).front();
    EXPECT_EQ(range.minimum, 5.0);
    EXPECT_EQ(range.maximum, 200.0);
    EXPECT_GT(range.low, 14.0) << "the noise is no object";
    EXPECT_LT(range.low, 100.0);
    EXPECT_NEAR(range.high, 200.0, 5.0);
}

TEST(DefaultsTest, even_and_nearly_even_volumes_have_a_window) {
    for (const int bright : {0, 1}) {
        const Volume volume =
            floats({16, 16, 16}, [bright](int x, int y, int z) { return x + y + z == 0 ? bright : 0; });
        const DataRange range = dataRanges(volume).front();
        EXPECT_LT(range.low, range.high);
        EXPECT_LT(range.minimum, range.maximum);
        EXPECT_GT(range.gradientHigh, 0.0);
    }
}

TEST(DefaultsTest, presets_follow_what_made_the_data) {
    const auto automatic = [](const Volume& volume) { return automaticTransfer(volume, dataRanges(volume)); };
    EXPECT_EQ(automatic(sheppLogan(16)), Json("ct_skin_and_bone"));
    Volume volume = floats({8, 8, 8}, [](int x, int, int) { return x; });
    volume.modality = Modality::Mri;
    EXPECT_EQ(automatic(volume), Json("mri"));
    volume.modality = Modality::Ct;
    EXPECT_EQ(automatic(volume), Json("layers")) << "no Hounsfield units: bone is nobody knows where";
    volume = makeVolume({8, 8, 8}, VoxelType::UInt8, 3);
    volume.modality = Modality::Microscopy;
    volume.channelNames = {"TL Brightfield", "SEG_DNA", "something"};
    const Json transfer = automatic(volume);
    ASSERT_EQ(transfer.size(), 3U);
    const auto functions = transferFunctions(transfer, "grey");
    EXPECT_EQ(evaluate(functions[0], 1.0, 0.0).opacity, 0.0) << "light that went through everything shows nothing";
    EXPECT_GT(evaluate(functions[1], 0.6, 0.0).color.z, 0.5) << "DNA is blue";
}

TEST(DefaultsTest, things_of_no_known_kind_are_told_apart_by_their_values) {
    const auto automatic = [](const auto& value) {
        Volume volume = makeVolume({32, 32, 32}, VoxelType::UInt8);
        auto* voxel = mutableVoxels<std::uint8_t>(volume);
        for (int i = 0; i < 32 * 32 * 32; ++i)
            voxel[i] = static_cast<std::uint8_t>(i % 4 == 0 ? value(i / 4) : 0);
        return automaticTransfer(volume, dataRanges(volume));
    };
    EXPECT_EQ(automatic([](int i) { return 256 / (1 + i % 97); }), Json("simulation")) << "values fade away";
    EXPECT_EQ(automatic([](int i) { return i % 10 < 7 ? 30 + i % 5 : 200 + i % 7; }), Json("layers")) << "most is thin";
    EXPECT_EQ(automatic([](int i) { return i % 10 < 3 ? 30 + i % 5 : 180 + i % 7; }), Json("solid"));
}

/// A head of bone around something soft on a neck, in the numbers of a scanner (Hounsfield's + 1024), crown down or up.
Volume scannedHead(bool crownDown) {
    Volume volume = makeVolume({40, 40, 24}, VoxelType::Int16);
    auto* voxel = mutableVoxels<std::int16_t>(volume);
    for (int z = 0; z < 24; ++z)
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 40; ++x, ++voxel) {
                const double r = std::hypot(x - 19.5, y - 19.5);
                const int height = crownDown ? 23 - z : z;
                const bool bone = height > 12 ? r > 14 && r < 17 : r < 2;
                *voxel = static_cast<std::int16_t>(bone ? 2200 : r < (height > 12 ? 17.0 : 13.0) ? 1060 : 20);
            }
    return volume;
}

TEST(DefaultsTest, a_scanners_numbers_are_hounsfield_units_with_an_offset) {
    const Volume head = scannedHead(false);
    const auto functions = transferFunctions(automaticTransfer(head, dataRanges(head)), "grey");
    const auto preset = transferFunctions("ct_skin_and_bone", "grey");
    for (const double value : {-1000.0, -300.0, 40.0, 300.0, 1200.0})
        EXPECT_DOUBLE_EQ(evaluate(functions[0], value + 1024.0, 0.0).opacity, evaluate(preset[0], value, 0.0).opacity);
}

TEST(DefaultsTest, heads_stand_upright_where_the_file_does_not_say_how_they_lie) {
    for (const bool crownDown : {false, true}) {
        Volume head = scannedHead(crownDown);
        EXPECT_EQ(isUpsideDown(head, dataRanges(head)), crownDown);
        head.oriented = true;
        EXPECT_FALSE(isUpsideDown(head, dataRanges(head))) << "what the file says holds";
    }
    // Something that is cut off by its box stands on the cut.
    for (const bool above : {false, true}) {
        Volume thing = makeVolume({32, 32, 32}, VoxelType::UInt8);
        auto* voxel = mutableVoxels<std::uint8_t>(thing);
        for (int i = 0; i < 32 * 32 * 32; ++i) {
            const int z = i / 1024;
            const bool inside = std::hypot(i % 32 - 16, i / 32 % 32 - 16) < 0.5 * (above ? z : 31 - z) - 2;
            voxel[i] = inside ? 100 : 0;
        }
        centre(thing, glm::dvec3(1.0));
        EXPECT_EQ(isUpsideDown(thing, dataRanges(thing)), above);
    }
}

TEST(DefaultsTest, flat_things_and_what_lies_under_a_microscope_are_seen_from_above) {
    EXPECT_LT(frontDirection(Modality::Ct, {200, 200, 150}).z, 0.5);
    EXPECT_GT(frontDirection(Modality::Unknown, {200, 200, 10}).z, 0.8);
    EXPECT_GT(frontDirection(Modality::Microscopy, {20, 20, 20}).z, 0.5);
}

TEST(DefaultsTest, every_generated_volume_gets_a_function_that_shows_it) {
    for (const Generator& generator : generators()) {
        GeneratorOptions options;
        options.size = 24;
        const Volume volume = generate(generator.name, options);
        const auto ranges = dataRanges(volume);
        const auto functions = transferFunctions(automaticTransfer(volume, ranges), "grey");
        const Histogram h = valueHistogram(volume, ranges[0].minimum, ranges[0].maximum, 200);
        const TransferFunction f = inValueUnits(functions[0], ranges[0]);
        double seen = 0.0;
        for (int x = 0; x < 200; ++x) {
            const double value = h.low + (h.high - h.low) * (x + 0.5) / 200;
            if (evaluate(f, value, 0.0).opacity > 0.2) seen += static_cast<double>(h.at(x));
        }
        EXPECT_GT(seen / static_cast<double>(h.voxels), 0.0005) << generator.name;
    }
}

} // namespace
} // namespace apeiron::volume
