#include "render/kernel_sources.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

#include <sstream>

namespace apeiron::render {
namespace {

constexpr const char* kNoSurface = "float surface_clear(Ray cone) { return cone.t_min; }\n";

void requireInterfaces(const scene::Scene& scene, const Subject& subject) {
    const parameter::GlslModule& module = scene.renderer.module("type");
    const auto tag = module.tags.find("needs");
    if (tag == module.tags.end()) return;
    const std::set<std::string> given = subject.provides();
    std::istringstream needs(tag->second);
    std::string name;
    while (needs >> name) {
        if (given.contains(name)) continue;
        const std::string& kind = scene.subject.type().name;
        throw Error(ErrorKind::BadInput,
                    fmt::format("renderer '{}' needs a {}, which a {} does not have", module.name, name, kind),
                    "renderer.type", fmt::format("a {} has: {}", kind, fmt::join(given, ", ")));
    }
}

/// What glsl/light.glsl needs to know of lights.
std::string lightKinds(const std::vector<parameter::Node>& lights) {
    bool discs = false;
    bool panels = false;
    bool local = false;
    bool shown = false;
    for (const parameter::Node& light : lights) {
        const bool panel = light.type().name == "rectangle";
        panels = panels || panel;
        discs = discs || !panel;
        local = local || light.type().name != "sun";
        shown = shown || (panel && light.get<bool>("visible"));
    }
    return fmt::format("const int light_count = {};\nconst bool light_discs = {};\nconst bool light_panels = {};\n"
                       "const bool light_local = {};\nconst bool light_shown = {};\n",
                       lights.size(), discs, panels, local, shown);
}

void addEnvironment(gpu::ShaderSource& source, const scene::Scene& scene, bool specialise,
                    const std::vector<parameter::Node>& lights) {
    source.addText("the lights' kinds", lightKinds(lights));
    source.addFile("render/glsl/environment.glsl");
    source.addModule(scene.environment.module("type"), "environment_", scene.environment, "environment", specialise);
}

} // namespace

void addEnvironment(gpu::ShaderSource& source, const scene::Scene& scene, bool specialise) {
    addEnvironment(source, scene, specialise, scene.lights);
}

std::string integratorOf(const scene::Scene& scene) {
    const auto& tags = scene.renderer.module("type").tags;
    const auto tag = tags.find("integrate");
    return tag != tags.end() ? tag->second : "mean";
}

bool samplesEnvironment(const scene::Scene& scene) {
    const auto& tags = scene.renderer.module("type").tags;
    const auto tag = tags.find("samples");
    return tag != tags.end() && tag->second == "environment";
}

std::string variantOf(const scene::Scene& scene, const Subject& subject) {
    return subject.variant() + lightKinds(scene.lights);
}

gpu::ShaderSource generateSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options,
                                 bool peaked) {
    requireInterfaces(scene, subject);
    gpu::ShaderSource source;
    source.addText("the environment's kind", fmt::format("const bool environment_peaked = {};\n", peaked));
    addEnvironment(source, scene, options.specialise);
    subject.addSource(source, scene, options);
    source.addModule(scene.renderer.module("type"), "renderer_", scene.renderer, "renderer", options.specialise,
                     gpu::ShaderSource::Rename::Everything);
    source.addFile("render/glsl/generate.glsl");
    return source;
}

gpu::ShaderSource prepassSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options) {
    gpu::ShaderSource source;
    subject.addSource(source, scene, options);
    if (!subject.provides().contains("surface")) source.addText("no surface", kNoSurface);
    source.addFile("render/glsl/prepass.glsl");
    return source;
}

gpu::ShaderSource harmonicsSource(const scene::Scene& scene, const BuildOptions& options) {
    gpu::ShaderSource source;
    addEnvironment(source, scene, options.specialise, {}); // of lights it has but the direction of the sun
    source.addFile("render/glsl/environment_sh.glsl");
    return source;
}

gpu::ShaderSource environmentPowerSource(const scene::Scene& scene, const BuildOptions& options) {
    gpu::ShaderSource source;
    addEnvironment(source, scene, options.specialise, {}); // of lights it has but the direction of the sun
    source.addFile("render/glsl/environment_power.glsl");
    return source;
}

gpu::ShaderSource integrateSource(const std::string& integrator) {
    gpu::ShaderSource source;
    source.addFile("render/glsl/integrate_" + integrator + ".glsl");
    return source;
}

gpu::ShaderSource presentSource(const std::string& integrator, const PresentKind& kind) {
    gpu::ShaderSource source;
    source.addText("what is presented", fmt::format("const bool present_accumulated = {};\n"
                                                    "const bool history_there = {};\n",
                                                    kind.accumulated, kind.history));
    source.addFile(fmt::format("render/glsl/present_{}{}.glsl", integrator, kind.points ? "_moved" : ""));
    return source;
}

gpu::ShaderSource probeSource(const scene::Scene& scene, const Subject& subject, const BuildOptions& options) {
    gpu::ShaderSource source;
    subject.addSource(source, scene, options);
    source.addFile("render/glsl/probe.glsl");
    return source;
}

} // namespace apeiron::render
