// A camera that moves around the subject for a while and then stops: does every step keep to its budget, is there a
// whole picture in every frame, and when is the still one converged?
//
//     apeiron_motion [SCENE.json] [--width W] [--height H] [--frames N] [--budget MS] [--dump FOLDER]

#include "bench_support.hpp"
#include "core/file.hpp"
#include "core/stopwatch.hpp"
#include "io/image_file.hpp"
#include "session/session.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace apeiron;
using bench::percentile;
using bench::psnr;

struct Settings {
    std::string scene = APEIRON_SOURCE_DIR "/bench/motion.json";
    int width = 1280;
    int height = 720;
    int frames = 120;
    double budgetMs = 33.0;
    int interleave = 8;
    bool reproject = true;
    std::string dump;
};

void printTimes(const char* what, std::vector<double> milliseconds) {
    std::sort(milliseconds.begin(), milliseconds.end());
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} |\n", what, percentile(milliseconds, 0.5),
               percentile(milliseconds, 0.99), milliseconds.back());
}

void run(const Settings& settings) {
    const auto context = gpu::Context::create();
    scene::Scene scene = scene::Scene::parse(session::catalogue(), settings.scene, readFile(settings.scene));
    scene.set("output.width", std::to_string(settings.width));
    scene.set("output.height", std::to_string(settings.height));
    scene.set("output.samples", std::string_view("100000"));
    session::Options options;
    options.interleave = settings.interleave;
    options.reproject = settings.reproject;
    session::Session session(*context, scene, options);
    while (session.samples() == 0)
        session.step(1e-3 * settings.budgetMs);
    session.picture(); // a front end has shown it before anything moves

    std::vector<double> steps;
    std::vector<double> shows;
    std::vector<double> fresh;
    for (int frame = 0; frame < settings.frames; ++frame) {
        scene::Camera camera = session.camera();
        camera.orbit(glm::radians(1.0), 0.0);
        const Stopwatch moving;
        session.setCamera(camera);
        session.step(1e-3 * settings.budgetMs - moving.seconds());
        steps.push_back(1e3 * moving.seconds());
        fresh.push_back(session.samples() > 0 ? 1.0 : session.progress());
        const Stopwatch showing;
        const Image<float> picture = session.picture(1.0 / 255.0);
        shows.push_back(1e3 * showing.seconds());
        if (!settings.dump.empty())
            io::writeImage(fmt::format("{}/frame_{:03}.png", settings.dump, frame), picture, 8, {});
    }
    std::sort(fresh.begin(), fresh.end());
    fmt::print("{} at {} x {} on {}, {} frames, budget {} ms, interleave {}\n\n", settings.scene, settings.width,
               settings.height, context->capabilities().renderer, settings.frames, settings.budgetMs,
               settings.interleave);
    fmt::print("| ms | median | 99 % | longest |\n|---|---|---|---|\n");
    printTimes("move and step", steps);
    printTimes("show (present, post, read back)", shows);
    const auto& phases = session.statistics().phases.times;
    const auto mean = [&](const char* name) {
        const auto& times = phases.at(name);
        return fmt::format("{} {:.1f} ms ({:.1f} CPU ms)", name, times.wallMs / (settings.frames + 1),
                           times.cpuMs / (settings.frames + 1));
    };
    fmt::print("\nOf showing, on average: {}, {}, {}.", mean("present"), mean("post"), mean("read"));
    fmt::print(" New pixels per frame: {:.1f} % (median)\n", 100.0 * percentile(fresh, 0.5));
    std::fflush(stdout);

    // The camera has stopped.
    struct Look {
        double seconds;
        std::int64_t samples;
        double noise;
        Image<float> picture;
    };
    std::vector<Look> looks;
    double seconds = 0.0;
    for (const double until : {0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0}) {
        while (seconds < until) {
            const Stopwatch watch;
            session.step(0.1);
            seconds += watch.seconds();
        }
        looks.push_back({seconds, session.samples(), session.noise(), session.picture()});
    }
    while (session.samples() < 128)
        session.step(1.0);
    const Image<float> reference = session.picture();
    fmt::print("\n| after the stop, s | samples | noise, % | PSNR against 128 samples, dB |\n|---|---|---|---|\n");
    for (const Look& look : looks) {
        fmt::print("| {:.2f} | {} | {:.2f} | {:.1f} |\n", look.seconds, look.samples, 100.0 * look.noise,
                   psnr(look.picture, reference));
    }
    if (!settings.dump.empty()) io::writeImage(settings.dump + "/still_5s.png", looks.back().picture, 8, {});
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("A moving camera: step times, and how soon the still picture is converged");
    app.add_option("scene", settings.scene, "Scene document");
    app.add_option("--width", settings.width);
    app.add_option("--height", settings.height);
    app.add_option("--frames", settings.frames);
    app.add_option("--budget", settings.budgetMs, "Of a step [ms]");
    app.add_option("--interleave", settings.interleave);
    app.add_flag("!--no-reproject", settings.reproject);
    app.add_option("--dump", settings.dump, "Folder for the frames");
    CLI11_PARSE(app, argc, argv);
    return bench::runAs("apeiron_motion", [&] { run(settings); });
}
