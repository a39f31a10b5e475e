// What is to be seen right after an edit of a volume: a whole picture, and of the edit.

#include "volume_support.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::test {
namespace {

constexpr int kSize = 64;
constexpr int kReference = 48; ///< samples
constexpr int kBlock = 16;

/// A ball with a shell around it, lit from one side, in front of a grey world: bright everywhere.
scene::Scene shell(const char* renderer) {
    provide("shell", 32, [](glm::dvec3 p, int) {
        const double r = glm::length(p);
        return r < 9.0 ? 0.8 : (r < 14.0 ? 0.3 : 0.0);
    });
    scene::Scene scene = volumeScene("shell", 34.0, {kSize, kSize});
    scene.set("subject.density", Json(20.0));
    setAll(scene, {{"environment.color", "0.4,0.4,0.4"}, {"output.samples", "6"}});
    scene.set("renderer.type", std::string_view(renderer));
    scene.set("subject.transfer",
              R"({"window": {"level": 0.5, "width": 1}, "space": "linear", "points": [
        {"value": 0.1, "color": [0.9, 0.6, 0.4], "opacity": 0}, {"value": 1, "color": [0.9, 0.6, 0.4], "opacity": 1}]})");
    scene.set("lights", Json::parse(R"([{"type": "sun", "azimuth": 230, "elevation": 40, "color": [1, 1, 1],
        "intensity": 3, "size": 2}, {"type": "rectangle", "position": [40, -40, 10], "target": [0, 0, 0],
        "width": 20, "height": 20, "color": [1, 0.5, 0.5], "intensity": 3000}])"));
    return scene;
}

struct VolumeEdit {
    const char* name;
    const char* path;
    const char* value;
};

constexpr VolumeEdit kEdits[] = {
    {"transfer", "subject.transfer",
     R"({"window": {"level": 0.5, "width": 1}, "space": "linear", "points": [
        {"value": 0.5, "color": [0.2, 0.9, 0.4], "opacity": 0}, {"value": 0.6, "color": [0.2, 0.9, 0.4], "opacity": 1}]})"},
    {"window", "subject.transfer", R"({"window": {"level": 1.2, "width": 1.2}, "space": "linear", "points": [
        {"value": 0.1, "color": [0.9, 0.6, 0.4], "opacity": 0}, {"value": 1, "color": [0.9, 0.6, 0.4], "opacity": 1}]})"},
    {"clip_low", "subject.clip_low", "-100,-2,-100"},
    {"clip", "subject.clip", "true"},
    {"light", "lights.0.azimuth", "320"},
    {"area light", "lights.1.intensity", "9000"},
    {"density", "subject.density", "3"},
};

/// A sum over a block of pixels.
struct BlockSum {
    double mean = 0.0;
    double pixels = 0.0;   ///< variance of the pixels' values
    double variance = 0.0; ///< of one sample of a pixel
};

BlockSum blockOf(const Image<float>& image, const Image<float>* spread, std::int64_t samples, glm::ivec2 block,
                 int channel) {
    BlockSum sum;
    double squares = 0.0;
    constexpr double kCount = kBlock * kBlock;
    for (int y = kBlock * block.y; y < kBlock * (block.y + 1); ++y) {
        for (int x = kBlock * block.x; x < kBlock * (block.x + 1); ++x) {
            const double value = image.at(x, y)[channel];
            sum.mean += value / kCount;
            squares += value * value / kCount;
            if (spread != nullptr)
                sum.variance += spread->at(x, y)[channel] / static_cast<double>(samples - 1) / kCount;
        }
    }
    sum.pixels = std::max(squares - sum.mean * sum.mean, 0.0);
    return sum;
}

/// That a picture of which at least 1/16 of the pixels are there is what another session converges to, but for noise.
void expectCoarse(const Image<float>& shown, session::Session& reference, const std::string& what) {
    finish(reference);
    const render::Accumulation all = reference.accumulation();
    ASSERT_TRUE(allFinite(shown));
    int off = 0;
    for (int y = 0; y < kSize / kBlock; ++y) {
        for (int x = 0; x < kSize / kBlock; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                const BlockSum truth = blockOf(all.mean, &all.spread, reference.samples(), {x, y}, channel);
                const BlockSum now = blockOf(shown, nullptr, 1, {x, y}, channel);
                // A sub-image has 16 samples in a block, each of a pixel of its own: five deviations of their mean, the
                // reference's own noise, and half a cell at the edges between bright and dark.
                const double sigma = std::sqrt((truth.variance + truth.pixels) / 16.0);
                const bool same = std::abs(now.mean - truth.mean) < 5.0 * sigma + 0.02 * truth.mean;
                EXPECT_TRUE(same) << what << ", block " << x << "," << y << ", channel " << channel << ": " << now.mean
                                  << " instead of " << truth.mean << ", sigma " << sigma;
                off += same ? 0 : 1;
                if (off > 5) return;
            }
        }
    }
    // Pixels of no light at all where there is some: in a grey world a path brings nothing only where all is absorbed.
    for (std::size_t i = 0; i < shown.data().size(); i += 4)
        ASSERT_GT(shown.data()[i + 3], 0.0F) << what << ": a hole at " << i / 4;
}

class VolumeEdits : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Renderers, VolumeEdits, testing::Values("mcm", "eam"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(VolumeEdits, show_a_full_picture_in_the_next_step) {
    scene::Scene scene = shell(GetParam());
    setAll(scene, {{"subject.clip_low", "-100,-100,-100"}});
    scene::Scene finished = scene;
    finished.set("output.samples", Json(kReference));
    // Emission and absorption has hardly any noise, but takes its time.
    const bool paths = GetParam() == std::string_view("mcm");
    for (const auto& [interleave, specialise] : {std::pair{4, false}, std::pair{4, true}, std::pair{8, false}}) {
        if (!paths && (specialise || interleave == 8)) continue;
        if (!paths) finished.set("output.samples", Json(4));
        session::Session session(context(), scene, {.stage = {}, .specialise = specialise, .interleave = interleave});
        session::Session reference(context(), finished, {.stage = {}, .specialise = false});
        finish(session);
        for (const VolumeEdit& edit : kEdits) {
            const std::string what = fmt::format("{}, {} x {}, {}", edit.name, interleave, interleave,
                                                 specialise ? "constants" : "uniforms");
            const Image<float> before = session.layers().radiance;
            session.set(edit.path, std::string_view(edit.value));
            reference.set(edit.path, std::string_view(edit.value));
            EXPECT_EQ(session.samples(), 0) << what;
            // Until then the old picture: not a black one.
            EXPECT_TRUE(identical(session.layers().radiance, before)) << what;
            // Time for a sub-image, however busy the machine: it is a part of a picture of a few milliseconds.
            EXPECT_TRUE(session.step(0.4).changed) << what;
            // Coarser pictures have fewer samples in a block than the tolerance says.
            while (session.samples() == 0 && session.progress() < 0.0625)
                session.step(0.0);
            expectCoarse(session.layers().radiance, reference, what);
            finish(session);
        }
    }
}

TEST(VolumeEdit, that_needs_other_kernels_shows_what_a_new_session_shows) {
    for (const char* renderer : {"mcm", "eam"}) {
        scene::Scene scene = shell(renderer);
        setAll(scene, {{"output.width", "24"}, {"output.height", "24"}, {"output.samples", "2"}});
        session::Session session(context(), scene, {.stage = {}, .specialise = false});
        for (const auto& [path, value] :
             {std::pair{"lights", "[]"},
              {"lights", R"([{"type": "point", "position": [30, -40, 20], "intensity": 3000, "radius": 4}])"},
              {"lights", R"([{"type": "rectangle", "position": [40, -40, 10], "width": 20, "height": 20,
                  "intensity": 3000, "visible": true}, {"type": "sun", "intensity": 2}])"},
              // Two rows of cells of the distribution have all the light: 4 times the mean and more.
              {"environment", R"({"type": "gradient", "top": [20, 20, 20], "horizon": [0, 0, 0], "bottom": [0, 0, 0],
                  "sharpness": 0.1})"},
              {"environment", R"({"type": "constant", "color": [0.4, 0.4, 0.4]})"},
              {"subject.transfer", R"({"window": "none", "shapes": [{"type": "box", "center": [0.5, 0.5],
                  "size": [0.8, 0.9], "color": "#80ff40", "opacity": 0.8}]})"},
              {"subject.transfer", R"({"window": "none", "points": [{"value": 0, "opacity": 0}, {"value": 1,
                  "color": "#4080ff", "opacity": 1, "emission": 2}]})"},
              {"subject.transfer", R"({"window": "none", "points": [{"value": 0, "opacity": 0},
                  {"value": 1, "opacity": 1}]})"}}) {
            const Image<float> before = session.picture();
            scene.set(path, Json::parse(value));
            session.set(path, std::string_view(value));
            finish(session);
            const auto anew = rendered(scene, {.stage = {}, .specialise = false});
            EXPECT_TRUE(identical(session.picture(), anew->picture())) << renderer << ": " << path << " " << value;
            EXPECT_FALSE(identical(session.picture(), before)) << renderer << ": " << path << " " << value;
        }
    }
}

TEST(VolumeEdit, of_how_the_picture_is_shown_keeps_the_samples) {
    scene::Scene scene = shell("mcm");
    scene.set("output.samples", Json(1000));
    session::Session session(context(), scene, {.interleave = 4});
    while (session.samples() < 3)
        session.step(0.0);
    Image<float> before = session.picture();
    for (const auto& [path, value] :
         {std::pair{"post.exposure", "-1.5"}, std::pair{"post.tonemapper", "reinhard"},
          std::pair{"post.effects", R"([{"type": "denoise"}])"}, std::pair{"post.effects.0.enabled", "false"},
          std::pair{"post.exposure_mode", "auto"}}) {
        const std::int64_t samples = session.samples();
        EXPECT_EQ(session.set(path, std::string_view(value)), parameter::Invalidates::Present) << path;
        EXPECT_EQ(session.samples(), samples) << path;
        const Image<float> after = session.picture();
        EXPECT_FALSE(identical(after, before)) << path << " shows";
        while (session.samples() == samples)
            session.step(0.0);
        EXPECT_EQ(session.samples(), samples + 1) << path << ": the samples go on";
        before = session.picture();
    }
}

} // namespace
} // namespace apeiron::test
