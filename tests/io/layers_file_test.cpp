#include "io/layers_file.hpp"

#include "core/file.hpp"
#include "io/codec.hpp"
#include "io/image_file.hpp"
#include "io_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace apeiron::io {
namespace {

using test::document;
using test::messageOf;
using test::noiseAccumulation;
using test::TemporaryFolder;
using test::writeEncoded;
using testing::HasSubstr;

namespace fs = std::filesystem;

bool sameBits(const Image<float>& a, const Image<float>& b) {
    return a.width() == b.width() && a.height() == b.height() && a.channels() == b.channels() &&
           std::memcmp(a.data().data(), b.data().data(), a.data().size() * sizeof(float)) == 0;
}

class LayersFileTest : public testing::Test {
  protected:
    TemporaryFolder folder_;
    fs::path path_ = folder_ / "a.exr";
};

TEST_F(LayersFileTest, accumulation_comes_back_bit_by_bit) {
    render::Accumulation written = noiseAccumulation(45, 33);
    using Limits = std::numeric_limits<float>;
    const float odd[] = {Limits::max(), Limits::denorm_min(), -0.0F, Limits::infinity(), Limits::quiet_NaN(), 1e-30F};
    std::copy(std::begin(odd), std::end(odd), written.mean.data().begin() + 40);
    std::copy(std::begin(odd), std::end(odd), written.spread.data().begin() + 80);
    writeLayers(path_, written, document(), {{0, 64}});
    const Layers read = readLayers(path_);
    EXPECT_TRUE(sameBits(read.accumulation.mean, written.mean));
    EXPECT_TRUE(sameBits(read.accumulation.spread, written.spread));
    EXPECT_TRUE(sameBits(read.accumulation.normal, written.normal));
    EXPECT_TRUE(sameBits(read.accumulation.albedo, written.albedo));
}

TEST_F(LayersFileTest, scene_and_samples_come_back) {
    const std::vector<SampleRange> samples{{0, 64}, {1'000'000'000, 7}};
    for (const std::size_t size : {std::size_t{0}, std::size_t{200'000}}) {
        writeLayers(path_, noiseAccumulation(4, 4), document(size), samples);
        const Layers read = readLayers(path_);
        EXPECT_EQ(Json::parse(read.scene), document(size));
        EXPECT_EQ(readScene(path_), read.scene);
        EXPECT_EQ(read.samples, samples);
    }
}

TEST_F(LayersFileTest, other_programs_find_depth_and_unit_normals) {
    const render::Accumulation written = noiseAccumulation(9, 7);
    writeLayers(path_, written, document(), {{0, 64}});
    const Header header = decodeHeader(path_, ImageFormat::Exr);
    const std::vector<float> values = decodeFloats(path_, ImageFormat::Exr, header);
    const auto value = [&](const char* channel, std::size_t pixel) {
        const auto found = std::find(header.channels.begin(), header.channels.end(), channel);
        EXPECT_NE(found, header.channels.end()) << channel;
        return values[pixel * header.channels.size() + static_cast<std::size_t>(found - header.channels.begin())];
    };
    for (std::size_t pixel = 0; pixel < 9 * 7; ++pixel) {
        const bool hit = written.albedo.data()[4 * pixel + 3] > 0.0F;
        // Hits have 3 as mean over all samples, of which half hit: 6.
        EXPECT_EQ(value("Z", pixel), hit ? 6.0F : kNothing);
        const float length = std::hypot(value("N.X", pixel), value("N.Y", pixel), value("N.Z", pixel));
        EXPECT_NEAR(length, hit ? 1.0F : 0.0F, 1e-6F);
        EXPECT_EQ(value("R", pixel), written.mean.data()[4 * pixel]);
        EXPECT_EQ(value("samples", pixel), 64.0F);
    }
}

TEST_F(LayersFileTest, files_of_others_are_refused) {
    const std::vector<float> values(4 * 4 * 3);
    writeEncoded(path_, ImageFormat::Exr, {4, 4, {"R", "G", "B"}, {}}, SampleType::Float, values.data());
    EXPECT_EQ(messageOf([&] { readLayers(path_); }),
              path_.string() + ": holds no Apeiron scene; only EXR files that Apeiron wrote can be read");
    writeEncoded(path_, ImageFormat::Exr,
                 {4, 4, {"R", "G", "B"}, {{"apeiron:scene", "{}"}, {"apeiron:samples", "0+x"}}}, SampleType::Float,
                 values.data());
    EXPECT_THAT(messageOf([&] { readLayers(path_); }), HasSubstr("does not say which samples"));
    writeEncoded(path_, ImageFormat::Exr,
                 {4, 4, {"R", "G", "B"}, {{"apeiron:scene", "{}"}, {"apeiron:samples", "0+4"}}}, SampleType::Float,
                 values.data());
    EXPECT_THAT(messageOf([&] { readLayers(path_); }), HasSubstr("lacks the channel A"));
    writeImage(folder_ / "a.png", test::noisePicture(4, 4, 1.0F), 8, document());
    EXPECT_THAT(messageOf([&] { readLayers(folder_ / "a.png"); }), HasSubstr("finished picture"));
    EXPECT_THAT(messageOf([&] { readLayers(folder_ / "b.exr"); }), HasSubstr("there is no such file"));
}

TEST_F(LayersFileTest, truncated_files_are_errors) {
    writeLayers(path_, noiseAccumulation(45, 33), document(), {{0, 64}});
    const std::string whole = readFile(path_);
    for (std::size_t size = 0; size < whole.size(); size += whole.size() / 40) {
        writeFile(folder_ / "short.exr", whole.substr(0, size));
        const std::string message = messageOf([&] { readLayers(folder_ / "short.exr"); });
        EXPECT_THAT(message, HasSubstr("short.exr: ")) << size;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST_F(LayersFileTest, damaged_files_are_errors_and_never_more) {
    writeLayers(path_, noiseAccumulation(20, 10), document(), {{0, 64}});
    const std::string whole = readFile(path_);
    test::Random random;
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole;
        // Mostly the header, where sizes and counts stand.
        const std::size_t span = i % 4 == 0 ? whole.size() : std::min<std::size_t>(whole.size(), 1500);
        for (int k = 0; k < 3; ++k)
            damaged[random.bits() % span] = static_cast<char>(random.bits());
        writeFile(folder_ / "damaged.exr", damaged);
        const std::string message = messageOf([&] { readLayers(folder_ / "damaged.exr"); });
        EXPECT_TRUE(message == "no error" || message.find("damaged.exr: ") != std::string::npos) << message;
    }
}

TEST_F(LayersFileTest, a_header_of_absurd_size_is_refused_before_memory_is_asked_for) {
    writeLayers(path_, noiseAccumulation(20, 10), document(), {{0, 64}});
    std::string bytes = readFile(path_);
    for (const std::string window : {"dataWindow", "displayWindow"}) {
        const std::size_t at = bytes.find(window + std::string("\0box2i\0", 7));
        ASSERT_NE(at, std::string::npos);
        // After the names and the size of the value: xMin, yMin, xMax, yMax as little-endian ints.
        const std::size_t value = at + window.size() + 7 + 4;
        const std::int32_t most = 30000;
        std::memcpy(bytes.data() + value + 8, &most, 4);
        std::memcpy(bytes.data() + value + 12, &most, 4);
    }
    writeFile(path_, bytes);
    EXPECT_THAT(messageOf([&] { readLayers(path_); }), HasSubstr("a.exr: "));
}

TEST(SampleRangeTest, neighbours_join_and_gaps_stay) {
    EXPECT_EQ(joined({{0, 4}}, {{4, 4}}), (std::vector<SampleRange>{{0, 8}}));
    EXPECT_EQ(joined({{8, 4}}, {{0, 4}}), (std::vector<SampleRange>{{0, 4}, {8, 4}}));
    EXPECT_EQ(joined({{0, 4}, {8, 4}}, {{4, 4}}), (std::vector<SampleRange>{{0, 12}}));
}

TEST(SampleRangeTest, samples_must_not_count_twice) {
    EXPECT_THAT(messageOf([] { joined({{0, 4}}, {{3, 4}}); }), HasSubstr("sample 3 is there already"));
    EXPECT_THAT(messageOf([] { joined({{0, 8}}, {{2, 2}}); }), HasSubstr("sample 2 is there already"));
}

} // namespace
} // namespace apeiron::io
