#include "io/image_file.hpp"

#include "core/file.hpp"
#include "io/codec.hpp"
#include "io_support.hpp"

#include <cmath>

namespace apeiron::io {
namespace {

using test::document;
using test::messageOf;
using test::noisePicture;
using test::TemporaryFolder;
using test::writeEncoded;
using testing::HasSubstr;

namespace fs = std::filesystem;

std::size_t filesIn(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

std::vector<float> pixelsOf(const fs::path& path) {
    const ImageFormat format = detectImageFormat(path).value();
    return decodeFloats(path, format, decodeHeader(path, format));
}

class ImageFileTest : public testing::Test {
  protected:
    TemporaryFolder folder_;
};

TEST_F(ImageFileTest, extension_decides_the_format_whatever_its_case) {
    EXPECT_EQ(imageFormat("a/b.png"), ImageFormat::Png);
    EXPECT_EQ(imageFormat("b.JPG"), ImageFormat::Jpeg);
    EXPECT_EQ(imageFormat("b.x.jpeg"), ImageFormat::Jpeg);
    EXPECT_EQ(imageFormat("b.Exr"), ImageFormat::Exr);
    EXPECT_EQ(messageOf([] { imageFormat("b.foo"); }), "b.foo: cannot write '.foo'; known: .png .jpg .exr");
    EXPECT_THAT(messageOf([] { imageFormat("foo"); }), HasSubstr("no extension"));
}

TEST_F(ImageFileTest, png_holds_the_nearest_value_of_8_and_of_16_bits) {
    const Image<float> picture = noisePicture(37, 21, 1.0F);
    for (const int bits : {8, 16}) {
        const fs::path path = folder_ / (std::to_string(bits) + ".png");
        writeImage(path, picture, bits, document());
        const ImageInfo info = readImageInfo(path);
        EXPECT_EQ(info.format, ImageFormat::Png);
        EXPECT_EQ(info.width, 37);
        EXPECT_EQ(info.height, 21);
        ASSERT_EQ(info.channels, 3) << "an opaque picture needs no alpha";
        const std::vector<float> values = pixelsOf(path);
        // Half a step, and the rounding of values/steps to float.
        const float most = 0.5F / (bits == 8 ? 255.0F : 65535.0F) + 1e-6F;
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_NEAR(values[i], picture.data()[i / 3 * 4 + i % 3], most) << i;
    }
}

TEST_F(ImageFileTest, png_keeps_straight_alpha) {
    Image<float> picture = noisePicture(8, 8, 1.0F);
    float* pixel = picture.at(3, 5);
    pixel[0] = 1.0F;
    pixel[3] = 0.2F;
    writeImage(folder_ / "a.png", picture, 8, document());
    EXPECT_EQ(readImageInfo(folder_ / "a.png").channels, 4);
    const std::vector<float> values = pixelsOf(folder_ / "a.png");
    // The reader multiplies by alpha: 1 * 0.2 shows that 1 was stored, and not 0.2.
    EXPECT_NEAR(values[4 * (5 * 8 + 3)], 0.2F, 0.5F / 255.0F);
    EXPECT_NEAR(values[4 * (5 * 8 + 3) + 3], 0.2F, 1e-6F);
}

TEST_F(ImageFileTest, values_that_are_no_colours_are_clamped) {
    Image<float> picture(2, 2, 4);
    for (std::size_t i = 3; i < 16; i += 4)
        picture.data()[i] = 1.0F;
    picture.data()[0] = NAN;
    picture.data()[1] = -INFINITY;
    picture.data()[2] = INFINITY;
    writeImage(folder_ / "a.png", picture, 8, document());
    const std::vector<float> values = pixelsOf(folder_ / "a.png");
    EXPECT_EQ(values[0], 0.0F);
    EXPECT_EQ(values[1], 0.0F);
    EXPECT_EQ(values[2], 1.0F);
}

TEST_F(ImageFileTest, jpeg_shows_transparent_pixels_over_black) {
    Image<float> picture(16, 16, 4);
    for (std::size_t i = 0; i < picture.data().size(); ++i)
        picture.data()[i] = i % 4 == 3 ? (i < 512 ? 0.0F : 1.0F) : 0.8F;
    writeImage(folder_ / "a.jpg", picture, 8, document());
    EXPECT_EQ(readImageInfo(folder_ / "a.jpg").channels, 3);
    const std::vector<float> values = pixelsOf(folder_ / "a.jpg");
    // The border falls between two blocks of 8 rows: nothing but rounding is lost.
    EXPECT_NEAR(values.front(), 0.0F, 2.0F / 255.0F);
    EXPECT_NEAR(values.back(), 0.8F, 2.0F / 255.0F);
}

TEST_F(ImageFileTest, every_format_gives_the_scene_back) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{200'000}}) {
        const Json scene = document(size);
        for (const char* name : {"a.png", "a.jpg"}) {
            writeImage(folder_ / name, noisePicture(20, 10, 0.5F), 8, scene);
            EXPECT_EQ(Json::parse(readScene(folder_ / name)), scene) << name;
            // And the picture behind the text is still one.
            EXPECT_EQ(pixelsOf(folder_ / name).size(), 20U * 10U * (name[2] == 'p' ? 4U : 3U));
        }
    }
}

TEST_F(ImageFileTest, a_title_that_is_no_utf8_does_not_keep_a_picture_from_being_saved) {
    writeImage(folder_ / "a.png", noisePicture(4, 4, 1.0F), 8, {{"title", "\xFF\xC0"}});
    EXPECT_TRUE(Json::parse(readScene(folder_ / "a.png")).contains("title"));
}

TEST_F(ImageFileTest, a_scene_too_large_for_readers_is_refused_before_anything_is_written) {
    EXPECT_THAT(messageOf([&] { writeImage(folder_ / "a.png", noisePicture(4, 4, 1.0F), 8, document(5'000'000)); }),
                HasSubstr("too large to be saved"));
    EXPECT_EQ(filesIn(folder_.path()), 0U);
}

TEST_F(ImageFileTest, the_same_picture_gives_the_same_file) {
    for (const char* name : {"a.png", "a.jpg"}) {
        const Image<float> picture = noisePicture(20, 10, 1.0F);
        writeImage(folder_ / name, picture, 8, document());
        const std::string first = readFile(folder_ / name);
        writeImage(folder_ / name, picture, 8, document());
        EXPECT_EQ(readFile(folder_ / name), first) << name;
    }
}

TEST_F(ImageFileTest, pictures_of_others_have_no_scene) {
    for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Jpeg}) {
        const fs::path path = folder_ / "other";
        const std::vector<std::uint8_t> values(4 * 4 * 3);
        writeEncoded(path, format, {4, 4, {"R", "G", "B"}, {}}, SampleType::UInt8, values.data());
        EXPECT_EQ(messageOf([&] { readScene(path); }),
                  path.string() + ": holds no Apeiron scene; only pictures that Apeiron wrote do");
    }
}

TEST_F(ImageFileTest, what_is_no_picture_is_told_in_one_line) {
    writeFile(folder_ / "text.png", "hello");
    writeFile(folder_ / "empty.png", "");
    EXPECT_THAT(messageOf([&] { readScene(folder_ / "text.png"); }), HasSubstr("text.png: is not a PNG, JPEG or EXR"));
    EXPECT_THAT(messageOf([&] { readScene(folder_ / "empty.png"); }), HasSubstr("is not a PNG, JPEG or EXR"));
    EXPECT_THAT(messageOf([&] { readScene(folder_ / "none.png"); }), HasSubstr("none.png: there is no such file"));
    EXPECT_THAT(messageOf([&] { readScene(folder_.path()); }), HasSubstr("is a folder"));
    EXPECT_EQ(detectImageFormat(folder_.path()), std::nullopt);
}

TEST_F(ImageFileTest, damaged_files_are_errors_and_never_more) {
    for (const char* name : {"a.png", "a.jpg"}) {
        writeImage(folder_ / name, noisePicture(20, 10, 1.0F), 8, document());
        const std::string whole = readFile(folder_ / name);
        test::Random random;
        for (int i = 0; i < 300; ++i) {
            std::string damaged = whole;
            if (i % 2 == 0) damaged.resize(random.bits() % whole.size());
            for (int k = 0; k < 3 && !damaged.empty(); ++k)
                damaged[random.bits() % damaged.size()] = static_cast<char>(random.bits());
            writeFile(folder_ / "damaged", damaged);
            const std::string message = messageOf([&] {
                readScene(folder_ / "damaged");
                readImageInfo(folder_ / "damaged");
            });
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_TRUE(message == "no error" || message.find("damaged: ") != std::string::npos) << message;
        }
    }
}

TEST_F(ImageFileTest, a_header_of_absurd_size_is_refused) {
    writeImage(folder_ / "a.png", noisePicture(20, 10, 1.0F), 8, document());
    std::string bytes = readFile(folder_ / "a.png");
    for (const std::size_t byte : {16U, 20U}) // width and height in IHDR, big endian
        bytes[byte + 1] = 0x7F;
    writeFile(folder_ / "a.png", bytes);
    EXPECT_NE(messageOf([&] { readScene(folder_ / "a.png"); }), "no error");
}

TEST_F(ImageFileTest, a_failed_write_leaves_the_old_file_and_nothing_else) {
    writeFile(folder_ / "a.png", "old");
    EXPECT_THROW(writeImage(folder_ / "a.png", noisePicture(4, 4, 1.0F), 8, document(5'000'000)), Error);
    EXPECT_EQ(readFile(folder_ / "a.png"), "old");
    EXPECT_EQ(filesIn(folder_.path()), 1U);
    EXPECT_THAT(messageOf([&] { writeImage(folder_ / "no" / "a.png", noisePicture(4, 4, 1.0F), 8, document()); }),
                HasSubstr("the folder does not exist"));
}

} // namespace
} // namespace apeiron::io
