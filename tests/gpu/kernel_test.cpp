// Every kernel: valid GLSL for both stages by an independent compiler, and the same picture from both.

#include "gpu_support.hpp"

#include "post/chain.hpp"
#include "render/kernel_sources.hpp"
#include "session/subjects.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>

namespace apeiron::test {
namespace {

using gpu::Stage;

struct NamedKernel {
    std::string name;
    gpu::ShaderSource source;
};

parameter::ModuleReference named(const std::string& name) {
    return {name, {}};
}

/// The names of the Choice parameters of a node that make other kernels.
std::vector<std::pair<std::string, std::string>> programChoices(const parameter::Node& node) {
    std::vector<std::pair<std::string, std::string>> all;
    for (const parameter::Parameter& p : node.schema()) {
        if (p.invalidates != parameter::Invalidates::Program) continue;
        if (p.type == parameter::Type::Bool) all.insert(all.end(), {{p.name, "true"}, {p.name, "false"}});
        if (p.type != parameter::Type::Choice) continue;
        for (const std::string& label : p.choices)
            all.emplace_back(p.name, label);
    }
    return all;
}

/// The scene with the first subject that has what a renderer needs, small where it is computed.
scene::Scene subjectFor(const std::string& renderer, scene::Scene scene) {
    scene.renderer.set("type", named(renderer));
    for (const render::SubjectType& type : session::subjectTypes()) {
        const std::set<std::string> given = type.create()->provides();
        const auto& tags = scene.renderer.module("type").tags;
        std::istringstream needs(tags.contains("needs") ? tags.at("needs") : "");
        bool all = true;
        for (std::string name; needs >> name;)
            all = all && given.contains(name);
        if (!all) continue;
        scene.set("subject.type", type.node.name);
        if (type.node.name == "volume") scene.set("subject.resolution", "16");
        break;
    }
    return scene;
}

/// Scenes that together use every module and every choice that makes other kernels; not the product of all.
std::vector<std::pair<std::string, scene::Scene>> scenesOfAllKinds() {
    std::vector<std::pair<std::string, scene::Scene>> scenes;
    const scene::Scene plain(session::catalogue());
    for (const std::string& formula : parameter::moduleNames("formulas")) {
        scene::Scene scene = plain;
        scene.subject.set("formula", named(formula));
        scenes.emplace_back(formula, scene);
        for (const auto& [name, value] : programChoices(scene.subject)) {
            scene::Scene other = scene;
            // What is not the formula's own is tried with one formula only.
            const bool own = [&] {
                const auto& parameters = scene.subject.module("formula").parameters;
                return std::any_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
            }();
            if (!own && formula != plain.subject.module("formula").name) continue;
            other.subject.setFromText(name, value);
            scenes.emplace_back(formula + " " + name + "=" + value, other);
        }
    }
    for (const std::string& renderer : parameter::moduleNames("renderers")) {
        scene::Scene scene = subjectFor(renderer, plain);
        scene.renderer.set("type", named(renderer));
        scenes.emplace_back(renderer, scene);
        for (const auto& [name, value] : programChoices(scene.renderer)) {
            scene::Scene other = scene;
            other.renderer.setFromText(name, value);
            scenes.emplace_back(renderer + " " + name + "=" + value, other);
        }
    }
    for (const render::SubjectType& type : session::subjectTypes()) {
        scene::Scene scene = plain;
        scene.set("subject.type", type.node.name);
        scenes.emplace_back(type.node.name, scene);
    }
    for (const std::string& environment : parameter::moduleNames("environments")) {
        scene::Scene scene = plain;
        scene.environment.set("type", named(environment));
        scenes.emplace_back(environment, scene);
    }
    return scenes;
}

std::vector<NamedKernel> allKernels() {
    std::vector<NamedKernel> kernels;
    std::set<std::string> integrators;
    for (const auto& [name, scene] : scenesOfAllKinds()) {
        std::unique_ptr<render::Subject> subject;
        for (const render::SubjectType& type : session::subjectTypes()) {
            if (type.node.name == scene.subject.type().name) subject = type.create();
        }
        subject->prepare(context(), scene);
        for (const bool specialise : {true, false}) {
            const render::BuildOptions options{Stage::Fragment, specialise};
            const std::string label = name + (specialise ? " specialised" : " variable");
            kernels.push_back({label, render::generateSource(scene, *subject, options)});
            kernels.push_back({label + " harmonics", render::harmonicsSource(scene, options)});
            kernels.push_back({label + " prepass", render::prepassSource(scene, *subject, options)});
            kernels.push_back({label + " environment", render::environmentPowerSource(scene, options)});
            kernels.push_back({label + " probe", render::probeSource(scene, *subject, options)});
        }
        integrators.insert(render::integratorOf(scene));
    }
    for (const std::string& integrator : integrators) {
        kernels.push_back({"integrate " + integrator, render::integrateSource(integrator)});
        for (const bool accumulated : {false, true}) {
            for (const auto& [points, history] : {std::pair(false, false), {true, false}, {true, true}}) {
                kernels.push_back({fmt::format("present {} {} {} {}", integrator, accumulated, points, history),
                                   render::presentSource(integrator, {accumulated, points, history})});
            }
        }
    }
    for (const char* pass : {"grid", "histogram", "result"})
        kernels.push_back({std::string("meter ") + pass, post::Meter::source(pass)});
    const auto catalogue = session::catalogue();
    for (const std::string& effect : parameter::moduleNames("effects")) {
        parameter::Node node(catalogue->type("effect", ""));
        node.set("type", named(effect));
        kernels.push_back({effect, post::effectSource(node)});
    }
    for (const std::string& tonemapper : parameter::moduleNames("tonemappers")) {
        parameter::Node node(catalogue->type("post", ""));
        node.set("tonemapper", named(tonemapper));
        kernels.push_back({tonemapper, post::displaySource(node)});
    }
    return kernels;
}

/// Runs a program. @returns its exit status and what it printed
std::pair<int, std::string> run(const std::string& command) {
    std::string output;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return {-1, "cannot run"};
    std::array<char, 4096> buffer{};
    for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        output.append(buffer.data(), n);
    return {pclose(pipe), output};
}

/// Lines of glslang's output that say what is wrong.
std::string errorsOf(const std::string& output) {
    std::string errors;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        if (line.find("ERROR") != std::string::npos || line.find("WARNING") != std::string::npos) errors += line + "\n";
    }
    return errors.substr(0, 3000);
}

struct GlslTarget {
    Stage stage;
    const char* version;
    const char* kind;
};

class GlslTargets : public testing::TestWithParam<GlslTarget> {};
INSTANTIATE_TEST_SUITE_P(Kernels, GlslTargets,
                         testing::Values(GlslTarget{Stage::Fragment, "300 es", "frag"},
                                         GlslTarget{Stage::Compute, "430", "comp"},
                                         GlslTarget{Stage::Compute, "310 es", "comp"}),
                         [](const auto& instance) {
                             std::string name = fmt::format("{}_{}", instance.param.kind, instance.param.version);
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

TEST_P(GlslTargets, are_valid_by_glslang) {
    if (run("glslangValidator --version").first != 0) GTEST_SKIP() << "glslangValidator is not installed";
    const GlslTarget& target = GetParam();
    const TemporaryFolder folder;
    std::set<std::string> seen;
    std::string command = fmt::format("glslangValidator -S {}", target.kind);
    for (const NamedKernel& kernel : allKernels()) {
        // Constants instead of uniforms are the same for every stage.
        if (target.stage == Stage::Compute && kernel.name.find(" specialised") != std::string::npos) continue;
        const std::vector<gpu::PixelFormat> formats(kernel.source.outputs().size(), gpu::PixelFormat::RGBA32F);
        ASSERT_FALSE(formats.empty()) << kernel.name;
        const std::string text = gpu::stageText(kernel.source, target.stage, formats, target.version);
        if (!seen.insert(text).second) continue;
        // The name is what glslang prints before the errors.
        std::string name = kernel.name;
        std::replace(name.begin(), name.end(), ' ', '_');
        const std::filesystem::path path = folder / (name + ".glsl");
        std::ofstream(path) << text;
        command += " '" + path.string() + "'";
    }
    EXPECT_GT(seen.size(), 50U);
    const auto [status, output] = run(command);
    EXPECT_EQ(status, 0) << errorsOf(output);
    EXPECT_EQ(output.find("WARNING"), std::string::npos) << errorsOf(output);
}

TEST(Kernels, glslang_would_find_a_mistake) {
    if (run("glslangValidator --version").first != 0) GTEST_SKIP() << "glslangValidator is not installed";
    const TemporaryFolder folder;
    gpu::ShaderSource source;
    source.addText("x", "void kernel_main(ivec2 pixel, out vec4 a) { a = vec4(1); int i = 0.5; }\n");
    std::ofstream(folder / "bad.glsl") << gpu::stageText(source, Stage::Fragment, {gpu::PixelFormat::RGBA32F},
                                                         "300 es");
    EXPECT_NE(run("glslangValidator -S frag '" + (folder / "bad.glsl").string() + "'").first, 0);
}

/// A picture small enough for a software rasteriser, with parts of blocks at both edges.
scene::Scene small(scene::Scene scene) {
    setAll(scene, {{"output.width", "43"}, {"output.height", "29"}, {"output.samples", "2"}});
    return scene;
}

void expectSameFromBothStages(const scene::Scene& scene, bool specialise) {
    if (!context().capabilities().compute) GTEST_SKIP() << "no compute shaders here";
    const auto fragment = rendered(scene, {.stage = Stage::Fragment, .specialise = specialise});
    const auto compute = rendered(scene, {.stage = Stage::Compute, .specialise = specialise});
    const auto a = fragment->layers();
    const auto b = compute->layers();
    // The same arithmetic, compiled twice by the same compiler: no difference at all is expected of software. Hardware
    // drivers may contract multiplications and additions differently; there, a hit may turn into a miss at an edge.
    if (context().capabilities().software) {
        EXPECT_EQ(largestDifference(a.radiance, b.radiance), 0.0);
        EXPECT_EQ(largestDifference(a.geometry, b.geometry), 0.0);
        EXPECT_EQ(largestDifference(a.albedo, b.albedo), 0.0);
        EXPECT_EQ(largestDifference(fragment->picture(), compute->picture()), 0.0);
    } else {
        const Image<float> p = fragment->picture();
        const Image<float> q = compute->picture();
        std::size_t far = 0;
        for (std::size_t i = 0; i < p.data().size(); ++i)
            far += std::abs(p.data()[i] - q.data()[i]) > 1.0F / 255.0F;
        EXPECT_LE(far, p.data().size() / 50);
    }
    EXPECT_TRUE(allFinite(a.radiance));
    EXPECT_TRUE(allFinite(a.geometry));
    EXPECT_TRUE(allFinite(a.albedo));
    EXPECT_EQ(fragment->distanceToSurface(), compute->distanceToSurface());
}

class EveryFormula : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryFormula, testing::ValuesIn(parameter::moduleNames("formulas")),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryFormula, gives_the_same_picture_in_both_stages) {
    scene::Scene scene = small(scene::Scene(session::catalogue()));
    scene.subject.set("formula", named(GetParam()));
    // With parameters as uniforms: what all programs have in common. The gallery's tests compare the specialised ones.
    expectSameFromBothStages(scene, false);
}

class EveryEnvironment : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryEnvironment, testing::ValuesIn(parameter::moduleNames("environments")),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryEnvironment, gives_the_same_picture_in_both_stages) {
    scene::Scene scene = small(darkSphere());
    scene.environment.set("type", named(GetParam()));
    setAll(scene, {{"environment.rotation", "30"}, {"renderer.ambient_occlusion", "field"}});
    expectSameFromBothStages(scene, true);
}

/// The choices of the ray marcher, each value of each at least once.
struct Look {
    const char* brdf;
    const char* shadow;
    const char* occlusion;
    const char* projection;
    const char* filter;
};
class EveryLook : public testing::TestWithParam<Look> {};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryLook,
                         testing::Values(Look{"lambert", "none", "none", "perspective", "box"},
                                         Look{"phong", "hard", "field", "orthographic", "tent"},
                                         Look{"ggx", "penumbra", "sampled", "perspective", "gaussian"},
                                         Look{"ggx", "sampled", "sampled", "perspective", "gaussian"},
                                         Look{"ggx", "none", "steps", "perspective", "box"}),
                         [](const auto& instance) {
                             return fmt::format("{}_{}_{}", instance.param.brdf, instance.param.shadow,
                                                instance.param.occlusion);
                         });

TEST_P(EveryLook, gives_the_same_picture_in_both_stages) {
    const Look& look = GetParam();
    scene::Scene scene = small(darkSphere());
    scene.subject.set("formula", formulaOf("min(length(p) - 1.0, length(p - vec3(0.6, -1.0, 0.9)) - 0.3)", 2.0));
    setAll(scene, {{"renderer.brdf", look.brdf},
                   {"renderer.shadow", look.shadow},
                   {"renderer.ambient_occlusion", look.occlusion},
                   {"camera.projection", look.projection},
                   {"camera.filter", look.filter},
                   {"environment.color", "0.3,0.4,0.5"},
                   {"lights", R"([{"type": "sun", "size": 5}, {"type": "point"}])"}});
    expectSameFromBothStages(scene, true);
}

TEST(Kernels, post_chains_give_the_same_picture_in_both_stages) {
    if (!context().capabilities().compute) GTEST_SKIP() << "no compute shaders here";
    scene::Scene scene = small(darkSphere());
    setAll(scene, {{"environment.color", "0.3,2,0.5"}, {"renderer.ambient_occlusion", "field"}});
    session::Session fragment(context(), scene, {.stage = Stage::Fragment});
    session::Session compute(context(), scene, {.stage = Stage::Compute});
    finish(fragment);
    finish(compute);
    const auto expectSame = [&](const std::string& what) {
        const Image<float> a = fragment.picture(1.0 / 255.0);
        EXPECT_LE(largestDifference(a, compute.picture(1.0 / 255.0)), context().capabilities().software ? 0.0 : 1e-5)
            << what;
        EXPECT_TRUE(allFinite(a)) << what;
        EXPECT_EQ(fragment.samples(), 2) << "the post chain lost samples";
    };
    for (const std::string& tonemapper : parameter::moduleNames("tonemappers")) {
        for (session::Session* session : {&fragment, &compute})
            session->set("post.tonemapper", std::string_view(tonemapper));
        expectSame(tonemapper);
    }
    for (session::Session* session : {&fragment, &compute})
        session->set("post.exposure_mode", std::string_view("auto"));
    expectSame("the light meter");
    for (const std::string& effect : parameter::moduleNames("effects")) {
        const std::string list = fmt::format(R"([{{"type": "{0}"}}])", effect);
        for (session::Session* session : {&fragment, &compute})
            session->set("post.effects", std::string_view(list));
        expectSame(effect);
    }
}

TEST(Kernel, wants_one_format_for_each_output) {
    gpu::ShaderSource source;
    source.addText("x", "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) { a = vec4(1); b = vec4(2); }\n");
    const auto error = errorOf([&] { runKernel(source, Stage::Fragment, {4, 4}, 1); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("kernel_main"));
}

class EveryStage : public testing::TestWithParam<Stage> {
  protected:
    void SetUp() override {
        if (GetParam() == Stage::Compute && !context().capabilities().compute) GTEST_SKIP() << "no compute shaders";
    }
};
INSTANTIATE_TEST_SUITE_P(Kernel, EveryStage, testing::Values(Stage::Fragment, Stage::Compute),
                         [](const auto& instance) { return std::string(gpu::toString(instance.param)); });

TEST_P(EveryStage, writes_exactly_its_region_and_counts_pixels_from_the_top_left) {
    gpu::ShaderSource source;
    source.addText("x", "void kernel_main(ivec2 pixel, out vec4 a, out vec4 b) {\n"
                        "    a = vec4(pixel, 1.0, 2.0);\n    b = vec4(3.0 * vec2(pixel), 0.0, 1.0);\n}\n");
    const std::vector<gpu::PixelFormat> formats(2, gpu::PixelFormat::RGBA32F);
    gpu::Kernel kernel(context(), "test", source, GetParam(), formats);
    const glm::ivec2 size(37, 21);
    const gpu::Texture a(context(), gpu::PixelFormat::RGBA32F, size, "a");
    const gpu::Texture b(context(), gpu::PixelFormat::RGBA32F, size, "b");
    const gpu::Targets targets(context(), {&a, &b});
    // Texel (5, 3) is pixel (1, 2), and so on every third; the picture ends at 25 x 20.
    kernel.run(targets, {{5, 3}, {13, 9}}, {25, 20}, {{5, 3}, 3, {1, 2}});
    context().finish();
    const Image<float> first = a.download();
    const Image<float> second = b.download();
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const glm::ivec2 pixel((x - 5) * 3 + 1, (y - 3) * 3 + 2);
            const bool written = x >= 5 && y >= 3 && x < 18 && y < 12 && pixel.x < 25 && pixel.y < 20;
            const glm::vec4 expected = written ? glm::vec4(pixel, 1, 2) : glm::vec4(0);
            const float* texel = first.at(x, y);
            ASSERT_EQ(glm::vec4(texel[0], texel[1], texel[2], texel[3]), expected) << x << "," << y;
            ASSERT_EQ(second.at(x, y)[0], written ? static_cast<float>(3 * pixel.x) : 0.0F);
        }
    }
}

TEST_P(EveryStage, an_upload_downloads_as_it_was) {
    const glm::ivec2 size(5, 3);
    gpu::Texture texture(context(), gpu::PixelFormat::RGBA32F, size, "t");
    EXPECT_THAT(texture.download().data(), testing::Each(0.0F)) << "new textures are zero";
    std::vector<float> values(60);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i) * 1.1F - 7.0F;
    texture.upload(values);
    EXPECT_EQ(texture.download().data(), values);
    EXPECT_EQ(texture.texel({3, 2}).y, values[(2 * 5 + 3) * 4 + 1]);
    // And a kernel sees row 0 as row 0.
    gpu::ShaderSource source;
    source.addText("x", "uniform sampler2D t;\nvoid kernel_main(ivec2 p, out vec4 a) { a = texelFetch(t, p, 0); }\n");
    const auto copy = runKernel(source, GetParam(), size, 1, [&](gpu::Kernel& kernel) { kernel.set("t", texture); });
    EXPECT_EQ(copy[0].data(), values);
}

} // namespace
} // namespace apeiron::test
