// No formula, at any values of its parameters and from any camera, gives pixels that are no numbers, hangs, or shows
// nothing without saying why.

#include "../random_parameters.hpp"
#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace apeiron::test {
namespace {

constexpr glm::ivec2 kSize{24, 16};

glm::dvec3 randomInBall(std::mt19937& random, double radius) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (;;) {
        const glm::dvec3 p(unit(random), unit(random), unit(random));
        if (glm::length(p) <= 1.0 && glm::length(p) > 0.1) return radius * p;
    }
}

/// New values for all of the formula's parameters; those that need another program only when `programs` is set.
void randomise(scene::Scene& scene, std::mt19937& random, double far, bool programs) {
    for (const parameter::Parameter& p : scene.subject.module("formula").parameters) {
        const bool program = p.invalidates == parameter::Invalidates::Program;
        if (program && !programs) continue;
        scene.subject.set(p.name, randomValue(p, random, far));
    }
    if (!programs) return;
    scene.subject.set("julia", std::uniform_int_distribution<int>(0, 2)(random) == 0);
    scene.subject.set("julia_c", randomInBall(random, 1.5));
}

/// Somewhere around or within the set, looking at some point of it.
void randomCamera(scene::Scene& scene, std::mt19937& random) {
    std::uniform_real_distribution<double> logarithm(std::log(0.3), std::log(12.0));
    const auto decimals = [](const glm::dvec3& p) {
        return parameter::Decimal3{Decimal(p.x), Decimal(p.y), Decimal(p.z)};
    };
    const glm::dvec3 direction = glm::normalize(randomInBall(random, 1.0));
    scene.camera.set("position", decimals(std::exp(logarithm(random)) * direction));
    scene.camera.set("target", decimals(randomInBall(random, 0.8)));
}

struct Seen {
    int surface = 0; ///< pictures
    int explained = 0;
};

/// Renders one sample and looks at it.
void look(session::Session& session, const std::string& what, Seen& seen) {
    finish(session);
    const auto layers = session.layers();
    const Image<float> picture = session.picture();
    ASSERT_TRUE(allFinite(layers.radiance)) << what;
    ASSERT_TRUE(allFinite(layers.geometry)) << what;
    ASSERT_TRUE(allFinite(layers.albedo)) << what;
    ASSERT_TRUE(allFinite(picture)) << what;
    ASSERT_TRUE(std::isfinite(session.distanceToSurface())) << what;
    float brightest = 0.0F;
    std::vector<float> depths;
    for (int y = 0; y < kSize.y; ++y) {
        for (int x = 0; x < kSize.x; ++x) {
            const float* rgb = picture.at(x, y);
            brightest = std::max({brightest, rgb[0], rgb[1], rgb[2]});
            if (layers.albedo.at(x, y)[3] > 0.0F) depths.push_back(layers.geometry.at(x, y)[3]);
        }
    }
    const std::string reason = session.emptyReason();
    // Right at the camera, and equally far everywhere: that is how the inside of a set looks.
    const auto [nearest, farthest] = std::minmax_element(depths.begin(), depths.end());
    const bool everywhere = depths.size() == static_cast<std::size_t>(kSize.x) * kSize.y;
    const bool inside = everywhere && *farthest < 1e-3F && *farthest <= 1.3F * *nearest;
    const bool shows = !depths.empty() && !inside && brightest > 1.0F / 255.0F;
    if (!shows) {
        EXPECT_NE(reason, "") << what;
    }
    if (everywhere && *farthest > 0.01F) {
        EXPECT_EQ(reason, "") << what;
    }
    seen.surface += shows;
    seen.explained += !reason.empty();
}

class Robustness : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Formulas, Robustness, testing::ValuesIn(parameter::moduleNames("formulas")),
                         [](const auto& instance) { return instance.param; });

TEST_P(Robustness, every_picture_is_of_numbers_and_shows_something_or_says_why_not) {
    // Parameters as uniforms: one compilation serves nearly all of the pictures.
    scene::Scene scene = sceneOf(fmt::format(
        R"({{"apeiron": 1, "subject": {{"max_steps": 150, "shadow_steps": 40}}, "output": {{"width": {}, "height": {}, "samples": 1}}}})",
        kSize.x, kSize.y));
    scene.subject.set("formula", parameter::ModuleReference{GetParam(), {}});
    session::Session session(context(), scene, session::Options{{}, false, 0, 1});
    std::mt19937 random(7);
    Seen seen;
    constexpr int kPictures = 24;
    for (int i = 0; i < kPictures; ++i) {
        scene::Scene next = scene;
        randomise(next, random, i % 2 == 0 ? 0.25 : 1.0, i >= kPictures - 2);
        randomCamera(next, random);
        session.setScene(next);
        look(session, fmt::format("{} {}: {}", GetParam(), i, next.toJson().dump()), seen);
    }
    // Most cameras look at something.
    EXPECT_GE(seen.surface, kPictures / 3) << seen.explained << " explained";
}

TEST(EmptyReason, says_that_the_camera_is_inside_that_nothing_is_in_view_or_that_it_is_dark) {
    scene::Scene scene = darkSphere({16, 16});
    const auto reasonOf = [](const scene::Scene& s) { return rendered(s)->emptyReason(); };
    EXPECT_THAT(reasonOf(scene), testing::HasSubstr("no light"));
    scene.set("environment.color", std::string_view("1,1,1"));
    EXPECT_EQ(reasonOf(scene), "");
    scene.set("camera.target", std::string_view("0,-8,0"));
    EXPECT_THAT(reasonOf(scene),
                testing::AllOf(testing::HasSubstr("nothing is in view"), testing::HasSubstr(" 3 away")));
    scene.set("camera.position", std::string_view("0,-0.5,0"));
    EXPECT_THAT(reasonOf(scene), testing::HasSubstr("inside the surface"));
}

} // namespace
} // namespace apeiron::test
