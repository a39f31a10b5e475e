// The denoiser: nearer to the converged picture than what it was given, and away where there is nothing to smooth.

#include "gpu_support.hpp"

#include <cmath>

namespace apeiron::test {
namespace {

scene::Scene sceneOf(int samples, bool denoise, int seed) {
    scene::Scene scene(session::catalogue());
    scene.set("renderer.type", "pathtrace");
    scene.set("output.width", "64");
    scene.set("output.height", "64");
    scene.set("output.samples", std::to_string(samples));
    scene.set("output.seed", std::to_string(seed));
    scene.set("post.tonemapper", "reinhard_simple");
    if (denoise) scene.set("post.effects.0.type", "denoise");
    return scene;
}

Image<float> render(int samples, bool denoise, int seed = 1) {
    session::Session session(context(), sceneOf(samples, denoise, seed));
    while (!session.step(10.0).finished) {
    }
    return session.picture();
}

double meanSquare(const Image<float>& a, const Image<float>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i)
        if (i % 4 != 3) sum += std::pow(static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]), 2.0);
    return sum / (0.75 * static_cast<double>(a.data().size()));
}

class DenoiseTest : public testing::Test {
  protected:
    static const Image<float>& reference() {
        static const Image<float> picture = render(256, false, 77);
        return picture;
    }
};

TEST_F(DenoiseTest, few_samples_come_nearer_to_the_converged_picture) {
    for (const int samples : {1, 4}) {
        const double before = meanSquare(render(samples, false), reference());
        const Image<float> after = render(samples, true);
        EXPECT_TRUE(allFinite(after));
        EXPECT_LT(meanSquare(after, reference()), 0.7 * before) << samples; // measured: 0.42 and 0.50
    }
}

TEST_F(DenoiseTest, many_samples_are_left_as_they_are) {
    const double before = meanSquare(render(128, false), reference());
    const double after = meanSquare(render(128, true), reference());
    // Measured: 2.0e-5 instead of 1.4e-5. What it takes away is less than a step of 8 bits: (1/255)^2 = 1.5e-5.
    EXPECT_LT(after, before + 1e-5) << "it does no harm where there is little left to do";
}

TEST_F(DenoiseTest, both_stages_make_the_same_picture) {
    const auto by = [](gpu::Stage stage) {
        session::Options options;
        options.stage = stage;
        session::Session session(context(), sceneOf(2, true, 1), options);
        while (!session.step(10.0).finished) {
        }
        return session.picture();
    };
    if (!context().capabilities().compute) GTEST_SKIP() << "no compute stage";
    // Exponentials of compilers' own making, seven times over.
    EXPECT_LT(meanSquare(by(gpu::Stage::Fragment), by(gpu::Stage::Compute)), 1e-6);
}

} // namespace
} // namespace apeiron::test
