// Volumes that are larger than the memory for them: bricks of several levels, which come in while there is a picture.

#include "volume_support.hpp"

#include "volume/large.hpp"
#include "volume/source.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace apeiron::test {
namespace {

constexpr int kSize = 96;
/// Two thirds of the voxels' bytes. All bricks together would take more than that: 27 of 157 kB; the 8 that hold
/// something, and the overview, take half of it.
constexpr std::size_t kEnough = 2'400'000;
/// Room for about as many bricks as there must be room for.
constexpr std::size_t kLittle = 1'650'000;

/// A ball with waves in it, in the corner of a volume in which there is nothing else.
void provideCorner() {
    provide("corner", kSize, [](glm::dvec3 p, int) {
        const glm::dvec3 q = p + 20.0;
        const double r = glm::length(q);
        return r < 20.0 ? 0.6 + 0.4 * std::sin(0.9 * q.x) * std::cos(0.7 * q.y + 0.4 * q.z) : 0.0;
    });
}

/// The same all over the volume.
void provideEverywhere() {
    provide("everywhere", kSize,
            [](glm::dvec3 p, int) { return 0.5 + 0.5 * std::sin(0.9 * p.x) * std::cos(0.7 * p.y + 0.4 * p.z); });
}

scene::Scene sceneFor(const char* source, const char* renderer, const char* samples = "2") {
    scene::Scene scene = volumeScene(source, 110.0, {48, 48});
    scene.set("subject.transfer", Json::parse(R"({"window": "none", "space": "linear", "points": [
        {"value": 0.1, "color": [1, 0.5, 0.2], "opacity": 0}, {"value": 0.4, "color": [1, 0.6, 0.3], "opacity": 0.2},
        {"value": 1, "color": [0.3, 0.8, 1], "opacity": 1}]})"));
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"output.samples", samples},
                   {"subject.density", "20"},
                   {"subject.isovalue", "0.5"},
                   {"subject.iso_units", "value"}});
    scene.set("renderer.type", std::string_view(renderer));
    return scene;
}

session::Options patient() {
    session::Options options;
    options.specialise = false;
    options.wholeData = true;
    return options;
}

scene::Scene limited(scene::Scene scene, std::size_t memory) {
    scene.set("subject.memory", Json(static_cast<double>(memory) / (1 << 20)));
    return scene;
}

double counter(const session::Session& session, const std::string& name) {
    for (const auto& [key, value] : session.counters())
        if (key == name) return value;
    return -1.0;
}

double meanDifference(const Image<float>& a, const Image<float>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i)
        sum += std::abs(static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]));
    return sum / static_cast<double>(a.data().size());
}

double meanValue(const Image<float>& a) {
    double sum = 0.0;
    for (const float value : a.data())
        sum += static_cast<double>(value);
    return sum / static_cast<double>(a.data().size());
}

TEST(VolumeBricks, give_the_picture_of_the_whole_volume_where_all_that_is_seen_fits) {
    provideCorner();
    for (const char* renderer : {"eam", "mip", "iso", "lao", "depth"}) {
        const scene::Scene scene = sceneFor("corner", renderer);
        const auto whole = rendered(scene);
        const auto bricked = rendered(limited(scene, kEnough), patient());
        ASSERT_EQ(counter(*whole, "bricks_room"), -1.0);
        ASSERT_GE(counter(*bricked, "bricks_wanted"), 8.0);
        ASSERT_EQ(counter(*bricked, "bricks_missing"), 0.0);
        EXPECT_LE(counter(*bricked, "volume_memory_bytes"), static_cast<double>(kEnough));
        const Image<float> a = whole->layers().radiance;
        const Image<float> b = bricked->layers().radiance;
        ASSERT_TRUE(allFinite(b)) << renderer;
        EXPECT_GT(*std::max_element(a.data().begin(), a.data().end()), 0.1F)
            << renderer << ": there was nothing to compare";
        // Places in the atlas are rounded otherwise: entries of the transfer function (1/1023 apart) may be the next.
        EXPECT_LT(meanDifference(a, b), 1e-4) << renderer;
        EXPECT_LT(largestDifference(a, b), 2e-2) << renderer;
    }
}

TEST(VolumeBricks, that_are_stepped_over_change_no_picture) {
    // One brick holds all of the volume: every place is looked at. Waves reach the borders, where surfaces close, and a
    // hole in the middle is cut open.
    provide("hole", 30, [](glm::dvec3 p, int) {
        const double wave = 0.1 * std::sin(0.9 * p.x) * std::cos(0.7 * p.y + 0.4 * p.z);
        return std::clamp(0.08 * (glm::length(p) - 2.0) + wave, 0.0, 1.0);
    });
    for (const char* renderer : {"eam", "lao", "mip", "iso", "depth"}) {
        scene::Scene scene = volumeScene("hole", 34.0, {48, 48});
        scene.set("subject.transfer", Json::parse(R"({"window": "none", "space": "linear", "points": [
            {"value": 0.5, "color": [1, 0.5, 0.2], "opacity": 0}, {"value": 1, "color": [0.3, 0.8, 1], "opacity": 1}]})"));
        setAll(scene, {{"environment.color", "1,1,1"}, {"output.samples", "2"}, {"subject.density", "3"}});
        setAll(scene, {{"subject.clip_low", "-100,-4,-100"}, {"subject.clip", "true"}});
        scene.set("renderer.type", std::string_view(renderer));
        if (std::string_view(renderer) == "mip") scene.set("renderer.low", std::string_view("0.2"));
        scene.set("subject.brick", std::string_view("32"));
        const Image<float> everything = rendered(scene)->layers().radiance;
        scene.set("subject.brick", std::string_view("4"));
        const Image<float> leaping = rendered(scene)->layers().radiance;
        ASSERT_TRUE(allFinite(leaping)) << renderer;
        const auto [least, most] = std::minmax_element(everything.data().begin(), everything.data().end());
        EXPECT_GT(*most - *least, 0.1F) << renderer << ": there was nothing to compare";
        // Places that are looked at are the same but for the rounding of a sum.
        EXPECT_LT(largestDifference(everything, leaping), 2e-3) << renderer;
    }
}

TEST(VolumeBricks, do_not_change_the_mean_of_paths_of_light) {
    provideCorner();
    const scene::Scene scene = sceneFor("corner", "mcm", "64");
    const auto mean = [&](const scene::Scene& shown) {
        const render::Accumulation a = rendered(shown, patient())->accumulation();
        MeanOf result;
        const double pixels = static_cast<double>(a.mean.data().size() / 4);
        for (std::size_t i = 0; i < a.mean.data().size(); i += 4) {
            const double n = a.mean.data()[i + 3];
            result.value += a.mean.data()[i + 1] / pixels;
            result.variance += a.spread.data()[i + 1] / n / (n - 1.0) / (pixels * pixels);
        }
        return result;
    };
    const MeanOf whole = mean(scene);
    const MeanOf bricked = mean(limited(scene, kEnough));
    EXPECT_LT(std::abs(whole.value - bricked.value), 4.0 * std::sqrt(whole.variance + bricked.variance));
    EXPECT_GT(whole.value, 0.1);
}

TEST(VolumeBricks, majorants_hold_for_coarse_levels) {
    // Peaks of one voxel, of which coarser levels keep an eighth and less. The same medium with other bricks of
    // majorants: only where these hold is the mean the same.
    provide("peaks", kSize, [](glm::dvec3 p, int) {
        const glm::ivec3 i(glm::floor(p));
        return (i.x * 7 + i.y * 13 + i.z * 29) % 31 == 0 ? 1.0 : 0.12;
    });
    std::map<std::string, MeanOf> means;
    for (const char* brick : {"8", "32"}) {
        scene::Scene scene = sceneFor("peaks", "mcm", "64");
        scene.set("subject.brick", std::string_view(brick));
        const auto session = rendered(limited(scene, kLittle), patient());
        EXPECT_LT(counter(*session, "bricks_wanted"), 27.0);
        const render::Accumulation a = session->accumulation();
        MeanOf& mean = means[brick];
        const double pixels = static_cast<double>(a.mean.data().size() / 4);
        for (std::size_t i = 0; i < a.mean.data().size(); i += 4) {
            const double n = a.mean.data()[i + 3];
            mean.value += a.mean.data()[i + 1] / pixels;
            mean.variance += a.spread.data()[i + 1] / n / (n - 1.0) / (pixels * pixels);
        }
    }
    const MeanOf& a = means["8"];
    const MeanOf& b = means["32"];
    EXPECT_LT(std::abs(a.value - b.value), 4.0 * std::sqrt(a.variance + b.variance)) << a.value << " " << b.value;
}

TEST(VolumeBricks, with_little_memory_are_coarser_but_show_the_same_thing) {
    provideEverywhere();
    const scene::Scene scene = sceneFor("everywhere", "eam");
    const Image<float> whole = rendered(scene)->layers().radiance;
    const auto session = rendered(limited(scene, kLittle), patient());
    EXPECT_LE(counter(*session, "volume_memory_bytes"), static_cast<double>(kLittle));
    const Image<float> coarse = session->layers().radiance;
    ASSERT_TRUE(allFinite(coarse));
    EXPECT_GT(meanDifference(whole, coarse), 1e-3) << "everything was there";
    // Waves of seven voxels are flat in voxels of four: colours differ, brightness hardly does.
    EXPECT_NEAR(meanValue(coarse) / meanValue(whole), 1.0, 0.1);
    EXPECT_FALSE(session->notes().empty());
}

TEST(VolumeBricks, too_little_memory_for_anything_is_an_error_that_says_how_much_is_needed) {
    provideEverywhere();
    const auto error = errorOf([&] { rendered(limited(sceneFor("everywhere", "eam"), 200'000)); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("96x96x96 voxels cannot be shown with 0.2 MB of memory"));
    EXPECT_THAT(error->what(), testing::HasSubstr("MB at least"));
}

TEST(VolumeBricks, come_in_while_there_is_a_whole_picture_and_the_last_one_is_that_of_all_at_once) {
    provideCorner();
    const scene::Scene scene = sceneFor("corner", "eam");
    const Image<float> atOnce = rendered(limited(scene, kEnough), patient())->layers().radiance;
    session::Session session(context(), limited(scene, kEnough));
    const double missing = counter(session, "bricks_missing");
    EXPECT_EQ(missing, 0.0) << "nothing is wanted before the first step";
    bool finished = session.step(1e-6).finished;
    EXPECT_GT(counter(session, "bricks_missing"), 0.0) << "one brick at a time";
    EXPECT_FALSE(finished);
    int steps = 0;
    double least = 1e9;
    while (!finished) {
        finished = session.step(1e-6).finished;
        ASSERT_LT(++steps, 10'000);
        if (session.samples() > 0) least = std::min(least, meanValue(session.layers().radiance));
    }
    EXPECT_EQ(counter(session, "bricks_missing"), 0.0);
    const Image<float> last = session.layers().radiance;
    EXPECT_LT(largestDifference(atOnce, last), 1e-6);
    EXPECT_GT(least, 0.7 * meanValue(last)) << "a picture with holes";
}

TEST(VolumeBricks, a_finished_picture_does_not_depend_on_where_the_camera_was_before) {
    provideEverywhere();
    const scene::Scene there = limited(sceneFor("everywhere", "eam"), kLittle);
    scene::Scene elsewhere = there;
    setAll(elsewhere, {{"camera.position", "100,0,30"}, {"camera.fov", "20"}});
    const Image<float> direct = rendered(there, patient())->layers().radiance;
    session::Options options;
    options.reproject = false;
    session::Session session(context(), elsewhere, options);
    finish(session);
    const Image<float> other = session.layers().radiance;
    session.setCamera(scene::Camera(there.camera));
    for (int i = 0; i < 3; ++i)
        session.step(1e-6);
    session.setCamera(scene::Camera(elsewhere.camera));
    session.step(1e-6);
    session.setCamera(scene::Camera(there.camera));
    finish(session);
    const Image<float> moved = session.layers().radiance;
    EXPECT_GT(meanDifference(direct, other), 1e-2);
    // The same bricks, in other places of the atlas: rounded otherwise.
    EXPECT_LT(meanDifference(direct, moved), 1e-4);
    EXPECT_LT(largestDifference(direct, moved), 2e-2);
}

TEST(VolumeBricks, an_edit_of_the_transfer_function_asks_for_other_bricks) {
    provideCorner();
    const scene::Scene scene = limited(sceneFor("corner", "eam"), kEnough);
    session::Session session(context(), scene);
    finish(session);
    const double before = counter(session, "bricks_wanted");
    // Nothing is seen, nothing is needed.
    session.set("subject.transfer", Json::parse(R"({"window": "none", "points": [{"value": 0, "opacity": 0}]})"));
    session.set("subject.isovalue", Json(5));
    finish(session);
    EXPECT_LT(counter(session, "bricks_wanted"), before);
    session.setScene(scene);
    finish(session);
    EXPECT_EQ(counter(session, "bricks_wanted"), before);
    const Image<float> again = session.layers().radiance;
    const Image<float> fresh = rendered(scene, patient())->layers().radiance;
    EXPECT_LT(largestDifference(again, fresh), 2e-2);
}

TEST(VolumeBricks, several_channels_and_all_types_of_voxels_are_shown) {
    using volume::VoxelType;
    const auto picture = [&](VoxelType type, int channels, std::size_t memory) {
        volume::Volume made = volume::makeVolume(glm::ivec3(kSize), type, channels);
        volume::centre(made, glm::dvec3(1.0));
        made.slope = type == VoxelType::Float32 ? 1.0 : 0.01;
        for (std::size_t i = 0; i < volume::voxelsPerChannel(made) * static_cast<std::size_t>(channels); ++i) {
            const std::size_t at = i % volume::voxelsPerChannel(made);
            const double x = static_cast<double>(at % kSize) - 20.0;
            const double y = static_cast<double>(at / kSize % kSize) - 20.0;
            const double z = static_cast<double>(at / (kSize * kSize)) - 20.0;
            const double value = std::max(1.0 - std::sqrt(x * x + y * y + z * z) / 18.0, 0.0);
            if (type == VoxelType::Float32) {
                const auto word = static_cast<float>(value);
                std::memcpy(&made.voxels[i * 4], &word, 4);
            } else if (type == VoxelType::Int16) {
                const auto word = static_cast<std::int16_t>(100.0 * value);
                std::memcpy(&made.voxels[i * 2], &word, 2);
            } else {
                made.voxels[i] = static_cast<std::byte>(static_cast<int>(100.0 * value));
            }
        }
        volume::provideVolume("typed", std::make_shared<const volume::Volume>(std::move(made)));
        const auto session = rendered(limited(sceneFor("typed", "eam"), memory), patient());
        EXPECT_EQ(counter(*session, "bricks_room") > 0.0, memory > 0);
        return session->layers().radiance;
    };
    const std::size_t voxels = std::size_t{kSize} * kSize * kSize;
    for (const int channels : {1, 3}) {
        for (const auto& [type, bytes] : {std::pair{VoxelType::UInt8, 1U},
                                          {VoxelType::Int8, 1U},
                                          {VoxelType::Int16, 2U},
                                          {VoxelType::Float32, 4U}}) {
            const std::size_t texel = bytes * (channels == 3 ? 4U : 1U);
            const Image<float> a = picture(type, channels, 0);
            const Image<float> b = picture(type, channels, voxels * texel / 4 * 3);
            EXPECT_GT(meanValue(a), 0.01);
            // Software interpolates bytes to bytes, of 100 steps here; entries of the transfer function are 1/1023
            // apart.
            EXPECT_LT(meanDifference(a, b), bytes == 1 ? 1e-2 : 1e-3) << volume::toString(type) << " x " << channels;
        }
    }
}

} // namespace
} // namespace apeiron::test
