#include "gpu_support.hpp"

#include "render/kernel_sources.hpp"
#include "session/subjects.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace apeiron::test {
namespace {

std::unique_ptr<gpu::Context> theContext;

/// Ends the context before static objects of the driver's do.
class ContextEnd : public testing::Environment {
  public:
    void TearDown() override { theContext.reset(); }
};

const auto* const kContextEnd = testing::AddGlobalTestEnvironment(new ContextEnd);

} // namespace

const gpu::Context& context() {
    if (!theContext) theContext = gpu::Context::create({.debug = true});
    return *theContext;
}

scene::Scene sceneOf(const std::string& json) {
    return scene::Scene::parse(session::catalogue(), "test.json", json);
}

parameter::ModuleReference formulaOf(const std::string& estimate, double bound) {
    return {"exact", fmt::format(R"(#include "fractal/orbit.glsl"
uniform int iterations; //! 1 [1, 4] | Not used
uniform float bailout;  //! 1e9 [1, 1e10] | Not used
void iterate(inout Orbit orbit) {{}}
float estimate(Orbit orbit) {{ vec3 p = orbit.z; return {}; }}
float bound() {{ return {:.6f}; }}
)",
                                 estimate, bound)};
}

parameter::ModuleReference unitSphere() {
    return formulaOf("length(p) - 1.0", 1.01);
}

scene::Scene darkSphere(glm::ivec2 size) {
    scene::Scene scene = sceneOf(fmt::format(R"({{
        "apeiron": 1,
        "camera": {{"position": ["0", "-4", "0"], "fov": 40, "filter": "box"}},
        "subject": {{"coloring": "solid", "color_a": [0.5, 0.5, 0.5], "roughness": 1, "detail": 0.05}},
        "renderer": {{"brdf": "lambert", "shadow": "none", "ambient_occlusion": "none"}},
        "lights": [],
        "environment": {{"type": "constant", "color": [0, 0, 0]}},
        "post": {{"tonemapper": "linear"}},
        "output": {{"width": {}, "height": {}, "samples": 1}}
    }})",
                                             size.x, size.y));
    scene.subject.set("formula", unitSphere());
    return scene;
}

void setAll(scene::Scene& scene, std::initializer_list<std::pair<const char*, const char*>> values) {
    for (const auto& [path, text] : values)
        scene.set(path, std::string_view(text));
}

void finish(session::Session& session) {
    while (!session.step(0.25).finished) {
    }
}

std::unique_ptr<session::Session> rendered(const scene::Scene& scene, const session::Options& options) {
    auto session = std::make_unique<session::Session>(context(), scene, options);
    finish(*session);
    return session;
}

std::vector<Image<float>> runKernel(const gpu::ShaderSource& source, gpu::Stage stage, glm::ivec2 size,
                                    std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare) {
    const std::vector<gpu::PixelFormat> formats(outputs, gpu::PixelFormat::RGBA32F);
    gpu::Kernel kernel(context(), "test", source, stage, formats);
    std::vector<gpu::Texture> textures;
    textures.reserve(outputs);
    std::vector<const gpu::Texture*> pointers;
    for (std::size_t i = 0; i < outputs; ++i) {
        textures.emplace_back(context(), gpu::PixelFormat::RGBA32F, size, "test");
        pointers.push_back(&textures.back());
    }
    const gpu::Targets targets(context(), pointers);
    if (prepare) prepare(kernel);
    kernel.run(targets);
    context().finish();
    std::vector<Image<float>> images;
    for (const gpu::Texture& texture : textures)
        images.push_back(texture.download());
    return images;
}

std::vector<Image<float>> runText(std::initializer_list<const char*> files, const std::string& text, glm::ivec2 size,
                                  std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare) {
    gpu::ShaderSource source;
    for (const char* file : files)
        source.addFile(file);
    source.addText("test", text);
    return runKernel(source, gpu::Stage::Fragment, size, outputs, prepare);
}

std::vector<Image<float>> runOnScene(const scene::Scene& scene, const std::string& text, glm::ivec2 size,
                                     std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare) {
    std::unique_ptr<render::Subject> subject;
    for (const render::SubjectType& type : session::subjectTypes()) {
        if (type.node.name == scene.subject.type().name) subject = type.create();
    }
    gpu::ShaderSource source;
    source.addFile("render/glsl/camera.glsl");
    source.addFile("render/glsl/brdf.glsl");
    render::addEnvironment(source, scene, true);
    subject->addSource(source, scene, {gpu::Stage::Fragment, true});
    source.addText("test", text);
    const render::View view(
        scene, {static_cast<int>(scene.output.integer("width")), static_cast<int>(scene.output.integer("height"))});
    return runKernel(source, gpu::Stage::Fragment, size, outputs, [&](gpu::Kernel& kernel) {
        view.upload(kernel);
        subject->bind(kernel, scene);
        if (prepare) prepare(kernel);
    });
}

bool identical(const Image<float>& a, const Image<float>& b) {
    return a.width() == b.width() && a.height() == b.height() && a.channels() == b.channels() &&
           std::memcmp(a.data().data(), b.data().data(), a.data().size() * sizeof(float)) == 0;
}

double largestDifference(const Image<float>& a, const Image<float>& b) {
    EXPECT_EQ(a.data().size(), b.data().size());
    double largest = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i) {
        const double difference = std::abs(static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]));
        // Not std::max, which would lose a NaN.
        if (!(difference <= largest)) largest = difference;
    }
    return largest;
}

bool allFinite(const Image<float>& image) {
    for (const float value : image.data()) {
        if (!std::isfinite(value)) return false;
    }
    return true;
}

} // namespace apeiron::test
