// Every scene of the gallery, small: it loads, it looks like something, and both stages agree.

#include "core/resources.hpp"
#include "session/session.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace apeiron {
namespace {

std::vector<std::string> galleryScenes() {
    std::vector<std::string> names;
    for (const Resource& resource : resources()) {
        if (resource.path.starts_with("scenes/")) names.emplace_back(resource.path);
    }
    return names;
}

const gpu::Context& context() {
    static const std::unique_ptr<gpu::Context> kContext = gpu::Context::create({.device = -1, .debug = true});
    return *kContext;
}

scene::Scene load(const std::string& path) {
    scene::Scene scene = scene::Scene::parse(session::catalogue(), path, std::string(findResource(path)->text));
    scene.set("output.width", std::string_view("96"));
    scene.set("output.height", std::string_view("54"));
    scene.set("output.samples", std::string_view("2"));
    return scene;
}

Image<float> render(const std::string& path, gpu::Stage stage) {
    session::Options options;
    options.stage = stage;
    session::Session session(context(), load(path), options);
    while (!session.step(1.0).finished) {
    }
    const session::Session::Layers layers = session.layers();
    for (const Image<float>* layer : {&layers.radiance, &layers.geometry, &layers.albedo}) {
        for (const float value : layer->data())
            EXPECT_TRUE(std::isfinite(value));
    }
    return session.picture();
}

class GalleryTest : public testing::TestWithParam<std::string> {};

TEST_P(GalleryTest, shows_something_well_exposed) {
    const Image<float> picture = render(GetParam(), gpu::Stage::Fragment);
    double sum = 0.0;
    double squares = 0.0;
    std::size_t clipped = 0;
    const std::size_t pixels = picture.data().size() / 4;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* p = &picture.data()[4 * i];
        const double value = (static_cast<double>(p[0]) + static_cast<double>(p[1]) + static_cast<double>(p[2])) / 3.0;
        sum += value;
        squares += value * value;
        if (std::min({p[0], p[1], p[2]}) >= 1.0F) ++clipped;
    }
    const double mean = sum / static_cast<double>(pixels);
    const double deviation = std::sqrt(squares / static_cast<double>(pixels) - mean * mean);
    EXPECT_GT(mean, 0.12);
    EXPECT_LT(mean, 0.75);
    EXPECT_GT(deviation, 0.06) << "a flat picture";
    EXPECT_LT(clipped, pixels / 50) << "overexposed";
}

TEST_P(GalleryTest, is_the_same_from_both_stages) {
    if (!context().capabilities().compute)
        GTEST_SKIP() << "no compute shaders on " << context().capabilities().renderer;
    const Image<float> a = render(GetParam(), gpu::Stage::Fragment);
    const Image<float> b = render(GetParam(), gpu::Stage::Compute);
    // The same code for the same device: nothing but the order of independent pixels may differ.
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.data().size(); ++i)
        different += a.data()[i] != b.data()[i] ? 1 : 0;
    EXPECT_EQ(different, 0U);
}

TEST_P(GalleryTest, survives_saving_and_loading) {
    const scene::Scene scene = load(GetParam());
    EXPECT_EQ(scene::Scene::parse(session::catalogue(), "saved", scene.toJson().dump()), scene);
    EXPECT_EQ(scene::Scene::parse(session::catalogue(), "saved", scene.toJson(true).dump()), scene);
}

INSTANTIATE_TEST_SUITE_P(, GalleryTest, testing::ValuesIn(galleryScenes()), [](const auto& test) {
    std::string name = test.param.substr(7);
    return name.substr(0, name.find('.'));
});

} // namespace
} // namespace apeiron
