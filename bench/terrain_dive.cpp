// A dive of thousands of levels into terrain and the way back, in pictures: how long does every frame take, does memory
// stay flat, is the picture never a wall, fog or a plain, and is that of the start there again after the return?
//
//     apeiron_dive [SCENE.json] [--levels N] [--stretches N] [--frames N] [--width W] [--height H] [--dump FOLDER]
//                  [--turn DEGREES] [--set subject.background=false ...]
//
// All steps of the flight are made. Frames are drawn in stretches of consecutive steps, spread evenly over the way.

#include "bench_support.hpp"
#include "core/file.hpp"
#include "core/stopwatch.hpp"
#include "io/image_file.hpp"
#include "session/session.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <unistd.h>
#include <utility>

namespace {

using namespace apeiron;
using bench::percentile;

struct Settings {
    std::string scene = APEIRON_SOURCE_DIR "/scenes/terrain_range.json";
    int width = 640;
    int height = 360;
    int levels = 3400;
    int stretches = 10; ///< down, and half as many up
    int frames = 40;    ///< of a stretch
    double speed = 1.2; ///< [distances to the ground per second]
    double turn = 0.0;  ///< frames look around instead of flying [degrees a frame]
    std::vector<std::string> set;
    std::string dump;
};

/// A frame of a flight at 30 frames a second.
constexpr double kFrameSeconds = 1.0 / 30.0;

/// Processor time of all threads of this process [s].
double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Resident memory of this process [bytes].
double residentMemory() {
    std::ifstream file("/proc/self/statm");
    std::size_t total = 0;
    std::size_t resident = 0;
    file >> total >> resident;
    return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void printRow(const char* what, std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const double median = percentile(values, 0.5);
    fmt::print("| {} | {:.3g} | {:.3g} | {:.3g} | {:.2f} | {:.2f} |\n", what, median, percentile(values, 0.99),
               values.back(), percentile(values, 0.99) / median, values.back() / median);
}

struct Look {
    double sky = 0.0;      ///< share of the picture
    double gradient = 0.0; ///< mean difference of neighbouring pixels of the finished picture, in 255ths
    double brightness = 0.0;
};

Look lookAt(session::Session& session, const Image<float>& picture) {
    Look look;
    const Image<float> albedo = session.layers().albedo;
    const auto width = static_cast<std::size_t>(picture.width());
    const auto height = static_cast<std::size_t>(picture.height());
    const auto at = [&](std::size_t x, std::size_t y) {
        const float* p = &picture.data()[4 * (y * width + x)];
        return (static_cast<double>(p[0]) + static_cast<double>(p[1]) + static_cast<double>(p[2])) / 3.0;
    };
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            look.sky += albedo.data()[4 * (y * width + x) + 3] > 0.5F ? 0.0 : 1.0;
            look.brightness += at(x, y);
            if (x > 0 && y > 0) look.gradient += std::hypot(at(x, y) - at(x - 1, y), at(x, y) - at(x, y - 1));
        }
    }
    const double pixels = static_cast<double>(width) * static_cast<double>(height);
    look.sky /= pixels;
    look.brightness /= pixels;
    look.gradient *= 255.0 / pixels;
    return look;
}

double counter(const session::Session& session, std::string_view name) {
    for (const auto& [counted, value] : session.counters()) {
        if (counted == name) return value;
    }
    return 0.0;
}

std::int64_t levelOf(const session::Session& session) {
    const parameter::Node& subject = session.scene().subject;
    return std::max<std::int64_t>(static_cast<std::int64_t>(subject.text("address").size()), subject.integer("depth"));
}

/// What was measured of all frames.
struct Frames {
    std::vector<double> wall;
    std::vector<double> processor;
    std::vector<double> drawing;
    std::vector<double> behind;
    std::vector<double> selection;
    std::vector<double> making;
    std::vector<double> clipmap;
    std::vector<double> drawn;
    std::vector<double> made;
    std::vector<double> late;
    std::vector<Look> looks;
};

class Dive {
  public:
    Dive(const gpu::Context& context, scene::Scene scene, Settings settings)
        : settings_(std::move(settings)), session_(context, std::move(scene), options()) {}

    /// The whole picture: every tile that it needs, and one sample.
    Image<float> still() {
        while (!session_.step(10.0).finished) {
        }
        return session_.picture();
    }

    void stretch(render::Autopilot way) {
        // It begins with all that its first picture needs, as a frame in the midst of a flight does.
        still();
        for (int i = 0; i < settings_.frames; ++i)
            frame(way, i);
        frames_.looks.push_back(lookAt(session_, session_.picture()));
        memory_.push_back(residentMemory());
        levels_.push_back(levelOf(session_));
    }

    /// Flies without drawing, until the level is reached.
    void skip(render::Autopilot way, std::int64_t level) {
        const bool down = way == render::Autopilot::Dive;
        for (int i = 0; i < 100'000 && (down ? levelOf(session_) < level : levelOf(session_) > level); ++i)
            session_.autopilot(way, 1.0, 5.0);
    }

    session::Session& session() { return session_; }
    const Frames& frames() const { return frames_; }
    const std::vector<double>& memory() const { return memory_; }
    const std::vector<std::int64_t>& levels() const { return levels_; }

  private:
    static session::Options options() {
        session::Options options;
        options.reproject = false; // every frame is a whole new picture
        return options;
    }

    /// Of drawing tiles, so far [ms of processor time].
    double drawingTime() const {
        const auto& times = session_.statistics().phases.times;
        const auto found = times.find("draw");
        return found == times.end() ? 0.0 : found->second.cpuMs;
    }

    void frame(render::Autopilot way, int index) {
        const double processor = processorSeconds();
        const double drawing = drawingTime();
        const Stopwatch watch;
        if (settings_.turn == 0.0) {
            session_.autopilot(way, settings_.speed, kFrameSeconds);
        } else {
            scene::Camera camera = session_.camera();
            camera.look(glm::radians(settings_.turn), 0.0, 0.0);
            session_.setCamera(camera);
        }
        while (session_.samples() == 0)
            session_.step(10.0);
        const Image<float> picture = session_.picture(1.0 / 255.0);
        const double wall = watch.seconds();
        if (!settings_.dump.empty() && index % 4 == 0)
            io::writeImage(fmt::format("{}/dive_{:04}.png", settings_.dump, dumped_++), picture, 8, {});
        frames_.wall.push_back(1e3 * wall);
        frames_.processor.push_back(1e3 * (processorSeconds() - processor));
        frames_.drawing.push_back(drawingTime() - drawing);
        frames_.behind.push_back(counter(session_, "tiles in the background"));
        frames_.selection.push_back(counter(session_, "selection [ms]"));
        frames_.making.push_back(counter(session_, "tile making [ms]"));
        frames_.clipmap.push_back(counter(session_, "clipmap [ms]"));
        frames_.drawn.push_back(counter(session_, "tiles drawn"));
        frames_.made.push_back(counter(session_, "tiles made"));
        frames_.late.push_back(counter(session_, "tiles missing"));
    }

    Settings settings_;
    session::Session session_;
    Frames frames_;
    std::vector<double> memory_;
    std::vector<std::int64_t> levels_;
    int dumped_ = 0;
};

void run(const Settings& settings) {
    const auto context = gpu::Context::create();
    scene::Scene scene = scene::Scene::parse(session::catalogue(), settings.scene, readFile(settings.scene));
    scene.set("output.width", std::to_string(settings.width));
    scene.set("output.height", std::to_string(settings.height));
    scene.set("output.samples", std::string_view("1"));
    for (const std::string& edit : settings.set) {
        const std::size_t equals = edit.find('=');
        if (equals == std::string::npos) throw Error(ErrorKind::BadInput, "--set takes PATH=VALUE", edit);
        scene.set(edit.substr(0, equals), std::string_view(edit).substr(equals + 1));
    }
    const Stopwatch all;
    Dive dive(*context, scene, settings);
    const Image<float> start = dive.still();
    const std::int64_t top = levelOf(dive.session());
    for (int i = 0; i < settings.stretches; ++i) {
        dive.stretch(render::Autopilot::Dive);
        dive.skip(render::Autopilot::Dive,
                  top + static_cast<std::int64_t>(settings.levels) * (i + 1) / settings.stretches);
    }
    const std::int64_t bottom = levelOf(dive.session());
    const int up = std::max(1, settings.stretches / 2);
    for (int i = 0; i < up; ++i) {
        dive.stretch(render::Autopilot::Rise);
        dive.skip(render::Autopilot::Rise, bottom - (bottom - top) * (i + 1) / up);
    }
    dive.session().setScene(scene);
    const Image<float> again = dive.still();
    const Frames& frames = dive.frames();

    fmt::print("{} at {} x {} on {}: {} levels down (10^{:.0f}) and up again in {:.0f} s, {} frames measured\n\n",
               settings.scene, settings.width, settings.height, context->capabilities().renderer, bottom - top,
               -static_cast<double>(bottom - top) * std::log10(2.0), all.seconds(), frames.wall.size());
    fmt::print(
        "| of a frame | median | 99 % | longest | 99 % / median | longest / median |\n|---|---|---|---|---|---|\n");
    printRow("wall time, ms", frames.wall);
    printRow("processor time, ms", frames.processor);
    printRow("drawing, ms of processor", frames.drawing);
    // Of frames that show it alone: it takes a while until the first cube is complete.
    std::vector<double> shownProcessor;
    std::vector<double> shownDrawing;
    for (std::size_t i = 0; i < frames.behind.size(); ++i) {
        if (frames.behind[i] <= 0.0) continue;
        shownProcessor.push_back(frames.processor[i]);
        shownDrawing.push_back(frames.drawing[i]);
    }
    if (!shownDrawing.empty()) {
        fmt::print("| {} of {} frames with a background: | | | | | |\n", shownDrawing.size(), frames.behind.size());
        printRow("- processor time, ms", shownProcessor);
        printRow("- drawing, ms of processor", shownDrawing);
    }
    printRow("selection, ms", frames.selection);
    printRow("tiles and prefetching, ms", frames.making);
    printRow("clipmap, ms", frames.clipmap);
    printRow("tiles drawn", frames.drawn);
    printRow("tiles made", frames.made);
    printRow("tiles late", frames.late);
    fmt::print("\n| level | resident, MiB | sky, % | gradient, /255 | brightness |\n|---|---|---|---|---|\n");
    for (std::size_t i = 0; i < frames.looks.size(); ++i) {
        const Look& look = frames.looks[i];
        fmt::print("| {} | {:.1f} | {:.0f} | {:.2f} | {:.2f} |\n", dive.levels()[i],
                   dive.memory()[i] / (1024.0 * 1024.0), 100.0 * look.sky, look.gradient, look.brightness);
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < start.data().size(); ++i)
        different += start.data()[i] == again.data()[i] ? 0 : 1;
    fmt::print(
        "\nResident memory at the end / after the first stretch: {:.3f}. Picture of the start after the return: {}.\n",
        dive.memory().back() / dive.memory().front(),
        different == 0 ? "identical" : fmt::format("{} of {} values differ", different, start.data().size()));
    fmt::print("Tiles cached: {:.0f} of room for {:.0f}, generated {:.0f}, of these prefetched {:.0f}.\n",
               counter(dive.session(), "tiles cached"), counter(dive.session(), "tiles' room"),
               counter(dive.session(), "tiles generated"), counter(dive.session(), "tiles prefetched"));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("A dive of thousands of levels into terrain and the way back: frame times, memory, pictures");
    app.add_option("scene", settings.scene, "Scene document");
    app.add_option("--width", settings.width);
    app.add_option("--height", settings.height);
    app.add_option("--levels", settings.levels, "How deep");
    app.add_option("--stretches", settings.stretches, "Parts of the way down in which frames are drawn")
        ->check(CLI::Range(1, 1000));
    app.add_option("--frames", settings.frames, "Of a stretch")->check(CLI::Range(4, 100000));
    app.add_option("--speed", settings.speed, "Distances to the ground per second");
    app.add_option("--turn", settings.turn, "Frames look around instead of flying, by so many degrees each");
    app.add_option("--set", settings.set, "PATH=VALUE of the scene");
    app.add_option("--dump", settings.dump, "Folder for every fourth frame");
    CLI11_PARSE(app, argc, argv);
    return bench::runAs("apeiron_dive", [&] { run(settings); });
}
