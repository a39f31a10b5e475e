// Automatic exposure: what the light meter makes of pictures whose average is known.

#include "gpu_support.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

/// The factor for a picture of 96 x 64 pixels.
double factorOf(const std::function<glm::vec4(int, int)>& picture, double key = 0.18,
                gpu::Stage stage = gpu::Stage::Fragment) {
    const glm::ivec2 size(96, 64);
    std::vector<float> texels;
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const glm::vec4 color = picture(x, y);
            for (int c = 0; c < 4; ++c)
                texels.push_back(color[c]);
        }
    }
    gpu::Texture texture(context(), gpu::PixelFormat::RGBA32F, size, "picture");
    texture.upload(texels);
    gpu::KernelCache cache(context());
    post::Meter meter(context(), cache, stage);
    meter.run(texture, key);
    context().finish();
    return static_cast<double>(meter.result().texel({0, 0}).x);
}

glm::vec4 grey(double value) {
    return glm::vec4(glm::vec3(static_cast<float>(value)), 1.0F);
}

/// From dark to bright over 8 stops, whatever the place.
double gradient(int x, int y) {
    return std::exp2(8.0 * ((x * 64 + y) % 997) / 997.0 - 4.0);
}

TEST(Meter, brings_a_constant_picture_to_the_key) {
    for (const double value : {1e-6, 0.01, 0.18, 3.0, 1e6}) {
        for (const double key : {0.05, 0.18, 0.5}) {
            const double factor = factorOf([&](int, int) { return grey(value); }, key);
            EXPECT_NEAR(factor * value, key, 1e-4 * key) << value;
        }
    }
}

TEST(Meter, sees_luminance) {
    const double factor = factorOf([](int, int) { return glm::vec4(0.2F, 0.5F, 0.1F, 1.0F); });
    EXPECT_NEAR(factor * (0.2126 * 0.2 + 0.7152 * 0.5 + 0.0722 * 0.1), 0.18, 1e-4);
}

TEST(Meter, does_not_care_for_the_scale_of_radiance) {
    const double one = factorOf([](int x, int y) { return grey(gradient(x, y)); });
    const double thousand = factorOf([](int x, int y) { return grey(1000.0 * gradient(x, y)); });
    // Bins of a quarter of a stop fall elsewhere; within a bin the mean is exact.
    EXPECT_NEAR(1000.0 * thousand / one, 1.0, 5e-3);
}

TEST(Meter, ignores_outliers) {
    const double plain = factorOf([](int x, int y) { return grey(gradient(x, y)); });
    // A lamp over 2 percent of the picture moves the percentiles by 2 percent of 8 stops; single pixels move their
    // blocks.
    const double lamp = factorOf([](int x, int y) { return grey(x < 12 && y < 10 ? 1e6 : gradient(x, y)); });
    EXPECT_NEAR(std::log2(lamp / plain), 0.0, 0.16);
    const double fireflies =
        factorOf([](int x, int y) { return grey((x * 31 + y * 17) % 500 == 0 ? 1e9 : gradient(x, y)); });
    EXPECT_NEAR(std::log2(fireflies / plain), 0.0, 0.1);
}

TEST(Meter, ignores_what_is_black_or_transparent) {
    const double black = factorOf([](int x, int) { return x < 60 ? glm::vec4(0, 0, 0, 1) : grey(0.4); });
    EXPECT_NEAR(black * 0.4, 0.18, 1e-4);
    const double clear = factorOf([](int x, int) { return x < 60 ? glm::vec4(0.0F) : 0.5F * grey(0.4); });
    EXPECT_NEAR(clear * 0.4, 0.18, 1e-4) << "radiance is premultiplied";
    EXPECT_EQ(factorOf([](int, int) { return glm::vec4(0, 0, 0, 1); }), 1.0) << "nothing to measure";
}

TEST(Meter, gives_the_same_in_both_stages) {
    if (!context().capabilities().compute) GTEST_SKIP() << "no compute shaders here";
    const auto picture = [](int x, int y) { return grey(gradient(x, y)); };
    const double a = factorOf(picture);
    EXPECT_NEAR(factorOf(picture, 0.18, gpu::Stage::Compute), a, 1e-6 * a);
}

TEST(Exposure, automatic_shows_the_same_whatever_the_light_and_keeps_the_samples) {
    scene::Scene scene = darkSphere({64, 36});
    setAll(scene, {{"environment.type", "gradient"}, {"renderer.ambient_occlusion", "field"}});
    const auto session = rendered(scene);
    const Image<float> manual = session->picture();
    EXPECT_EQ(session->set("post.exposure_mode", std::string_view("auto")), parameter::Invalidates::Present);
    EXPECT_EQ(session->samples(), 1);
    const Image<float> automatic = session->picture();
    EXPECT_FALSE(identical(manual, automatic));
    session->set("environment.intensity", std::string_view("100"));
    finish(*session);
    EXPECT_LT(largestDifference(session->picture(), automatic), 4e-3);
    session->set("post.exposure", std::string_view("1"));
    const Image<float> compensated = session->picture();
    session->set("post.exposure", std::string_view("0"));
    session->set("post.key", std::string_view("0.36"));
    EXPECT_LT(largestDifference(session->picture(), compensated), 1e-5) << "one stop is twice the key";
    EXPECT_EQ(session->samples(), 1);
}

} // namespace
} // namespace apeiron::test
