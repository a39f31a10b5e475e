// The same scene, seed and number of samples is the same picture, however it was worked out.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

/// Every use of random numbers, in a size that no tile or block divides.
scene::Scene noisy() {
    scene::Scene scene = darkSphere({45, 27});
    scene.subject.set("formula", formulaOf("min(length(p) - 1.0, length(p - vec3(0.5, -0.9, 0.9)) - 0.4)", 2.0));
    setAll(scene, {{"renderer.shadow", "sampled"},
                   {"renderer.ambient_occlusion", "sampled"},
                   {"renderer.brdf", "ggx"},
                   {"camera.filter", "gaussian"},
                   {"environment.type", "gradient"},
                   {"lights", R"([{"type": "sun", "size": 10}, {"type": "point", "radius": 0.4}])"},
                   {"output.samples", "3"}});
    return scene;
}

/// The reference: everything at once.
const Image<float>& reference() {
    static const Image<float> picture = rendered(noisy(), {})->picture();
    return picture;
}

struct Way {
    std::int64_t tilePixels;
    int interleave;
};
class EveryWay : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Picture, EveryWay,
                         testing::Values(Way{0, 1}, Way{0, 2}, Way{0, 8}, Way{1000, 1}, Way{1000, 4}, Way{4096, 2},
                                         Way{4096, 8}, Way{77, 1}, Way{77, 4}, Way{77, 8}),
                         [](const auto& instance) {
                             return fmt::format("tile_{}_interleave_{}", instance.param.tilePixels,
                                                instance.param.interleave);
                         });

TEST_P(EveryWay, is_the_same_in_every_bit_whatever_the_budget) {
    session::Options options;
    options.tilePixels = GetParam().tilePixels;
    options.interleave = GetParam().interleave;
    session::Session session(context(), noisy(), options);
    for (const double budget : {0.001, 0.01, 1.0}) {
        session.reset();
        while (!session.step(budget).finished) {
        }
        EXPECT_EQ(session.samples(), 3);
        EXPECT_TRUE(identical(session.picture(), reference())) << "budget " << budget;
        EXPECT_TRUE(identical(session.picture(), reference())) << "asked again";
    }
}

TEST(Picture, is_the_same_after_a_journey_through_other_scenes) {
    session::Session session(context(), noisy());
    session.step(0.001);
    session.set("camera.fov", std::string_view("55"));
    session.step(0.01);
    session.set("output.width", std::string_view("64"));
    session.set("subject.formula", std::string_view("menger"));
    session.step(0.01);
    session.setScene(noisy());
    finish(session);
    EXPECT_TRUE(identical(session.picture(), reference()));
}

TEST(Picture, depends_on_the_seed) {
    scene::Scene scene = noisy();
    setAll(scene, {{"output.seed", "1"}});
    const Image<float> other = rendered(scene, {})->picture();
    std::size_t different = 0;
    for (std::size_t i = 0; i < other.data().size(); ++i)
        different += other.data()[i] != reference().data()[i];
    EXPECT_GT(different, other.data().size() / 4) << "only alpha and saturated pixels may be equal";
    setAll(scene, {{"output.seed", "0"}});
    EXPECT_TRUE(identical(rendered(scene, {})->picture(), reference()));
}

render::Accumulation samples(int first, int count) {
    scene::Scene scene = noisy();
    scene.output.set("first_sample", std::int64_t{first});
    scene.output.set("samples", std::int64_t{count});
    return rendered(scene, {})->accumulation();
}

/// The largest difference relative to the values' own size, in units of float's last place (2^-23).
double largestUlps(const Image<float>& a, const Image<float>& b, double floor) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i) {
        const auto x = static_cast<double>(a.data()[i]);
        const auto y = static_cast<double>(b.data()[i]);
        largest = std::max(largest, std::abs(x - y) / std::max({std::abs(x), std::abs(y), floor}));
    }
    return largest * 8388608.0;
}

TEST(Accumulation, of_two_machines_is_that_of_one) {
    const render::Accumulation whole = samples(0, 8);
    const render::Accumulation first = samples(0, 4);
    const render::Accumulation second = samples(4, 4);
    for (const bool swapped : {false, true}) {
        render::Accumulation merged = swapped ? second : first;
        merged.merge(swapped ? first : second);
        for (std::size_t i = 3; i < merged.mean.data().size(); i += 4)
            ASSERT_EQ(merged.mean.data()[i], 8.0F);
        // Eight updates of a running mean, each rounded once, against two times four and one more.
        EXPECT_LE(largestUlps(merged.mean, whole.mean, 0.01), 8.0);
        EXPECT_LE(largestUlps(merged.normal, whole.normal, 1.0), 8.0);
        EXPECT_LE(largestUlps(merged.albedo, whole.albedo, 0.01), 8.0);
        // Squares of differences lose what the means have in common: relative to the mean's own square.
        double worst = 0.0;
        for (std::size_t i = 0; i < whole.spread.data().size(); ++i) {
            const double mean = whole.mean.data()[i];
            const double difference = static_cast<double>(merged.spread.data()[i]) - whole.spread.data()[i];
            worst = std::max(worst, std::abs(difference) / (1e-4 + mean * mean + whole.spread.data()[i]));
        }
        EXPECT_LT(worst, 16.0 / 8388608.0);
    }
}

TEST(Accumulation, parts_are_other_samples_than_the_first) {
    EXPECT_GT(largestDifference(samples(0, 4).mean, samples(4, 4).mean), 0.01);
}

} // namespace
} // namespace apeiron::test
