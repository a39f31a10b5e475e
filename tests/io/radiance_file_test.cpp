#include "io/radiance_file.hpp"

#include "io/image_file.hpp"
#include "io_support.hpp"

namespace apeiron::io {
namespace {

using test::messageOf;
using test::TemporaryFolder;
using testing::HasSubstr;

class RadianceFileTest : public testing::Test {
  protected:
    TemporaryFolder folder_;
};

TEST_F(RadianceFileTest, hdr_files_are_read_as_they_are) {
    std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    for (const int byte : {128, 64, 32, 129, 128, 128, 128, 136}) // mantissas / 256 times 2^(exponent - 128)
        file += static_cast<char>(byte);
    const auto path = folder_.path() / "a.hdr";
    writeFile(path, file);
    const Image<float> image = readRadiance(path);
    ASSERT_EQ(image.width(), 2);
    ASSERT_EQ(image.height(), 1);
    EXPECT_THAT(image.data(), testing::ElementsAre(1.0F, 0.5F, 0.25F, 128.0F, 128.0F, 128.0F));
}

TEST_F(RadianceFileTest, png_files_come_out_of_srgb) {
    Image<float> picture(2, 1, 4);
    picture.data() = {0.5F, 1.0F, 0.0F, 1.0F, 0.0F, 0.0F, 1.0F, 1.0F};
    const auto path = folder_.path() / "a.png";
    writeImage(path, picture, 16, Json::object());
    const Image<float> image = readRadiance(path);
    EXPECT_NEAR(image.at(0, 0)[0], 0.21404F, 2e-5F); // IEC 61966-2-1; 16 bits
    EXPECT_EQ(image.at(0, 0)[1], 1.0F);
    EXPECT_EQ(image.at(1, 0)[2], 1.0F);
}

TEST_F(RadianceFileTest, missing_foreign_and_truncated_files_say_so) {
    EXPECT_THAT(messageOf([&] { readRadiance(folder_.path() / "no.exr"); }),
                HasSubstr("no.exr: there is no such file"));
    const auto foreign = folder_.path() / "a.hdr";
    writeFile(foreign, "this is no picture");
    EXPECT_THAT(messageOf([&] { readRadiance(foreign); }), HasSubstr("a.hdr: "));
    const auto damaged = folder_.path() / "b.hdr";
    writeFile(damaged, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100 +X 200\nxx");
    EXPECT_THAT(messageOf([&] { readRadiance(damaged); }), HasSubstr("b.hdr: "));
    const auto huge = folder_.path() / "c.hdr";
    writeFile(huge, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n");
    EXPECT_THAT(messageOf([&] { readRadiance(huge); }), HasSubstr("c.hdr: "));
}

} // namespace
} // namespace apeiron::io
