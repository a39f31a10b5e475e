// How long rendering takes, phase by phase. Processor time of all threads is what counts on a CPU device.
//
//     ./run benchmark --benchmark_filter=plain

#include "core/file.hpp"
#include "core/stopwatch.hpp"
#include "scene/camera.hpp"
#include "session/session.hpp"
#include "terrain/scenery.hpp"

#include <benchmark/benchmark.h>

#include <numeric>

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
        while (session.samples() == 0 && !session.step(1.0 / 30.0).changed) {
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

/// The choice of a frame's tiles in a dive: 60 consecutive frames, to and fro, at some depth [levels]. Between two
/// frames a picture is drawn that leaves nothing of it in the processor's caches: with the second argument 16 MB are
/// read instead, untimed.
void terrainSelect(benchmark::State& state) {
    scene::Scene scene = load("scenes/terrain_range.json", 640, 360);
    scene.set("subject.depth", std::to_string(state.range(0)));
    const terrain::Site site(scene);
    terrain::Place place(site.shape, site.address);
    place.setPosition({0.5, 0.5, 2.0 / site.relief});
    const scene::Camera camera(scene.camera);
    terrain::Flight flight(std::move(place), camera.orientation(), site.relief);
    for (int i = 0; i < 20; ++i)
        flight.dive(1.0, 0.4);
    struct Frame {
        terrain::Place place;
        terrain::SelectionView view;
    };
    constexpr std::size_t kFrames = 60;
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < kFrames; ++i) {
        flight.dive(1.2, 1.0 / 30.0);
        terrain::SelectionView view;
        view.camera = glm::mat3_cast(flight.orientation());
        view.tanHalfFov = std::tan(0.5 * camera.fov());
        view.aspect = 640.0 / 360.0;
        view.relief = flight.relief();
        view.tileLevels = 6;
        view.ratio = terrain::splitRatio(360.0, view.tanHalfFov, 1.5, view.tileLevels);
        frames.push_back({flight.place(), view});
    }
    std::vector<int> others(state.range(1) != 0 ? std::size_t{1} << 22U : 0, 1);
    terrain::Selection selection;
    std::size_t at = 0;
    std::size_t tiles = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(std::accumulate(others.begin(), others.end(), 0));
        const std::size_t turn = at++ % (2 * kFrames);
        const Frame& frame = frames[std::min(turn, 2 * kFrames - 1 - turn)];
        const Stopwatch watch;
        tiles += selection.select(frame.place, frame.view).size();
        state.SetIterationTime(watch.seconds());
    }
    state.counters["tiles"] = benchmark::Counter(static_cast<double>(tiles), benchmark::Counter::kAvgIterations);
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
BENCHMARK(terrainSelect)
    ->ArgNames({"depth", "cold"})
    ->ArgsProduct({{40, 1000, 3000}, {0, 1}})
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
