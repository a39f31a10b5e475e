// A picture as environment: where its pixels are seen, how it is sampled, and what is wrong with files.

#include "gpu_support.hpp"
#include "render/environment_distribution.hpp"
#include "render/environment_picture.hpp"
#include "render/kernel_sources.hpp"
#include "render/picture_source.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace apeiron::test {
namespace {

using testing::HasSubstr;

/// 16 x 8 pixels whose red is the column, green the row, blue 1.
Image<float> grid(const std::filesystem::path& file) {
    if (file.filename() != "grid.exr") throw Error(ErrorKind::Io, "there is no such file", file.string());
    Image<float> image(16, 8, 3);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 16; ++x) {
            image.at(x, y)[0] = static_cast<float>(x);
            image.at(x, y)[1] = static_cast<float>(y);
            image.at(x, y)[2] = 1.0F;
        }
    }
    return image;
}

/// Black but for one pixel.
Image<float> lamp(const std::filesystem::path& /*file*/) {
    Image<float> image(64, 32, 3);
    for (int c = 0; c < 3; ++c)
        image.at(20, 6)[c] = 500.0F;
    return image;
}

class EnvironmentMapTest : public testing::Test {
  protected:
    void TearDown() override { render::setPictureLoader({}); }

    static scene::Scene sceneOf(const char* file) {
        scene::Scene scene(session::catalogue());
        scene.set("environment.type", "map");
        scene.set("environment.file", file);
        scene.set("output.width", "32");
        scene.set("output.height", "32");
        return scene;
    }

    /// Radiance in a direction.
    static glm::dvec3 seen(const scene::Scene& scene, const glm::vec3& direction) {
        gpu::ShaderSource source;
        render::addEnvironment(source, scene, false);
        source.addText("look", "uniform vec3 look;\nvoid kernel_main(ivec2 pixel, out vec4 color) {\n"
                               "    color = vec4(environment_radiance(look), 1.0);\n}\n");
        const render::EnvironmentPicture picture(context(), scene);
        return rgb(runKernel(source, gpu::Stage::Fragment, {1, 1}, 1,
                             [&](auto& kernel) {
                                 picture.bind(kernel);
                                 kernel.set("look", direction);
                             })[0]
                       .at(0, 0));
    }
};

TEST_F(EnvironmentMapTest, the_middle_is_straight_ahead_and_the_upper_edge_above) {
    render::setPictureLoader(grid);
    const scene::Scene scene = sceneOf("grid.exr");
    // Between the columns 7 and 8, and the rows 3 and 4; single precision of acos and atan: 1e-4.
    EXPECT_NEAR(seen(scene, {0, 1, 0}).x, 7.5, 1e-3);
    EXPECT_NEAR(seen(scene, {0, 1, 0}).y, 3.5, 1e-3);
    EXPECT_NEAR(seen(scene, {1, 0, 0}).x, 11.5, 1e-3) << "the right half is to the right";
    EXPECT_NEAR(seen(scene, {-1, 0, 0}).x, 3.5, 1e-3);
    EXPECT_NEAR(seen(scene, {0, 0, 1}).y, 0.0, 1e-3);
    EXPECT_NEAR(seen(scene, {0, 0, -1}).y, 7.0, 1e-3);
    EXPECT_NEAR(seen(scene, {0, -1, 0}).x, 7.5, 1e-3) << "half of the first column, half of the last";
    EXPECT_NEAR(seen(scene, {0.3F, 0.5F, -0.2F}).z, 1.0, 1e-6);
}

TEST_F(EnvironmentMapTest, without_a_file_everything_is_white) {
    EXPECT_EQ(seen(sceneOf(""), {0, 0, 1}), glm::dvec3(1.0));
}

TEST_F(EnvironmentMapTest, what_is_no_light_is_black_and_large_pictures_keep_their_light) {
    render::setPictureLoader([](const std::filesystem::path&) {
        Image<float> image(8, 4, 3);
        for (std::size_t i = 0; i < image.data().size(); ++i)
            image.data()[i] = static_cast<float>(i % 7);
        image.at(0, 0)[0] = std::numeric_limits<float>::quiet_NaN();
        image.at(1, 0)[0] = -3.0F;
        return image;
    });
    const Image<float> whole = render::loadPicture("x.exr");
    EXPECT_EQ(whole.at(0, 0)[0], 0.0F);
    EXPECT_EQ(whole.at(1, 0)[0], 0.0F);
    const Image<float> small = render::loadPicture("x.exr", 2);
    ASSERT_EQ(small.width(), 2);
    ASSERT_EQ(small.height(), 1);
    double sum = 0.0;
    double smallSum = 0.0;
    for (const float value : whole.data())
        sum += static_cast<double>(value) / 96.0;
    for (const float value : small.data())
        smallSum += static_cast<double>(value) / 6.0;
    EXPECT_NEAR(sum, smallSum, 1e-5);
}

TEST_F(EnvironmentMapTest, directions_are_drawn_from_where_the_light_is) {
    render::setPictureLoader(lamp);
    // The table of directions is the environment's own: nearly all of it points at the bright pixel.
    const scene::Scene scene = sceneOf("lamp.exr");
    const render::BuildOptions options;
    gpu::KernelCache cache(context());
    render::EnvironmentDistribution distribution(context(), cache, options, scene);
    distribution.update(scene, render::View(scene, {32, 32}), render::EnvironmentPicture(context(), scene));
    gpu::ShaderSource source;
    source.addFile("render/glsl/environment_distribution.glsl");
    source.addText("draw", "void kernel_main(ivec2 pixel, out vec4 color) {\n    float pdf;\n"
                           "    color = vec4(environment_sample((vec2(pixel) + 0.5) / 16.0, pdf), 1.0);\n}\n");
    const Image<float> drawn =
        runKernel(source, gpu::Stage::Fragment, {16, 16}, 1, [&](auto& kernel) { distribution.bind(kernel); })[0];
    const double turn = 2.0 * std::numbers::pi * ((20 + 0.5) / 64.0 - 0.5);
    const double up = std::cos(std::numbers::pi * (6 + 0.5) / 32.0);
    const double flat = std::sqrt(1.0 - up * up);
    const glm::dvec3 towards(flat * std::sin(turn), flat * std::cos(turn), up);
    int near = 0;
    for (int i = 0; i < 256; ++i)
        if (glm::dot(rgb(drawn.at(i % 16, i / 16)), towards) > std::cos(0.2)) ++near;
    EXPECT_GT(near, 245) << "2 % go everywhere alike";
}

TEST_F(EnvironmentMapTest, missing_files_are_an_error_that_changes_nothing) {
    render::setPictureLoader(grid);
    session::Session session(context(), sceneOf("grid.exr"));
    EXPECT_THAT(errorOf([&] { session.set("environment.file", std::string_view("no.exr")); })->what(),
                HasSubstr("environment.file: no.exr: there is no such file"));
    EXPECT_EQ(session.scene().environment.text("file"), "grid.exr");
    EXPECT_NO_THROW(session.step(1.0));
}

TEST_F(EnvironmentMapTest, files_are_relative_to_the_document) {
    const auto scene = scene::Scene::parse(session::catalogue(), "a/b.json",
                                           R"({"apeiron": 1, "environment": {"type": "map", "file": "sky.hdr"}})", "a");
    EXPECT_EQ(scene.environment.text("file"), "a/sky.hdr");
}

} // namespace
} // namespace apeiron::test
