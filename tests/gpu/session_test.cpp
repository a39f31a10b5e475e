// The façade: what edits keep, when work stops, what a step costs.

#include "gpu_support.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

namespace apeiron::test {
namespace {

using parameter::Invalidates;
using session::Session;
using testing::AllOf;
using testing::HasSubstr;

/// A lit sphere with an effect, in a picture of 48 x 32.
scene::Scene litSphere() {
    scene::Scene scene = darkSphere({48, 32});
    setAll(scene, {{"lights", R"([{"type": "sun", "size": 4}])"},
                   {"environment.color", "0.2,0.3,0.4"},
                   {"post.effects", R"([{"type": "vignette"}])"},
                   {"output.samples", "4"}});
    return scene;
}

void set(Session& session, const char* path, const char* text) {
    session.set(path, std::string_view(text));
}

TEST(Session, counts_samples_up_to_the_limit) {
    Session session(context(), litSphere());
    EXPECT_EQ(session.samples(), 0);
    session::StepResult result;
    while (!(result = session.step(0.05)).finished) {
    }
    EXPECT_EQ(result.samples, 4);
    EXPECT_EQ(session.samples(), 4);
    EXPECT_EQ(session.accumulation().samples(), 4);
    result = session.step(0.05);
    EXPECT_TRUE(result.finished);
    EXPECT_FALSE(result.changed);
    EXPECT_EQ(session.samples(), 4) << "there is nothing left to do";
    set(session, "output.samples", "6");
    finish(session);
    EXPECT_EQ(session.samples(), 6) << "more samples go on from those that are there";
    session.reset();
    EXPECT_EQ(session.samples(), 0);
}

TEST(Session, does_some_work_in_any_step) {
    session::Options options;
    options.tilePixels = 500;
    Session session(context(), litSphere(), options);
    double progress = 0.0;
    for (int step = 0; session.samples() < 1; ++step) {
        ASSERT_LT(step, 3000);
        session.step(0.0);
        ASSERT_GE(session.progress() + static_cast<double>(session.samples()), progress);
        progress = session.progress();
    }
}

TEST(Session, edits_of_what_is_shown_keep_the_samples) {
    Session session(context(), litSphere());
    finish(session);
    Image<float> before = session.picture();
    for (const auto& [path, value] :
         {std::pair{"post.exposure", "1.5"}, std::pair{"post.effects.0.strength", "0.9"},
          std::pair{"post.effects.0.enabled", "false"}, std::pair{"post.tonemapper", "reinhard"},
          std::pair{"post.white", "2"}, std::pair{"post.effects.1.type", "bloom"}, std::pair{"post.effects", "[]"}}) {
        EXPECT_EQ(session.set(path, std::string_view(value)), Invalidates::Present) << path;
        EXPECT_EQ(session.samples(), 4) << path;
        const Image<float> after = session.picture();
        EXPECT_FALSE(identical(before, after)) << path << " shows";
        before = after;
    }
    for (const auto& [path, value] :
         {std::pair{"title", "x"}, std::pair{"output.time", "9"}, std::pair{"output.noise", "0.5"}}) {
        EXPECT_EQ(session.set(path, std::string_view(value)), Invalidates::Nothing) << path;
        EXPECT_EQ(session.samples(), 4) << path;
        EXPECT_TRUE(identical(before, session.picture())) << path;
    }
}

TEST(Session, edits_of_what_is_computed_start_anew) {
    for (const bool specialise : {true, false}) {
        Session session(context(), litSphere(), {.stage = {}, .specialise = specialise});
        for (const auto& [path, value] :
             {std::pair{"camera.position", "0.5,-4,0.2"}, std::pair{"camera.fov", "50"},
              std::pair{"camera.filter", "tent"}, std::pair{"lights.0.intensity", "1"},
              std::pair{"lights.0.azimuth", "10"}, std::pair{"lights.1.type", "point"},
              std::pair{"environment.color", "1,0,0"}, std::pair{"environment.type", "gradient"},
              std::pair{"subject.color_a", "0.1,0.9,0.1"}, std::pair{"renderer.brdf", "phong"},
              std::pair{"renderer.sky_light", "0.5"}, std::pair{"subject.formula", "menger"},
              std::pair{"subject.scale", "2.9"}, std::pair{"output.seed", "3"}}) {
            session.step(0.002);
            finish(session);
            const Image<float> before = session.picture();
            EXPECT_NE(session.set(path, std::string_view(value)), Invalidates::Nothing) << path;
            EXPECT_EQ(session.samples(), 0) << path;
            finish(session);
            EXPECT_FALSE(identical(before, session.picture())) << path << " shows";
        }
    }
}

TEST(Session, an_edit_to_the_present_value_changes_nothing) {
    Session session(context(), litSphere());
    finish(session);
    for (const char* path : {"camera.fov", "lights.0.intensity", "subject.roughness", "post.exposure"}) {
        const std::string value = path == std::string("camera.fov")           ? "40"
                                  : path == std::string("lights.0.intensity") ? "3"
                                  : path == std::string("subject.roughness")  ? "1"
                                                                              : "0";
        EXPECT_EQ(session.set(path, std::string_view(value)), Invalidates::Nothing) << path;
        EXPECT_EQ(session.samples(), 4) << path;
    }
    session.setScene(session.scene());
    session.setCamera(session.camera());
    EXPECT_EQ(session.samples(), 4);
}

TEST(Session, an_edit_that_fails_changes_nothing) {
    const TemporaryFolder folder;
    std::ofstream(folder / "bad.glsl")
        << "#include \"fractal/orbit.glsl\"\n"
           "uniform int iterations; //! 3 [1, 10]\nuniform float bailout; //! 4 [1, 100]\n"
           "void iterate(inout Orbit o) {}\nfloat estimate(Orbit o) { return oops; }\n";
    Session session(context(), litSphere());
    finish(session);
    const Image<float> before = session.picture();
    const scene::Scene scene = session.scene();
    for (const auto& [path, value] : {std::pair{"lights.0.intensity", "-1"}, std::pair{"lights.0.intensity", "bright"},
                                      std::pair{"lights.0.intensty", "1"}, std::pair{"subject.formula", "./bad.glsl"},
                                      std::pair{"subject.formula", "./missing.glsl"},
                                      std::pair{"subject.formula", "no_such"}, std::pair{"output.width", "0"},
                                      std::pair{"output.width", "32769"}, std::pair{"post.tonemapper", "./bad.glsl"},
                                      std::pair{"renderer.type", "./bad.glsl"}, std::pair{"nothing.at.all", "1"}}) {
        const auto error = errorOf([&] { session.set(path, std::string_view(value), folder / ""); });
        ASSERT_TRUE(error) << path << "=" << value;
        EXPECT_NE(error->kind(), ErrorKind::Gpu) << error->what();
        EXPECT_TRUE(session.scene() == scene) << path << "=" << value;
        EXPECT_EQ(session.samples(), 4) << path << "=" << value;
        EXPECT_TRUE(identical(session.picture(), before)) << path << "=" << value;
    }
    // And work goes on.
    set(session, "output.samples", "5");
    finish(session);
    EXPECT_EQ(session.samples(), 5);
}

TEST(Session, a_size_beyond_the_device_is_refused_before_anything_is_allocated) {
    Session session(context(), litSphere());
    finish(session);
    const int most = context().capabilities().maxTextureSize;
    for (const int size : {100000, most + 1}) {
        const auto error = errorOf([&] {
            scene::Scene scene = session.scene();
            scene.output.set("width", std::int64_t{size});
            scene.output.set("height", std::int64_t{size});
            session.setScene(scene);
        });
        ASSERT_TRUE(error) << size;
        EXPECT_EQ(error->kind(), ErrorKind::BadInput) << error->what();
        EXPECT_THAT(error->what(), testing::AnyOf(HasSubstr("width"), HasSubstr("32768"))) << size;
    }
    const double needed = static_cast<double>(most) * most * static_cast<double>(render::kBytesPerPixel);
    const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    if (most <= 32768 && context().capabilities().software && needed > there) {
        const auto error = errorOf([&] {
            scene::Scene scene = session.scene();
            scene.output.set("width", std::int64_t{most});
            scene.output.set("height", std::int64_t{most});
            session.setScene(scene);
        });
        ASSERT_TRUE(error);
        EXPECT_THAT(error->what(), AllOf(HasSubstr("memory"), HasSubstr("smaller size")));
    }
    EXPECT_EQ(session.size(), glm::ivec2(48, 32));
    EXPECT_EQ(session.samples(), 4);
}

TEST(Session, takes_another_size) {
    Session session(context(), litSphere());
    finish(session);
    for (const glm::ivec2 size : {glm::ivec2(64, 48), glm::ivec2(1, 1), glm::ivec2(7, 100), glm::ivec2(48, 32)}) {
        set(session, "output.width", fmt::format("{}", size.x).c_str());
        set(session, "output.height", fmt::format("{}", size.y).c_str());
        EXPECT_EQ(session.samples(), 0);
        finish(session);
        const Image<float> picture = session.picture();
        EXPECT_EQ(picture.width(), size.x);
        EXPECT_EQ(picture.height(), size.y);
        EXPECT_TRUE(allFinite(picture));
        EXPECT_EQ(session.layers().radiance.width(), size.x);
    }
    EXPECT_TRUE(identical(session.picture(), rendered(litSphere(), {})->picture()));
}

double compileMs(const Session& session) {
    const auto& times = session.statistics().phases.times;
    const auto found = times.find("compile");
    return found == times.end() ? 0.0 : found->second.wallMs;
}

/// litSphere() as a program that no earlier run has left in a driver's cache.
scene::Scene neverCompiled() {
    scene::Scene scene = litSphere();
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    scene.subject.set("formula", formulaOf(fmt::format("length(p) - 1.0 - 1e-12 * {}.0", now % 1000000), 1.01));
    return scene;
}

TEST(Session, going_back_compiles_nothing) {
    Session session(context(), neverCompiled());
    const double first = compileMs(session);
    set(session, "renderer.brdf", "phong");
    set(session, "subject.roughness", "0.3");
    const double before = compileMs(session);
    set(session, "subject.roughness", "1");
    set(session, "renderer.brdf", "lambert");
    // Sources are put together and buffers made anew, twice: a small part of what compiling takes.
    EXPECT_LT(compileMs(session) - before, 0.5 * first) << first;
}

TEST(Session, a_variable_kernel_takes_other_values_without_compiling) {
    Session session(context(), neverCompiled(), {.stage = {}, .specialise = false});
    const double before = compileMs(session);
    for (const char* value : {"0.1", "0.2", "0.3", "0.4"})
        set(session, "subject.roughness", value);
    set(session, "lights.0.intensity", "2");
    EXPECT_LT(compileMs(session) - before, 0.25 * before);
}

TEST(Session, no_step_waits_for_the_compiler) {
    Session session(context(), neverCompiled());
    const double compile = compileMs(session);
    const Stopwatch watch;
    session.step(1e-3);
    session.picture();
    const double first = 1e3 * watch.seconds();
    EXPECT_LT(first, 0.3 * compile) << "compiling took " << compile << " ms";
}

TEST(Session, interleaving_shows_a_whole_coarse_picture_first) {
    scene::Scene scene = litSphere();
    setAll(scene, {{"output.width", "61"}, {"output.height", "45"}});
    Session session(context(), scene, {.stage = {}, .specialise = true, .tilePixels = 0, .interleave = 8});
    Image<float> picture;
    bool changed = false;
    for (int step = 0; step < 100 && !changed; ++step)
        changed = session.step(0.0).changed;
    ASSERT_TRUE(changed);
    EXPECT_EQ(session.samples(), 0);
    EXPECT_LE(session.progress(), 3.0 / 64.0);
    picture = session.picture();
    for (std::size_t i = 3; i < picture.data().size(); i += 4)
        ASSERT_EQ(picture.data()[i], 1.0F) << i / 4;
    // Every pixel shows the nearest that is there (before the vignette), as the first sample has it.
    const Image<float> radiance = session.layers().radiance;
    scene::Scene one = scene;
    setAll(one, {{"output.samples", "1"}});
    const Image<float> first = rendered(one, {})->layers().radiance;
    for (int y = 0; y < 45; ++y) {
        for (int x = 0; x < 61; ++x) {
            const float* here = radiance.at(x, y);
            // Of two that are as near, the one behind; beyond the picture there is none.
            const auto nearest = [](int i, int size) { return (i + 4) / 8 * 8 < size ? (i + 4) / 8 * 8 : i / 8 * 8; };
            ASSERT_TRUE(std::equal(here, here + 4, first.at(nearest(x, 61), nearest(y, 45)))) << x << "," << y;
        }
    }
    // It gets finer, and ends as what it is without interleaving.
    finish(session);
    EXPECT_TRUE(identical(session.picture(), rendered(scene, {})->picture()));
}

TEST(Session, an_edit_shows_the_old_picture_until_there_is_a_coarse_one_of_the_new) {
    scene::Scene scene = litSphere();
    setAll(scene, {{"environment.type", "constant"}, {"environment.color", "1,1,1"}, {"output.samples", "2"}});
    for (const bool specialise : {true, false}) {
        // One pixel in each step.
        Session session(context(), scene, {.stage = {}, .specialise = specialise, .tilePixels = 1, .interleave = 8});
        finish(session);
        Image<float> old = session.layers().radiance;
        const auto editAndLook = [&](const char* path, const char* value) {
            session.set(path, std::string_view(value));
            EXPECT_EQ(session.samples(), 0);
            EXPECT_TRUE(identical(session.layers().radiance, old)) << path << ": the old picture is gone";
            bool changed = false;
            for (int i = 0; i < 10000 && !changed; ++i) {
                changed = session.step(0.0).changed;
                const Image<float> now = session.layers().radiance;
                if (!changed) {
                    ASSERT_TRUE(identical(now, old)) << path << ", step " << i;
                }
            }
            EXPECT_LE(session.progress(), 2.0 / 64.0) << path;
            const Image<float> now = session.layers().radiance;
            EXPECT_GT(largestDifference(now, old), 0.05) << path << ": the new picture is the old one";
            // In a white world, something is seen everywhere.
            for (std::size_t i = 0; i < now.data().size(); i += 4)
                ASSERT_GT(now.data()[i], 0.0F) << path << ", pixel " << i / 4;
            old = now;
        };
        editAndLook("lights.0.intensity", "9");
        // What is edited twice before anything is computed still shows the last whole picture.
        session.set("lights.0.intensity", std::string_view("1"));
        editAndLook("environment.color", "0.4,0.5,0.6");
        finish(session);
        setAll(scene, {{"lights.0.intensity", "1"}, {"environment.color", "0.4,0.5,0.6"}});
        EXPECT_TRUE(identical(session.layers().radiance, rendered(scene, {})->layers().radiance))
            << "something of the old is left";
        setAll(scene, {{"lights.0.intensity", "2"}, {"environment.color", "1,1,1"}});
    }
}

TEST(Session, before_the_first_sample_there_is_nothing_to_see) {
    Session session(context(), litSphere());
    const Image<float> picture = session.picture();
    EXPECT_THAT(picture.data(), testing::Each(0.0F));
    EXPECT_EQ(session.progress(), 0.0);
    EXPECT_EQ(session.noise(), 0.0);
    EXPECT_FALSE(session.distanceAt({24, 16}).has_value());
}

TEST(Session, knows_the_distance_of_what_is_seen) {
    const auto session = rendered(litSphere());
    EXPECT_NEAR(session->distanceAt({24, 16}).value(), 3.0, 5e-3);
    EXPECT_FALSE(session->distanceAt({0, 0}).has_value());
    EXPECT_EQ(session->distanceAt({-5, 1000}), session->distanceAt({0, 31})) << "the nearest pixel";
    EXPECT_NEAR(session->distanceToSurface(), 3.0, 1e-6);
    scene::Camera camera = session->camera();
    camera.fly({0.0, 0.0, -1.5});
    session->setCamera(camera);
    EXPECT_NEAR(session->distanceToSurface(), 1.5, 1e-6);
}

TEST(Session, noise_falls_with_the_root_of_the_samples) {
    scene::Scene scene = litSphere();
    setAll(scene, {{"renderer.ambient_occlusion", "sampled"},
                   {"renderer.shadow", "sampled"},
                   {"environment.type", "gradient"},
                   {"output.samples", "16"}});
    Session session(context(), scene);
    finish(session);
    const double early = session.noise();
    EXPECT_GT(early, 0.001);
    set(session, "output.samples", "144");
    finish(session);
    // The deviation of a pixel's samples is the same; that of their mean goes with 1 / sqrt(n). 16 samples of each of
    // 1,536 pixels tell the deviation to about 1 %.
    EXPECT_NEAR(early / session.noise(), 3.0, 0.15);
}

TEST(Session, stops_at_the_noise_that_is_asked_for) {
    scene::Scene scene = litSphere();
    setAll(scene, {{"renderer.ambient_occlusion", "sampled"},
                   {"environment.type", "gradient"},
                   {"output.samples", "100000"},
                   {"output.noise", "0.02"}});
    Session session(context(), scene);
    finish(session);
    const std::int64_t first = session.samples();
    EXPECT_LT(first, 1000);
    EXPECT_LE(session.noise(), 0.02);
    EXPECT_GT(session.noise(), 0.012) << "it went on for long after";
    set(session, "output.noise", "0.01");
    finish(session);
    EXPECT_GT(session.samples(), 2 * first) << "less noise is asked for than there was";
    EXPECT_LE(session.noise(), 0.01);
    set(session, "output.noise", "0.5");
    EXPECT_TRUE(session.step(0.01).finished);
}

TEST(Session, stops_after_the_time_that_is_asked_for) {
    scene::Scene scene = litSphere();
    setAll(scene, {{"output.samples", "10000000"}, {"output.time", "0.3"}});
    Session session(context(), scene);
    const Stopwatch watch;
    int steps = 0;
    while (!session.step(0.02).finished)
        ASSERT_LT(++steps, 1000);
    EXPECT_GE(watch.seconds(), 0.29);
    EXPECT_LT(watch.seconds(), 1.0);
    session.reset();
    const Stopwatch again;
    EXPECT_TRUE(session.step(20.0).finished) << "also within one long step";
    EXPECT_LT(again.seconds(), 1.0);
}

TEST(Session, setting_a_scene_that_differs_in_limits_only_keeps_the_samples) {
    Session session(context(), litSphere());
    finish(session);
    scene::Scene more = session.scene();
    setAll(more, {{"title", "More"}, {"output.samples", "6"}});
    session.setScene(more);
    EXPECT_EQ(session.samples(), 4);
    more.set("post.exposure", std::string_view("1"));
    session.setScene(more);
    EXPECT_EQ(session.samples(), 4);
    finish(session);
    EXPECT_EQ(session.samples(), 6);
}

/// Heavy for a software rasteriser: 230,400 pixels of a mandelbulb with every light sampled.
scene::Scene heavy() {
    return sceneOf(R"({"apeiron": 1,
        "renderer": {"shadow": "sampled", "ambient_occlusion": "sampled"},
        "output": {"width": 640, "height": 360, "samples": 100000}})");
}

class EveryBudget : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Timing, EveryBudget, testing::Values(10, 33, 100),
                         [](const auto& instance) { return fmt::format("{}_ms", instance.param); });

TEST_P(EveryBudget, steps_keep_to_their_budget) {
    const double budget = 1e-3 * GetParam();
    Session session(context(), heavy());
    const Stopwatch warmUp;
    while (warmUp.seconds() < std::max(0.6, 10.0 * budget))
        session.step(budget);
    const int steps = static_cast<int>(std::max(1.5 / budget, 15.0));
    std::vector<double> times;
    for (int i = 0; i < steps; ++i) {
        const Stopwatch watch;
        session.step(budget);
        times.push_back(watch.seconds());
    }
    std::sort(times.begin(), times.end());
    const double limit = 1.3 * budget + 0.005;
    const auto over = std::count_if(times.begin(), times.end(), [&](double t) { return t > limit; });
    // 5 % is what is promised on a machine of one's own. Other programs may hold the processor for some of the steps:
    // 15 % still tells a governor that does not govern.
    EXPECT_LE(over, std::max<std::ptrdiff_t>(steps * 15 / 100, 1))
        << steps << " steps, median " << times[times.size() / 2] << ", worst " << times.back();
    // A step that gives up early wastes the machine.
    EXPECT_GT(times[times.size() / 2], 0.5 * budget);
    EXPECT_LT(session.statistics().longestSubmission, 0.5);
}

TEST(Timing, no_submission_comes_near_a_watchdog_when_there_is_all_the_time) {
    Session session(context(), heavy());
    const Stopwatch watch;
    while (watch.seconds() < 2.5)
        session.step(10.0 - watch.seconds() < 8.0 ? 0.1 : 0.8);
    EXPECT_LT(session.statistics().longestSubmission, 0.5);
    EXPECT_GT(session.statistics().submissions, 2);
}

} // namespace
} // namespace apeiron::test
