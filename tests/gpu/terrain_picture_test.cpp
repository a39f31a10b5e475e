// Terrain as it is drawn: without holes, the same whichever way near hides far, the same again after a journey.

#include "gpu/raster.hpp"
#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::test {
namespace {

/// A range from above, looking slightly down, lit from the side.
scene::Scene range(int depth = 40) {
    return sceneOf(fmt::format(R"({{
        "camera": {{"position": ["0.5", "0.5", "1.2"], "target": ["3", "4", "0.4"], "fov": 60}},
        "subject": {{"type": "terrain", "seed": 3, "depth": {}, "memory": 24}},
        "renderer": {{"type": "raymarch", "ambient_occlusion": "field"}},
        "lights": [{{"type": "sun", "azimuth": 140, "elevation": 25}}],
        "output": {{"width": 96, "height": 54, "samples": 1}}}})",
                               depth));
}

double shareOfHits(const Image<float>& albedo) {
    double hits = 0.0;
    for (std::size_t i = 3; i < albedo.data().size(); i += 4)
        hits += static_cast<double>(albedo.data()[i]);
    return 4.0 * hits / static_cast<double>(albedo.data().size());
}

TEST(TerrainPicture, has_no_holes) {
    // Straight down and obliquely: wherever the picture shows nothing but ground, every pixel must have some.
    for (const char* target : {R"(["0.6", "0.5", "0"])", R"(["1.4", "1.1", "0"])"}) {
        scene::Scene scene = range();
        setAll(scene, {{"camera.target", target}, {"output.width", "160"}, {"output.height", "160"}});
        for (const char* stride : {"1", "2", "4"}) {
            scene.set("subject.mesh", std::string_view(stride));
            const auto session = rendered(scene);
            EXPECT_EQ(shareOfHits(session->layers().albedo), 1.0) << target << " with mesh " << stride;
        }
    }
}

TEST(TerrainPicture, is_the_same_level_by_level_without_clip_control) {
    if (!gpu::canReverseDepth(context())) GTEST_SKIP() << "no clip control here to compare with";
    scene::Scene scene = range();
    scene.set("subject.depth_test", std::string_view("reversed"));
    const Image<float> reversed = rendered(scene)->layers().geometry;
    scene.set("subject.depth_test", std::string_view("blocks"));
    const Image<float> blocks = rendered(scene)->layers().geometry;
    std::size_t different = 0;
    for (std::size_t i = 3; i < reversed.data().size(); i += 4) {
        const float a = reversed.data()[i];
        const float b = blocks.data()[i];
        different += std::abs(a - b) > 1e-3F * std::max(a, b) ? 1 : 0;
    }
    // Which of two surfaces at nearly one depth wins at a silhouette may differ, in a pixel or two.
    EXPECT_LE(different, reversed.data().size() / 4 / 500);
}

TEST(TerrainPicture, is_the_same_again_and_from_both_makers_of_heights) {
    scene::Scene scene = range();
    const Image<float> first = rendered(scene)->picture();
    EXPECT_TRUE(identical(first, rendered(scene)->picture()));
    scene.set("subject.heights", std::string_view("gpu"));
    EXPECT_TRUE(identical(first, rendered(scene)->picture()));
}

TEST(TerrainPicture, is_the_same_after_a_journey_there_and_back) {
    session::Session session(context(), range(), {});
    finish(session);
    const Image<float> before = session.picture();
    const scene::Scene start = session.scene();
    for (int i = 0; i < 12; ++i)
        session.fly({0, -0.4, -1}, 2.0, 0.5);
    // The way down leads to other units, without end, and never through the ground.
    EXPECT_GT(session.distanceToSurface(), 0.0);
    EXPECT_GT(session.scene().subject.text("address").size(), 40U);
    EXPECT_EQ(session.scene().subject.integer("depth"), 0);
    finish(session);
    session.setScene(start);
    finish(session);
    // Tiles lie elsewhere in the cache now: weights of interpolated slopes are rounded differently, less than what
    // 8 bits show.
    EXPECT_LT(largestDifference(before, session.picture()), 1.0 / 255.0);
}

TEST(TerrainPicture, looks_alike_at_any_depth) {
    for (const int depth : {24, 90, 1024, 3400}) {
        const auto session = rendered(range(depth));
        const session::Session::Layers layers = session->layers();
        double steep = 0.0;
        double hits = 0.0;
        float nearest = 1e30F;
        float farthest = 0.0F;
        for (std::size_t i = 0; i < layers.geometry.data().size(); i += 4) {
            if (layers.albedo.data()[i + 3] <= 0.0F) continue;
            hits += 1.0;
            nearest = std::min(nearest, layers.geometry.data()[i + 3]);
            farthest = std::max(farthest, layers.geometry.data()[i + 3]);
            const float up = layers.geometry.data()[i + 2];
            steep += std::acos(std::clamp(static_cast<double>(up), -1.0, 1.0));
        }
        const double share = shareOfHits(layers.albedo);
        // No wall, and no empty plain: ground that reaches far, with slopes of about 10 to 55 degrees in the mean.
        EXPECT_GT(share, 0.25) << depth;
        EXPECT_GT(farthest / nearest, 4.0F) << depth;
        EXPECT_GT(steep / hits, 0.17) << depth;
        EXPECT_LT(steep / hits, 0.96) << depth;
    }
}

TEST(TerrainPicture, keeps_to_the_memory_that_it_may_take) {
    scene::Scene scene = range();
    setAll(scene, {{"subject.memory", "4"}, {"subject.detail", "0.5"}});
    const auto session = rendered(scene);
    double cached = 0.0;
    double room = 0.0;
    for (const auto& [name, value] : session->counters()) {
        if (name == "tiles cached") cached = value;
        if (name == "tiles' room") room = value;
    }
    EXPECT_GT(cached, 0.0);
    EXPECT_LE(cached, room);
    EXPECT_LE(room * 65 * 65 * 16, 4.0 * (1 << 20));
    EXPECT_FALSE(session->notes().empty()) << "it says that it is coarser than asked for";
}

TEST(TerrainPicture, says_what_is_wrong_with_an_address_or_a_camera) {
    scene::Scene scene = range();
    scene.set("subject.address", std::string_view("\"01240\""));
    const auto digit = errorOf([&] { const session::Session session(context(), scene, {}); });
    ASSERT_TRUE(digit);
    EXPECT_NE(std::string(digit->what()).find("4"), std::string::npos) << digit->what();
    scene = range();
    scene.set("camera.position", std::string_view("1e9,0,1"));
    EXPECT_TRUE(errorOf([&] { const session::Session session(context(), scene, {}); }));
    scene = range();
    EXPECT_TRUE(errorOf([&] { scene.set("subject.memory", std::string_view("0")); }));
    EXPECT_TRUE(errorOf([&] { scene.set("subject.seed", std::string_view("-1")); }));
}

} // namespace
} // namespace apeiron::test
