// How long rendering takes, phase by phase. Processor time of all threads is what counts on a CPU device.
//
//     ./run benchmark --benchmark_filter=plain

#include "core/file.hpp"
#include "session/session.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace apeiron;

const gpu::Context& context() {
    static const std::unique_ptr<gpu::Context> kContext = gpu::Context::create();
    return *kContext;
}

scene::Scene load(const std::string& file, int width, int height) {
    const std::string path = APEIRON_SOURCE_DIR "/" + file;
    scene::Scene scene = scene::Scene::parse(session::catalogue(), path, readFile(path));
    scene.set("output.width", std::to_string(width));
    scene.set("output.height", std::to_string(height));
    scene.set("output.samples", std::string_view("1000000"));
    return scene;
}

/// Complete samples, integrated, of a picture that is compiled and warm.
void samples(benchmark::State& state, const std::string& file, gpu::Stage stage) {
    const auto width = static_cast<int>(state.range(0));
    const auto height = static_cast<int>(state.range(1));
    if (stage == gpu::Stage::Compute && !context().capabilities().compute) {
        state.SkipWithError("the device has no compute shaders");
        return;
    }
    session::Options options;
    options.stage = stage;
    session::Session session(context(), load(file, width, height), options);
    for (auto _ : state) {
        const std::int64_t before = session.samples();
        while (session.samples() == before)
            session.step(1.0);
    }
    state.counters["pixels/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * width * height, benchmark::Counter::kIsRate);
    state.SetLabel(context().capabilities().renderer);
}

/// From an edit of a transfer function on 256³ voxels to the first whole picture of it, without reading it back.
void transferEdit(benchmark::State& state, const char* renderer) {
    scene::Scene scene(session::catalogue());
    scene.set("subject", Json{{"type", "volume"}, {"source", "cloud"}, {"resolution", 256}});
    scene.set("renderer", Json{{"type", renderer}});
    scene.set("output.width", std::string_view("512"));
    scene.set("output.height", std::string_view("512"));
    session::Options options;
    options.interleave = 8;
    session::Session session(context(), scene, options);
    while (session.samples() == 0)
        session.step(1.0);
    double opacity = 0.5;
    for (auto _ : state) {
        opacity = 1.5 - opacity;
        session.set("subject.transfer",
                    Json{{"points", {{{"value", 0}, {"opacity", 0}}, {{"value", 1}, {"opacity", opacity}}}}});
        while (session.samples() == 0 && !session.step(0.005).changed) {
        }
        benchmark::DoNotOptimize(session.distanceAt({0, 0})); // presents
    }
}

/// Reset, one sample, post chain and read-back: what `apeiron render --samples 1` does after compiling.
void wholePicture(benchmark::State& state, const std::string& file) {
    const auto side = static_cast<int>(state.range(0));
    session::Session session(context(), load(file, side, side));
    for (auto _ : state) {
        session.reset();
        while (session.samples() == 0)
            session.step(1.0);
        benchmark::DoNotOptimize(session.picture(1.0 / 255.0));
    }
}

/// A session from nothing, without the kernel cache: what every start of the program pays.
void compile(benchmark::State& state, const std::string& file) {
    for (auto _ : state) {
        const session::Session session(context(), load(file, 64, 64));
        benchmark::DoNotOptimize(session.samples());
    }
}

} // namespace

#define APEIRON_BENCH(FUNCTION, NAME, ...)                                                                             \
    BENCHMARK_CAPTURE(FUNCTION, NAME, __VA_ARGS__)                                                                     \
        ->MeasureProcessCPUTime()                                                                                      \
        ->UseRealTime()                                                                                                \
        ->Unit(benchmark::kMillisecond)

APEIRON_BENCH(wholePicture, bulb_plain, "bench/peers/bulb_plain.json")->Arg(512)->Arg(1024);
APEIRON_BENCH(wholePicture, bulb_lit, "bench/peers/bulb_lit.json")->Arg(512)->Arg(1024);
APEIRON_BENCH(samples, bulb_fragment, "scenes/mandelbulb.json", gpu::Stage::Fragment)->Args({640, 360});
APEIRON_BENCH(samples, bulb_compute, "scenes/mandelbulb.json", gpu::Stage::Compute)->Args({640, 360});
APEIRON_BENCH(samples, box_fragment, "scenes/mandelbox.json", gpu::Stage::Fragment)->Args({640, 360});
APEIRON_BENCH(samples, box_compute, "scenes/mandelbox.json", gpu::Stage::Compute)->Args({640, 360});
APEIRON_BENCH(samples, menger_fragment, "scenes/menger_hall.json", gpu::Stage::Fragment)->Args({640, 360});
APEIRON_BENCH(samples, menger_compute, "scenes/menger_hall.json", gpu::Stage::Compute)->Args({640, 360});
APEIRON_BENCH(transferEdit, mcm_256, "mcm");
APEIRON_BENCH(transferEdit, eam_256, "eam");
APEIRON_BENCH(compile, bulb, "scenes/mandelbulb.json");
