// Terrain as it is drawn: without holes, the same whichever way near hides far, the same again after a journey.

#include "gpu/raster.hpp"
#include "gpu_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

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
    EXPECT_TRUE(identical(before, session.picture()));
}

double counterOf(const session::Session& session, std::string_view name) {
    for (const auto& [counted, value] : session.counters()) {
        if (counted == name) return value;
    }
    return -1.0;
}

std::size_t levelOf(const session::Session& session) {
    return std::max(session.scene().subject.text("address").size(),
                    static_cast<std::size_t>(session.scene().subject.integer("depth")));
}

/// Mean difference of neighbouring pixels.
double meanGradient(const Image<float>& picture) {
    double sum = 0.0;
    for (std::size_t i = 4; i < picture.data().size(); i += 4)
        sum += std::abs(static_cast<double>(picture.data()[i] - picture.data()[i - 4]));
    return 4.0 * sum / static_cast<double>(picture.data().size());
}

TEST(TerrainPicture, autopilot_dives_through_pictures_and_rises_again) {
    for (const char* hurst : {"1", "0.8"}) {
        scene::Scene scene = range();
        scene.set("subject.hurst", std::string_view(hurst));
        session::Session session(context(), scene, {});
        finish(session);
        const Image<float> before = session.picture();
        for (int stop = 1; stop <= 6; ++stop) {
            while (levelOf(session) < 40U + 50U * static_cast<std::size_t>(stop))
                ASSERT_TRUE(session.autopilot(render::Autopilot::Dive, 1.0, 8.0));
            EXPECT_GT(session.distanceToSurface(), 0.0);
            // The cell follows the distance, and self-affine ground is never flatter or steeper than at first for long.
            EXPECT_LT(session.distanceToSurface(), 8.0);
            EXPECT_NEAR(std::log2(session.scene().subject.number("relief") / 0.6), 0.0, 1.1);
            finish(session);
            const Image<float> picture = session.picture();
            // No fog and no wall of one colour (the pictures that were looked at have 0.02 to 0.1).
            EXPECT_GT(meanGradient(picture), 0.008) << hurst << " stop " << stop;
            EXPECT_GT(shareOfHits(session.layers().albedo), 0.3) << hurst << " stop " << stop;
        }
        const std::size_t deep = levelOf(session);
        while (levelOf(session) > 41)
            ASSERT_TRUE(session.autopilot(render::Autopilot::Rise, 1.0, 8.0));
        EXPECT_LT(levelOf(session), deep);
        EXPECT_EQ(counterOf(session, "tiles cached") <= counterOf(session, "tiles' room"), true);
        session.setScene(scene);
        finish(session);
        EXPECT_TRUE(identical(before, session.picture())) << hurst;
    }
}

TEST(TerrainPicture, statistics_stay_in_a_range_on_a_dive_of_3400_levels) {
    scene::Scene scene = range();
    setAll(scene, {{"output.width", "128"}, {"output.height", "72"}});
    session::Session session(context(), scene, {});
    std::vector<double> gradients;
    std::vector<double> skies;
    constexpr std::size_t kPictures = 24;
    for (std::size_t stop = 1; stop <= kPictures; ++stop) {
        while (levelOf(session) < 40 + 3400 * stop / kPictures)
            ASSERT_TRUE(session.autopilot(render::Autopilot::Dive, 1.0, 30.0));
        EXPECT_GT(session.distanceToSurface(), 0.0);
        finish(session);
        gradients.push_back(255.0 * meanGradient(session.picture()));
        skies.push_back(1.0 - shareOfHits(session.layers().albedo));
    }
    const auto [leastGradient, mostGradient] = std::minmax_element(gradients.begin(), gradients.end());
    const auto [leastSky, mostSky] = std::minmax_element(skies.begin(), skies.end());
    std::cout << fmt::format("{} pictures: mean gradient {:.1f} to {:.1f} of 255, sky {:.0f} to {:.0f} %\n", kPictures,
                             *leastGradient, *mostGradient, 100.0 * *leastSky, 100.0 * *mostSky);
    // Fog, a plain or a wall of one colour have 0 to 2; pictures that were found good 6 to 22; grains of a pixel's size
    // would have more than 60.
    EXPECT_GT(*leastGradient, 3.0);
    EXPECT_LT(*mostGradient, 40.0);
    // The view follows the horizon of the ground, so that most of the picture is ground, on slopes of any steepness.
    EXPECT_LT(*mostSky, 0.5);
}

TEST(TerrainPicture, a_turn_makes_few_tiles_at_once_and_ends_in_the_same_picture) {
    scene::Scene scene = range();
    scene.set("subject.memory", std::string_view("64"));
    session::Session session(context(), scene, {});
    finish(session);
    const double first = counterOf(session, "tiles generated");
    scene::Camera camera = session.camera();
    camera.look(3.0, 0.1, 0.0);
    session.setCamera(camera);
    // The picture right after the turn is one without holes, of coarser tiles.
    EXPECT_LE(counterOf(session, "tiles generated") - first, 24.0);
    EXPECT_GT(counterOf(session, "tiles missing"), 24.0);
    double before = counterOf(session, "tiles generated");
    int steps = 0;
    while (!session.step(0.05).finished && ++steps < 10'000) {
        EXPECT_LE(counterOf(session, "tiles generated") - before, 24.0);
        before = counterOf(session, "tiles generated");
    }
    EXPECT_EQ(counterOf(session, "tiles missing"), 0.0);
    EXPECT_TRUE(identical(session.picture(), rendered(session.scene(), {})->picture()));
}

TEST(TerrainPicture, no_picture_of_a_flight_makes_more_than_24_tiles_with_a_full_cache_either) {
    scene::Scene scene = range();
    // Room for little more than the picture's own tiles: what is made takes the place of what was drawn long ago.
    scene.set("subject.memory", std::string_view("12"));
    session::Session session(context(), scene, {});
    finish(session);
    double most = 0.0;
    for (int i = 0; i < 160; ++i) {
        session.autopilot(i < 90 ? render::Autopilot::Dive : render::Autopilot::Rise, 4.0, 0.1);
        most = std::max(most, counterOf(session, "tiles made"));
    }
    EXPECT_EQ(counterOf(session, "tiles cached"), counterOf(session, "tiles' room"));
    EXPECT_GT(counterOf(session, "tiles generated"), 3.0 * counterOf(session, "tiles' room"));
    EXPECT_GT(most, 0.0);
    EXPECT_LE(most, 24.0);
}

TEST(TerrainPicture, a_camera_under_the_ground_is_shown_above_it_with_a_note) {
    scene::Scene scene = range();
    scene.set("camera.position", std::string_view("0.5,0.5,-2"));
    const auto session = rendered(scene);
    ASSERT_EQ(session->notes().size(), 1U);
    EXPECT_NE(session->notes()[0].find("under the ground"), std::string::npos);
    EXPECT_GT(session->distanceToSurface(), 0.0);
    EXPECT_GT(shareOfHits(session->layers().albedo), 0.1);
    EXPECT_GT(meanGradient(session->picture()), 0.003);
}

TEST(TerrainPicture, parallel_projection_shows_the_same_ground) {
    // Straight down from high above: there, both projections see nearly the same.
    scene::Scene scene = range();
    setAll(scene, {{"camera.position", R"(["0.5", "0.5", "8"])"},
                   {"camera.target", R"(["0.5", "0.5001", "0"])"},
                   {"camera.fov", "6"}});
    const Image<float> perspective = rendered(scene)->layers().geometry;
    scene.set("camera.projection", std::string_view("orthographic"));
    const auto session = rendered(scene);
    EXPECT_EQ(shareOfHits(session->layers().albedo), 1.0);
    const Image<float> parallel = session->layers().geometry;
    double difference = 0.0;
    for (std::size_t i = 3; i < parallel.data().size(); i += 4)
        difference = std::max(difference, std::abs(static_cast<double>(parallel.data()[i] - perspective.data()[i])));
    // Marched over the clipmap, which lacks the finest octaves; and the outer pixels look 4 degrees aside.
    EXPECT_LT(difference, 0.15);
}

TEST(TerrainPicture, debug_views_draw_lines_over_the_ground) {
    scene::Scene scene = range();
    setAll(scene, {{"output.width", "320"}, {"output.height", "180"}});
    const Image<float> plain = rendered(scene)->layers().geometry;
    for (const char* view : {"boxes", "corners"}) {
        scene.set("subject.debug", std::string_view(view));
        for (const char* test : {"reversed", "blocks"}) {
            if (std::string_view(test) == "reversed" && !gpu::canReverseDepth(context())) continue;
            scene.set("subject.depth_test", std::string_view(test));
            const auto session = rendered(scene);
            const session::Session::Layers layers = session->layers();
            std::size_t lines = 0;
            for (std::size_t i = 0; i < layers.albedo.data().size(); i += 4)
                lines += layers.albedo.data()[i + 3] > 0.5F && layers.albedo.data()[i] == 0.0F ? 1 : 0;
            EXPECT_GT(lines, 30U) << view << " " << test;
            EXPECT_LT(lines, layers.albedo.data().size() / 4 / 2) << view << " " << test;
        }
    }
}

TEST(TerrainPicture, frozen_tiles_stay_while_the_camera_moves) {
    scene::Scene scene = range();
    scene.set("subject.frozen", std::string_view("true"));
    session::Session session(context(), scene, {});
    finish(session);
    const double generated = counterOf(session, "tiles generated");
    const double drawn = counterOf(session, "tiles drawn");
    scene::Camera camera = session.camera();
    camera.look(0.3, 0.0, 0.0);
    camera.fly({0.0, 0.3, 0.0});
    session.setCamera(camera);
    finish(session);
    EXPECT_EQ(counterOf(session, "tiles generated"), generated);
    EXPECT_EQ(counterOf(session, "tiles drawn"), drawn);
    // What is in both pictures is where it was: the middle of the frozen one is seen at its own distance.
    const std::optional<double> frozen = session.distanceAt({48, 30});
    session.set("subject.frozen", std::string_view("false"));
    finish(session);
    const std::optional<double> fresh = session.distanceAt({48, 30});
    ASSERT_TRUE(frozen && fresh);
    // Other tiles, so morphed by other amounts: within some vertex spacings.
    EXPECT_NEAR(*frozen / *fresh, 1.0, 0.02);
}

TEST(TerrainPicture, frozen_tiles_hide_each_other_without_clip_control_too) {
    if (!gpu::canReverseDepth(context())) GTEST_SKIP() << "no clip control here to compare with";
    std::array<Image<float>, 2> pictures;
    for (const bool reversed : {false, true}) {
        scene::Scene scene = range();
        setAll(scene, {{"subject.frozen", "true"}, {"subject.depth_test", reversed ? "reversed" : "blocks"}});
        session::Session session(context(), scene, {});
        finish(session);
        // From behind, over the near tiles: what was far is behind what was near, and the other way around.
        scene::Camera camera = session.camera();
        camera.fly({0.0, 0.5, -6.0});
        camera.look(3.1, -0.2, 0.0);
        session.setCamera(camera);
        finish(session);
        pictures[reversed ? 1 : 0] = session.layers().geometry;
    }
    std::size_t different = 0;
    std::size_t seen = 0;
    for (std::size_t i = 3; i < pictures[0].data().size(); i += 4) {
        const float a = pictures[0].data()[i];
        const float b = pictures[1].data()[i];
        seen += a < 1e6F ? 1 : 0;
        different += std::abs(a - b) > 1e-3F * std::max(a, b) ? 1 : 0;
    }
    EXPECT_GT(seen, pictures[0].data().size() / 4 / 4);
    // At silhouettes, as of tiles that are not frozen.
    EXPECT_LE(different, pictures[0].data().size() / 4 / 200);
}

/// Turns the camera until the background is there. Whether it is, in so many pictures.
bool turnUntilShown(session::Session& session) {
    for (int i = 0; i < 200; ++i) {
        scene::Camera camera = session.camera();
        camera.look(0.01, 0.0, 0.0);
        session.setCamera(camera);
        while (session.samples() == 0)
            session.step(10.0);
        if (counterOf(session, "tiles in the background") > 0.0) return true;
    }
    return false;
}

/// Of two pictures: the share of pixels that differ by more than a tenth, and the mean difference.
std::pair<double, double> differenceOf(const Image<float>& a, const Image<float>& b) {
    double many = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.data().size(); i += 4) {
        double most = 0.0;
        for (std::size_t c = 0; c < 3; ++c)
            most =
                std::max(most, std::abs(static_cast<double>(a.data()[i + c]) - static_cast<double>(b.data()[i + c])));
        many += most > 0.1 ? 1.0 : 0.0;
        sum += most;
    }
    const double pixels = static_cast<double>(a.data().size()) / 4.0;
    return {many / pixels, sum / pixels};
}

/// What a session shows, turned aside and up by a pixel in all.
Image<float> beside(const session::Session& session) {
    scene::Scene scene = session.scene();
    scene::Camera camera(scene.camera);
    const double pixel = 2.0 * std::tan(0.5 * camera.fov()) / session.size().y;
    camera.look(0.7 * pixel, 0.7 * pixel, 0.0);
    scene.camera = camera.node();
    return rendered(scene)->picture();
}

class TerrainBackground : public testing::TestWithParam<const char*> {};

TEST_P(TerrainBackground, shows_a_moving_camera_what_tiles_would_show_and_nothing_of_it_stays) {
    if (std::string_view(GetParam()) == "reversed" && !gpu::canReverseDepth(context())) GTEST_SKIP();
    scene::Scene scene = range();
    setAll(scene, {{"output.width", "192"},
                   {"output.height", "108"},
                   {"subject.memory", "192"},
                   {"subject.background", "true"},
                   {"subject.depth_test", GetParam()}});
    session::Options options;
    options.reproject = false; // or what was seen before would be in the picture as well
    session::Session session(context(), scene, options);
    finish(session);
    ASSERT_TRUE(turnUntilShown(session));
    int compared = 0;
    double way = 0.0;
    for (int i = 0; i < 12; ++i) {
        const Image<float> moving = session.picture();
        const double hits = shareOfHits(session.layers().albedo);
        const bool shown = counterOf(session, "tiles in the background") > 0.0;
        const double drawn = counterOf(session, "tiles drawn");
        finish(session);
        EXPECT_EQ(counterOf(session, "tiles in the background"), 0.0) << "a picture at rest is exact";
        const Image<float> exact = session.picture();
        if (shown) {
            EXPECT_LT(drawn, 0.9 * counterOf(session, "tiles drawn"));
            // It is up to half a pixel beside where it was, and seen through texels that are up to half a pixel off: as
            // if the exact picture was seen less than a pixel beside, of which this is far ground only.
            const auto [many, mean] = differenceOf(moving, exact);
            const auto [manyBeside, meanBeside] = differenceOf(beside(session), exact);
            EXPECT_LT(many, 0.5 * manyBeside) << "after " << way;
            EXPECT_LT(mean, 0.5 * meanBeside) << "after " << way;
            EXPECT_NEAR(hits, shareOfHits(session.layers().albedo), 0.01) << "after " << way;
            ++compared;
        } else {
            EXPECT_TRUE(identical(moving, exact));
        }
        if (i == 11) {
            EXPECT_TRUE(identical(exact, rendered(session.scene(), {})->picture()));
        }
        // On, sideways and a little around: until it is used up.
        scene::Camera camera = session.camera();
        camera.look(0.01, 0.0, 0.0);
        camera.fly({0.004, 0.0, -0.002});
        way += 0.0045;
        session.setCamera(camera);
        while (session.samples() == 0)
            session.step(10.0);
    }
    EXPECT_GE(compared, 2);
}

INSTANTIATE_TEST_SUITE_P(depths, TerrainBackground, testing::Values("reversed", "blocks"));

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
    EXPECT_NE(std::string(digit->what()).find('4'), std::string::npos) << digit->what();
    scene = range();
    scene.set("camera.position", std::string_view("1e9,0,1"));
    EXPECT_TRUE(errorOf([&] { const session::Session session(context(), scene, {}); }));
    scene = range();
    EXPECT_TRUE(errorOf([&] { scene.set("subject.memory", std::string_view("0")); }));
    EXPECT_TRUE(errorOf([&] { scene.set("subject.seed", std::string_view("-1")); }));
}

} // namespace
} // namespace apeiron::test
