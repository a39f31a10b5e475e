// Random numbers and the pixel filters made of them.

#include "gpu_support.hpp"

#include <cmath>

namespace apeiron::test {
namespace {

/// The picture of `text` for each of the samples [first, first + count), with the uniforms of random.glsl set.
std::vector<Image<float>> samplesOf(const std::string& text, glm::ivec2 size, std::uint32_t first, std::uint32_t count,
                                    std::uint32_t seed = 0, int filter = 0) {
    gpu::ShaderSource source;
    source.addFile("render/glsl/camera.glsl");
    source.addText("test", text);
    gpu::Kernel kernel(context(), "test", source, gpu::Stage::Fragment, {gpu::PixelFormat::RGBA32F});
    const gpu::Texture texture(context(), gpu::PixelFormat::RGBA32F, size, "test");
    const gpu::Targets targets(context(), {&texture});
    kernel.set("random_seed", seed);
    kernel.set("camera_filter", filter);
    std::vector<Image<float>> images;
    for (std::uint32_t i = 0; i < count; ++i) {
        kernel.set("random_sample", first + i);
        kernel.run(targets);
        images.push_back(texture.download());
    }
    return images;
}

constexpr const char* kTwoPairs =
    "void kernel_main(ivec2 pixel, out vec4 a) { a = vec4(random_pair(pixel, 0u), random_pair(pixel, 1u)); }\n";
constexpr glm::ivec2 kSize{24, 24};

TEST(RandomPair, lies_in_the_unit_square) {
    for (const Image<float>& image : samplesOf(kTwoPairs, kSize, 0, 16)) {
        for (const float value : image.data()) {
            ASSERT_GE(value, 0.0F);
            ASSERT_LT(value, 1.0F);
        }
    }
}

TEST(RandomPair, any_16_aligned_samples_of_a_pixel_hit_every_elementary_interval_once) {
    // The defining property of a (0,2)-sequence in base 2 (Niederreiter 1987), which Owen's scrambling keeps.
    for (const std::uint32_t first : {0U, 16U, 48U, 1000000U * 16U}) {
        const auto images = samplesOf(kTwoPairs, kSize, first, 16, 7);
        for (int y = 0; y < kSize.y; ++y) {
            for (int x = 0; x < kSize.x; ++x) {
                for (int pair = 0; pair < 2; ++pair) {
                    for (int columns = 1; columns <= 16; columns *= 2) {
                        const int rows = 16 / columns;
                        unsigned seen = 0;
                        for (const Image<float>& image : images) {
                            const float* u = image.at(x, y) + 2 * pair;
                            const int cell = static_cast<int>(u[1] * static_cast<float>(rows)) * columns +
                                             static_cast<int>(u[0] * static_cast<float>(columns));
                            seen |= 1U << cell;
                        }
                        ASSERT_EQ(seen, 0xFFFFU) << x << "," << y << " from " << first << ", " << columns << " columns";
                    }
                }
            }
        }
    }
}

TEST(RandomPair, is_uniform_over_pixels_and_samples) {
    constexpr int kCells = 16;
    const auto images =
        samplesOf(kTwoPairs, kSize, 0, 40, 3); // 40: no power of two, so that it is not by stratification
    std::vector<double> counts(kCells * kCells);
    double n = 0.0;
    for (const Image<float>& image : images) {
        for (std::size_t i = 0; i < image.data().size(); i += 2, n += 1.0) {
            ++counts[static_cast<std::size_t>(image.data()[i] * kCells) * kCells +
                     static_cast<std::size_t>(image.data()[i + 1] * kCells)];
        }
    }
    const double expected = n / (kCells * kCells);
    double chi2 = 0.0;
    for (const double count : counts)
        chi2 += (count - expected) * (count - expected) / expected;
    // 255 degrees of freedom: mean 255, deviation 22.6; stratified numbers stay below. Six deviations.
    EXPECT_LT(chi2, 255.0 + 6.0 * 22.6);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += (a[i] - 0.5) * (b[i] - 0.5);
    return 12.0 * sum / static_cast<double>(a.size());
}

TEST(RandomPair, does_not_correlate_between_dimensions_pairs_pixels_samples_and_seeds) {
    constexpr std::uint32_t kCount = 32;
    const auto images = samplesOf(kTwoPairs, kSize, 0, kCount);
    const auto others = samplesOf(kTwoPairs, kSize, 0, kCount, 1);
    std::vector<double> x;
    std::vector<double> y;
    std::vector<double> pair;
    std::vector<double> right;
    std::vector<double> below;
    std::vector<double> next;
    std::vector<double> seed;
    for (std::uint32_t i = 0; i + 1 < kCount; ++i) {
        for (int row = 0; row + 1 < kSize.y; ++row) {
            for (int column = 0; column + 1 < kSize.x; ++column) {
                const float* here = images[i].at(column, row);
                x.push_back(static_cast<double>(here[0]));
                y.push_back(static_cast<double>(here[1]));
                pair.push_back(static_cast<double>(here[2]));
                right.push_back(static_cast<double>(images[i].at(column + 1, row)[0]));
                below.push_back(static_cast<double>(images[i].at(column, row + 1)[0]));
                next.push_back(static_cast<double>(images[i + 1].at(column, row)[0]));
                seed.push_back(static_cast<double>(others[i].at(column, row)[0]));
            }
        }
    }
    // Independent numbers correlate by 1 / sqrt(n).
    const double limit = 5.0 / std::sqrt(static_cast<double>(x.size()));
    EXPECT_LT(std::abs(correlation(x, y)), limit) << "x and y of a pair";
    EXPECT_LT(std::abs(correlation(x, pair)), limit) << "two pairs of a sample";
    EXPECT_LT(std::abs(correlation(x, right)), limit) << "a pixel and the next one";
    EXPECT_LT(std::abs(correlation(x, below)), limit) << "a pixel and the one below";
    EXPECT_LT(std::abs(correlation(x, seed)), limit) << "two seeds";
    // Samples of a pixel are stratified, so that each keeps away from the one before.
    EXPECT_LT(correlation(x, next), 0.0) << "a sample and the next one";
}

struct FilterTruth {
    int filter;
    const char* name;
    double variance;
    double reach;
};
class EveryFilter : public testing::TestWithParam<FilterTruth> {};
INSTANTIATE_TEST_SUITE_P(Camera, EveryFilter,
                         testing::Values(FilterTruth{0, "box", 1.0 / 12.0, 0.5}, FilterTruth{1, "tent", 1.0 / 6.0, 1.0},
                                         // A Gaussian of sigma 0.45 whose radius is cut to 1.5: E[min(X, m)] of an
                                         // exponential X is 1 - exp(-m), m = 1.5^2 / (2 sigma^2).
                                         FilterTruth{2, "gaussian", 0.2025 * (1.0 - std::exp(-2.25 / 0.405)), 1.5}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(EveryFilter, spreads_samples_by_its_variance_about_the_pixels_centre) {
    const FilterTruth& truth = GetParam();
    const auto images =
        samplesOf("void kernel_main(ivec2 pixel, out vec4 a) { a = vec4(camera_jitter(pixel), 0, 0); }\n", {32, 32}, 0,
                  64, 5, truth.filter);
    double n = 0.0;
    glm::dvec2 sum(0.0);
    glm::dvec2 squares(0.0);
    double product = 0.0;
    double fourth = 0.0;
    for (const Image<float>& image : images) {
        for (std::size_t i = 0; i < image.data().size(); i += 4, n += 1.0) {
            const glm::dvec2 at(image.data()[i], image.data()[i + 1]);
            ASSERT_LE(std::max(std::abs(at.x), std::abs(at.y)), truth.reach * (1.0 + 1e-6));
            sum += at;
            squares += at * at;
            product += at.x * at.y;
            fourth += std::pow(at.x, 4.0);
        }
    }
    // Five standard errors of independent samples; these are stratified and do better.
    const double meanError = 5.0 * std::sqrt(truth.variance / n);
    EXPECT_NEAR(sum.x / n, 0.0, meanError);
    EXPECT_NEAR(sum.y / n, 0.0, meanError);
    const double varianceError = 5.0 * std::sqrt((fourth / n - truth.variance * truth.variance) / n);
    EXPECT_NEAR(squares.x / n, truth.variance, varianceError);
    EXPECT_NEAR(squares.y / n, truth.variance, varianceError);
    EXPECT_NEAR(product / n, 0.0, 5.0 * truth.variance / std::sqrt(n));
}

} // namespace
} // namespace apeiron::test
