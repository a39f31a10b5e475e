#include "options.hpp"
#include "scene_argument.hpp"
#include "statistics.hpp"
#include "table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace apeiron::cli {
namespace {

constexpr int kRepetitions = 3;

struct Case {
    std::string name;
    scene::Scene scene;
};

/// What one run took.
struct Run {
    double contextMs = 0.0;
    double compileMs = 0.0;
    double renderMs = 0.0;
    double renderCpuMs = 0.0;
    double renderGpuMs = 0.0;
    double pixelsPerSecond = 0.0;
    std::string device;
    std::string stage;
};

/// Ray marching alone: no shadows, no occlusion (as bench/peers/bulb_plain.json, which compares with other programs).
constexpr const char* kPlain = R"({
  "subject": { "type": "fractal", "formula": "mandelbulb", "iterations": 32, "bailout": 10, "polar": "elevation" },
  "camera": { "position": ["1.2", "-2.4", "0.8"], "fov": 53.13010235 },
  "renderer": { "type": "raymarch", "brdf": "lambert", "shadow": "none", "ambient_occlusion": "none", "sky_light": 0 },
  "environment": { "type": "constant" },
  "output": { "width": 512, "height": 512, "samples": 1 }
})";

std::vector<Case> standardCases() {
    scene::Scene lit(session::catalogue());
    lit.output.set("width", std::int64_t{320});
    lit.output.set("height", std::int64_t{180});
    lit.output.set("samples", std::int64_t{8});
    return {{"mandelbulb, plain", parseScene("bench", kPlain)}, {"default scene", std::move(lit)}};
}

Run runOnce(const Case& one, const DeviceOptions& options) {
    Phases phases;
    std::unique_ptr<gpu::Context> context;
    {
        const Phases::Scope scope(phases, "context");
        context = gpu::Context::create(options.context());
    }
    session::Options sessionOptions;
    sessionOptions.stage = options.chosenStage();
    session::Session session(*context, one.scene, sessionOptions);
    while (!session.step(0.1).finished) {
    }
    session.picture();
    phases = sum(phases, session.statistics().phases);
    const Phases::Times render = renderTimes(phases);
    return {phases.times["context"].wallMs,
            phases.times["compile"].wallMs,
            render.wallMs,
            render.cpuMs,
            render.gpuMs,
            pixelRate(session, 1e-3 * render.wallMs),
            context->capabilities().renderer,
            std::string(toString(session.stage()))};
}

double median(const std::vector<Run>& runs, double Run::*what) {
    std::vector<double> values;
    values.reserve(runs.size());
    for (const Run& run : runs)
        values.push_back(run.*what);
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

int bench(const std::optional<std::string>& scene, const SceneOptions& edits, const DeviceOptions& device, bool json) {
    std::vector<Case> cases = scene ? std::vector<Case>{{*scene, loadScene(*scene)}} : standardCases();
    for (Case& one : cases)
        edits.apply(one.scene);
    device.context();
    device.chosenStage();

    Json results = Json::array();
    std::vector<Row> rows{
        {"scene", "size", "samples", "context ms", "compile ms", "render ms", "CPU ms", "GPU ms", "Msamples/s"}};
    Run last;
    for (const Case& one : cases) {
        std::vector<Run> runs;
        runs.reserve(kRepetitions);
        for (int i = 0; i < kRepetitions; ++i)
            runs.push_back(runOnce(one, device));
        last = runs.back();
        const parameter::Node& output = one.scene.output;
        rows.push_back({one.name, fmt::format("{}x{}", output.integer("width"), output.integer("height")),
                        std::to_string(output.integer("samples")), fmt::format("{:.1f}", median(runs, &Run::contextMs)),
                        fmt::format("{:.1f}", median(runs, &Run::compileMs)),
                        fmt::format("{:.1f}", median(runs, &Run::renderMs)),
                        fmt::format("{:.1f}", median(runs, &Run::renderCpuMs)),
                        fmt::format("{:.1f}", median(runs, &Run::renderGpuMs)),
                        fmt::format("{:.3f}", 1e-6 * median(runs, &Run::pixelsPerSecond))});
        results.push_back({{"scene", one.name},
                           {"width", output.integer("width")},
                           {"height", output.integer("height")},
                           {"samples", output.integer("samples")},
                           {"device", last.device},
                           {"stage", last.stage},
                           {"context_ms", median(runs, &Run::contextMs)},
                           {"compile_ms", median(runs, &Run::compileMs)},
                           {"render_ms", median(runs, &Run::renderMs)},
                           {"render_cpu_ms", median(runs, &Run::renderCpuMs)},
                           {"render_gpu_ms", median(runs, &Run::renderGpuMs)},
                           {"samples_per_second", median(runs, &Run::pixelsPerSecond)}});
    }
    if (json)
        fmt::print("{}\n", results.dump(2));
    else
        fmt::print("{}, {} stage, medians of {}\n\n{}", last.device, last.stage, kRepetitions, alignedTable(rows, 1));
    return kDone;
}

} // namespace

void addBenchCommand(CLI::App& app, Action& action) {
    struct Options {
        std::optional<std::string> scene;
        SceneOptions edits;
        DeviceOptions device;
        bool json = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("bench", "Measure how fast this machine renders");
    command->footer("Example: apeiron bench mandelbulb --samples 16");
    command->add_option("SCENE", options->scene, "A scene instead of the standard ones (see 'apeiron render --help')")
        ->type_name("");
    options->edits.addTo(*command);
    options->device.addTo(*command);
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &action] {
        action = [options] { return bench(options->scene, options->edits, options->device, options->json); };
    });
}

} // namespace apeiron::cli
