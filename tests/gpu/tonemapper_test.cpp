// Tone mappers against their published curves, in double precision.

#include "gpu_support.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

/// Radiance of 1e-6 to 1e6, evenly on a logarithmic scale.
std::vector<double> ramp() {
    std::vector<double> values{0.0};
    for (int i = 0; i <= 240; ++i)
        values.push_back(std::pow(10.0, -6.0 + i / 20.0));
    return values;
}

/// IEC 61966-2-1, backwards.
double linear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// What a tone mapper makes of colours, before the display's encoding.
std::vector<glm::dvec3> mapped(const std::string& tonemapper, const std::vector<glm::dvec3>& colors,
                               const std::vector<std::pair<const char*, double>>& values = {}) {
    parameter::Node post(session::catalogue()->type("post", ""));
    post.set("tonemapper", parameter::ModuleReference{tonemapper, {}});
    for (const auto& [name, value] : values)
        post.set(name, value);
    const glm::ivec2 size(static_cast<int>(colors.size()), 1);
    std::vector<float> texels;
    for (const glm::dvec3& color : colors)
        for (const double value : {color.x, color.y, color.z, 1.0})
            texels.push_back(static_cast<float>(value));
    gpu::Texture picture(context(), gpu::PixelFormat::RGBA32F, size, "ramp");
    picture.upload(texels);
    const Image<float> image = runKernel(post::displaySource(post), gpu::Stage::Fragment, size, 1, [&](auto& kernel) {
        kernel.setParameters("post", post);
        kernel.set("effect_color", picture);
        kernel.set("display_exposure", 1.0F);
    })[0];
    EXPECT_TRUE(allFinite(image)) << tonemapper;
    std::vector<glm::dvec3> results;
    for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 encoded = rgb(image.at(x, 0));
        results.emplace_back(linear(encoded.x), linear(encoded.y), linear(encoded.z));
    }
    return results;
}

std::vector<glm::dvec3> greys(const std::vector<double>& values) {
    std::vector<glm::dvec3> colors;
    for (const double value : values)
        colors.emplace_back(value);
    return colors;
}

/// Every grey of the ramp is where the curve puts it.
void expectCurve(const std::string& tonemapper, const std::function<double(double)>& curve, double tolerance) {
    const std::vector<double> values = ramp();
    const std::vector<glm::dvec3> results = mapped(tonemapper, greys(values));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double truth = std::clamp(curve(values[i]), 0.0, 1.0);
        ASSERT_NEAR(results[i].y, truth, tolerance) << tonemapper << " of " << values[i];
    }
}

class EveryTonemapper : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Tonemapper, EveryTonemapper, testing::ValuesIn(parameter::moduleNames("tonemappers")),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryTonemapper, keeps_black_and_never_makes_more_light_darker) {
    const std::vector<glm::dvec3> results = mapped(GetParam(), greys(ramp()));
    EXPECT_LT(results.front().y, 1e-4);
    for (std::size_t i = 1; i < results.size(); ++i)
        ASSERT_GE(results[i].y, results[i - 1].y - 2e-6) << i; // rounding of the encoding's power
    EXPECT_GT(results.back().y, 0.98) << "the brightest is not white";
}

TEST_P(EveryTonemapper, leaves_grey_grey_and_the_order_of_the_channels) {
    std::vector<glm::dvec3> colors;
    for (const double value : ramp())
        colors.push_back(value * glm::dvec3(1.0, 0.4, 0.1));
    const std::vector<glm::dvec3> results = mapped(GetParam(), colors);
    for (std::size_t i = 0; i < colors.size(); ++i) {
        // AgX' published matrices turn white into something redder by 3e-4.
        ASSERT_GE(results[i].x, results[i].y - 5e-4) << colors[i].x;
        ASSERT_GE(results[i].y, results[i].z - 5e-4) << colors[i].x;
    }
    for (const glm::dvec3& grey : mapped(GetParam(), greys(ramp()))) {
        // The published matrices have rows that sum to 1 within their five decimals; slopes are up to about 10.
        ASSERT_NEAR(grey.x, grey.y, 1e-3);
        ASSERT_NEAR(grey.z, grey.y, 1e-3);
    }
}

TEST(Tonemapper, simple_reinhard_is_that_of_the_paper) {
    expectCurve(
        "reinhard_simple", [](double x) { return x / (1.0 + x); }, 3e-6);
}

TEST(Tonemapper, hable_is_his_curve_with_his_white_point) {
    const auto hable = [](double x) {
        const double a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
        return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
    };
    expectCurve(
        "hable", [&](double x) { return x >= 11.2 ? 1.0 : hable(2.0 * x) / hable(22.4); }, 1e-5);
    const std::vector<glm::dvec3> ends = mapped("hable", greys({2.999, 3.0}), {{"white", 3.0}});
    EXPECT_LT(ends[0].y, 1.0 - 1e-5);
    EXPECT_NEAR(ends[1].y, 1.0, 1e-6);
}

TEST(Tonemapper, aces_is_hills_fit) {
    const auto fit = [](double v) {
        return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    };
    // Grey stays grey to the fifth decimal of the matrices.
    expectCurve("aces", fit, 1e-4);
}

TEST(Tonemapper, range_is_a_window) {
    const auto results = mapped("range", greys({1.0, 2.0, 3.0, 4.0, 9.0}), {{"low", 2.0}, {"high", 4.0}});
    const std::array<double, 5> truth{0.0, 0.0, 0.5, 1.0, 1.0};
    for (std::size_t i = 0; i < truth.size(); ++i)
        EXPECT_NEAR(results[i].y, truth[i], 3e-6) << i;
}

TEST(Tonemapper, artistic_has_its_middle_half_way_and_its_saturation) {
    const auto ends = mapped("artistic", greys({0.5, 2.0, 8.0}), {{"low", 0.5}, {"middle", 2.0}, {"high", 8.0}});
    EXPECT_NEAR(ends[0].y, 0.0, 3e-6);
    EXPECT_NEAR(ends[1].y, 0.5, 3e-6);
    EXPECT_NEAR(ends[2].y, 1.0, 3e-6);
    const auto grey = mapped("artistic", {glm::dvec3(0.1, 0.5, 0.2)}, {{"saturation", 0.0}});
    EXPECT_NEAR(grey[0].x, grey[0].y, 3e-6);
}

TEST(Tonemapper, filmic_is_the_published_curve) {
    expectCurve(
        "filmic",
        [](double c) {
            const double x = std::max(0.0, c - 0.004);
            return std::pow(x * (6.2 * x + 0.5) / (x * (6.2 * x + 1.7) + 0.06), 2.2);
        },
        2e-5);
}

TEST(Tonemapper, unreal_is_the_published_curve) {
    expectCurve(
        "unreal", [](double x) { return std::pow(std::min(1.019 * x / (x + 0.155), 1.0), 2.2); }, 2e-5);
}

TEST(Tonemapper, lottes_goes_through_its_grey_and_its_white) {
    const auto results = mapped("lottes", greys({0.18, 7.9, 8.0}));
    EXPECT_NEAR(results[0].y, 0.267, 1e-4);
    EXPECT_LT(results[1].y, 0.9999);
    EXPECT_NEAR(results[2].y, 1.0, 1e-4);
}

TEST(Tonemapper, uchimura_is_linear_between_toe_and_shoulder) {
    const auto results = mapped("uchimura", greys({0.1, 0.3, 0.5, 1.0}));
    EXPECT_LT(results[0].y, 0.1) << "the toe is darker";
    EXPECT_NEAR(results[1].y, 0.3, 1e-5);
    EXPECT_NEAR(results[2].y, 0.5, 1e-5);
    // 1 - (P - S1) exp(-C2 (x - S0) / P) with S0 = S1 = 0.532, C2 = 1 / 0.468
    EXPECT_NEAR(results[3].y, 1.0 - 0.468 * std::exp(-1.0), 1e-5);
}

TEST(Tonemapper, agx_is_the_published_curve) {
    // Wrensch's polynomial (2023) of Sobotka's curve is within 0.006 of it, as display values.
    const std::vector<double> values = ramp();
    const std::vector<glm::dvec3> results = mapped("agx", greys(values));
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double x = std::clamp((std::log2(values[i]) + 12.47393) / (12.47393 + 4.026069), 0.0, 1.0);
        const double x2 = x * x;
        const double polynomial = 15.5 * x2 * x2 * x2 - 40.14 * x2 * x2 * x + 31.96 * x2 * x2 - 6.868 * x2 * x +
                                  0.4298 * x2 + 0.1191 * x - 0.00232;
        ASSERT_NEAR(std::pow(results[i].y, 1.0 / 2.2), polynomial, 0.006) << values[i];
    }
}

TEST(Tonemapper, agx_takes_saturated_light_to_white) {
    const auto results = mapped("agx", {glm::dvec3(0, 0, 0.5), glm::dvec3(0, 0, 1e4)});
    EXPECT_GT(results[0].z, 3.0 * results[0].x) << "blue is blue";
    EXPECT_GT(std::min(results[1].x, results[1].y), 0.3) << "a blue laser is almost white";
    const auto grey = mapped("agx", {glm::dvec3(0.1, 0.5, 0.2)}, {{"saturation", 0.0}});
    EXPECT_NEAR(grey[0].x, grey[0].y, 1e-3);
}

} // namespace
} // namespace apeiron::test
