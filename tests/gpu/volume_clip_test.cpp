// What clipping boxes and planes leave of a volume.

#include "gpu_support.hpp"
#include "volume/source.hpp"
#include "volume/voxels.hpp"

namespace apeiron::test {
namespace {

/// A cube of 20 mm around the origin, seen from the front (-y) by an orthographic camera that shows 40 mm.
class VolumeClipTest : public testing::Test {
  protected:
    VolumeClipTest() {
        volume::Volume cube = volume::makeVolume({10, 10, 10}, volume::VoxelType::UInt8);
        auto* voxels = volume::mutableVoxels<std::uint8_t>(cube);
        std::fill(voxels, voxels + 1000, std::uint8_t{200});
        voxels[0] = 199;
        volume::centre(cube, glm::dvec3(2.0));
        volume::provideVolume("cube.test", std::make_shared<const volume::Volume>(std::move(cube)));
    }
    ~VolumeClipTest() override { volume::provideVolume("cube.test", nullptr); }

    /// Coverage of the pixels of the middle row and column of 32.
    struct Seen {
        std::vector<bool> row;
        std::vector<bool> column;
    };

    static Seen seen(const std::vector<std::pair<const char*, const char*>>& values) {
        scene::Scene scene(session::catalogue());
        scene.set("subject", Json::parse(R"({"type": "volume", "source": "cube.test", "density": 1000,
            "transfer": {"window": "none", "points": [{"value": 0, "opacity": 1}]}})"));
        scene.set("camera", Json::parse(R"({"position": ["0", "-100", "0"], "projection": "orthographic"})"));
        scene.set("camera.fov", "22.6198649"); // 2 * 100 * tan(fov / 2) = 40
        scene.set("renderer.type", "eam");
        scene.set("environment.background", "transparent");
        scene.set("camera.filter", "box");
        scene.set("output.width", "32");
        scene.set("output.height", "32");
        scene.set("output.samples", "4");
        for (const auto& [path, value] : values)
            scene.set(path, value);
        session::Session session(context(), scene);
        while (!session.step(10.0).finished) {
        }
        const Image<float> radiance = session.layers().radiance;
        Seen result;
        for (int i = 0; i < 32; ++i) {
            result.row.push_back(radiance.at(i, 16)[3] > 0.5F);
            result.column.push_back(radiance.at(16, i)[3] > 0.5F);
        }
        return result;
    }

    /// Pixels from `from` to before `to`, of 32.
    static std::vector<bool> pixels(int from, int to) {
        std::vector<bool> all(32);
        for (int i = from; i < to; ++i)
            all[static_cast<std::size_t>(i)] = true;
        return all;
    }
};

TEST_F(VolumeClipTest, nothing_is_cut_by_default) {
    EXPECT_EQ(seen({}).row, pixels(8, 24));
    EXPECT_EQ(seen({}).column, pixels(8, 24));
}

TEST_F(VolumeClipTest, a_box_leaves_what_is_inside) {
    const Seen result =
        seen({{"subject.clip", "true"}, {"subject.clip_low", "-5,-100,-100"}, {"subject.clip_high", "0,100,5"}});
    EXPECT_EQ(result.row, pixels(12, 16)); // 1.25 mm each: -5 to 0 mm
    EXPECT_EQ(seen({{"subject.clip", "true"}, {"subject.clip_high", "5,100,5"}}).column, pixels(12, 24))
        << "up to z = 5";
}

TEST_F(VolumeClipTest, planes_cut_what_their_normals_point_to) {
    const Seen result = seen({{"subject.clip_planes", "2"},
                              {"subject.clip_normal_1", "0,0,0.5"},
                              {"subject.clip_normal_2", "1,0,0"},
                              {"subject.clip_offsets", "2.5,-5,0"}});
    EXPECT_EQ(result.row, pixels(8, 12));
    const Seen turned =
        seen({{"subject.clip_planes", "1"}, {"subject.clip_normal_1", "0,0,0.5"}, {"subject.clip_offsets", "2.5,0,0"}});
    EXPECT_EQ(turned.column, pixels(14, 24));
    EXPECT_EQ(turned.row, pixels(8, 24));
}

TEST_F(VolumeClipTest, a_box_beside_the_volume_leaves_nothing) {
    EXPECT_EQ(seen({{"subject.clip", "true"}, {"subject.clip_low", "50,50,50"}, {"subject.clip_high", "60,60,60"}}).row,
              pixels(0, 0));
}

} // namespace
} // namespace apeiron::test
