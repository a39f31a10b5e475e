// A volume that is much larger than the memory for it: how soon there is a picture, how soon it is complete, and what
// that takes.
//
//     apeiron_stream [--edge 1024] [--memory 128] [--size 512] [--file FILE] [--pictures FOLDER]
//
// The volume is a sparse file of bytes: a gyroid's sheets in a ball, as it is found in foams. Work is done in steps of
// 100 ms; the first picture is the first whole sub-image, of the coarse level. Everything that is denser than a fifth
// of the window is opaque.

#include "bench_support.hpp"
#include "core/stopwatch.hpp"
#include "io/image_file.hpp"
#include "io/volume_file.hpp"
#include "session/session.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace {

using namespace apeiron;

/// [s]
constexpr double kStep = 0.1;
/// As in the page.
constexpr int kInterleave = 8;

struct Settings {
    int edge = 1024;
    double memory = 128;
    int size = 512;
    std::string renderer = "eam";
    std::string file = "/tmp/apeiron_stream.raw";
    std::string pictures;
};

/// Writes what is not zero; the rest is holes.
void makeVolume(const std::string& path, int edge) {
    std::ofstream file(path, std::ios::binary);
    const auto n = static_cast<std::size_t>(edge);
    std::vector<float> place(n), sine(n), cosine(n);
    for (std::size_t i = 0; i < n; ++i) {
        place[i] = (2.0F * static_cast<float>(i) + 1.0F) / static_cast<float>(n) - 1.0F;
        sine[i] = std::sin(18.0F * place[i]);
        cosine[i] = std::cos(18.0F * place[i]);
    }
    std::vector<char> row(n);
    for (std::size_t z = 0; z < n; ++z)
        for (std::size_t y = 0; y < n; ++y) {
            const float left = 0.81F - place[z] * place[z] - place[y] * place[y];
            if (left <= 0.0F) continue;
            const auto inside = [&](float x) { return x * x < left; };
            const auto first =
                static_cast<std::size_t>(std::find_if(place.begin(), place.end(), inside) - place.begin());
            std::size_t count = 0;
            for (std::size_t x = first; x < n && inside(place[x]); ++x, ++count) {
                const float g = sine[x] * cosine[y] + sine[y] * cosine[z] + sine[z] * cosine[x];
                const float sheet = 16.0F * g * g;
                const float value = 255.0F * (0.1F + left - place[x] * place[x]) / (1.0F + sheet * sheet);
                row[count] = static_cast<char>(static_cast<std::uint8_t>(value < 8.0F ? 0.0F : value));
            }
            file.seekp(static_cast<std::streamoff>((z * n + y) * n + first));
            file.write(row.data(), static_cast<std::streamsize>(count));
        }
    file.seekp(static_cast<std::streamoff>(n * n * n - 1));
    file.put(0);
    if (!file.flush()) throw Error(ErrorKind::Io, "cannot be written", path);
}

double residentMegabytes() {
    std::ifstream file("/proc/self/statm");
    double all = 0.0;
    double resident = 0.0;
    file >> all >> resident;
    return resident * 4096.0 / 1e6;
}

/// Of all threads [s].
double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

scene::Scene makeScene(const Settings& settings) {
    scene::Scene scene(session::catalogue());
    scene.set("subject", Json{{"type", "volume"},
                              {"source", settings.file},
                              {"raw", fmt::format("{0}x{0}x{0}:uint8", settings.edge)},
                              {"memory", settings.memory},
                              {"density", 1000},
                              {"transfer", Json::parse(R"({"window": "data", "points": [
                                  {"value": 0.1, "color": "#c06040", "opacity": 0},
                                  {"value": 0.2, "color": "#e0a070", "opacity": 1},
                                  {"value": 1, "color": "#fff0d0", "opacity": 1}]})")}});
    scene.set("renderer", Json{{"type", settings.renderer}});
    scene.output.set("width", static_cast<std::int64_t>(settings.size));
    scene.output.set("height", static_cast<std::int64_t>(settings.size));
    scene.output.set("samples", std::int64_t{4});
    return scene;
}

void measure(const Settings& settings) {
    makeVolume(settings.file, settings.edge);
    io::registerVolumeFiles();
    const auto context = gpu::Context::create();
    session::Options options;
    options.interleave = kInterleave;
    double before = 0.0;
    {
        // What programs and pictures take without a large volume.
        Settings small = settings;
        small.file += ".small";
        small.edge = 64;
        makeVolume(small.file, small.edge);
        session::Session session(*context, makeScene(small), options);
        while (!session.step(kStep).finished) {
        }
        before = residentMegabytes();
        std::remove(small.file.c_str());
    }
    const double cpuBefore = cpuSeconds();
    const Stopwatch watch;
    session::Session session(*context, makeScene(settings), options);
    const double ready = watch.seconds();
    const double readyCpu = cpuSeconds() - cpuBefore;
    double first = 0.0;
    double firstCpu = 0.0;
    double complete = 0.0;
    double completeCpu = 0.0;
    double most = 0.0;
    double longest = 0.0;
    int restarts = 0;
    std::int64_t samples = 0;
    bool finished = false;
    while (!finished) {
        const Stopwatch step;
        const session::StepResult result = session.step(kStep);
        longest = std::max(longest, step.seconds());
        finished = result.finished;
        if (result.samples < samples) ++restarts;
        samples = result.samples;
        most = std::max(most, residentMegabytes());
        if (first == 0.0 && (result.samples > 0 || session.progress() * kInterleave * kInterleave >= 1.0)) {
            first = watch.seconds();
            firstCpu = cpuSeconds() - cpuBefore;
            if (!settings.pictures.empty()) io::writeImage(settings.pictures + "/first.png", session.picture(), 8, {});
        }
        const auto counters = session.counters();
        const bool missing = std::any_of(counters.begin(), counters.end(), [](const auto& counter) {
            return counter.first == "bricks_missing" && counter.second > 0.0;
        });
        if (missing || first == 0.0) {
            complete = 0.0;
        } else if (complete == 0.0) {
            complete = watch.seconds();
            completeCpu = cpuSeconds() - cpuBefore;
        }
    }
    if (!settings.pictures.empty()) io::writeImage(settings.pictures + "/last.png", session.picture(), 8, {});
    fmt::print("{}: {}^3 bytes, {} MiB, {}x{} {}\n", context->capabilities().renderer, settings.edge, settings.memory,
               settings.size, settings.size, settings.renderer);
    fmt::print("seconds (of all processors): everything read once {:.1f} ({:.1f}), first picture {:.1f} ({:.1f}), all "
               "bricks {:.1f} ({:.1f}), 4 samples {:.1f} ({:.1f})\n",
               ready, readyCpu, first, firstCpu, complete, completeCpu, watch.seconds(), cpuSeconds() - cpuBefore);
    fmt::print("samples begun anew {} times; longest step {:.0f} ms\n", restarts, 1e3 * longest);
    fmt::print("resident memory: {:.0f} MB more than with a small volume, {:.0f} MB at most\n",
               residentMegabytes() - before, most - before);
    for (const auto& [name, value] : session.counters())
        fmt::print("{} {:.0f}\n", name, value);
    std::remove(settings.file.c_str());
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app{"Streams a volume that is larger than the memory for it"};
    app.add_option("--edge", settings.edge, "Voxels along each side")->check(CLI::Range(64, 4096));
    app.add_option("--memory", settings.memory, "Limit [MiB]");
    app.add_option("--size", settings.size, "Width and height of the picture [px]")->check(CLI::Range(16, 4096));
    app.add_option("--renderer", settings.renderer, "eam, mip, iso, ...");
    app.add_option("--file", settings.file, "Where the volume is put; removed at the end");
    app.add_option("--pictures", settings.pictures, "A folder for the first and the last picture");
    CLI11_PARSE(app, argc, argv);
    return bench::runAs("apeiron_stream", [&] { measure(settings); });
}
