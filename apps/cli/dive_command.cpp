#include "commands.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "core/suggest.hpp"
#include "interrupt.hpp"
#include "io/image_file.hpp"
#include "options.hpp"
#include "scene_argument.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

namespace apeiron::cli {
namespace {

constexpr const char* kDiveExamples =
    "Examples:\n"
    "  apeiron terrain dive terrain_range -o 'frames/%04d.png' --frames 300 --size 1280x720 --samples 8\n"
    "  apeiron terrain dive terrain_range -o 'up/%04d.png' --frames 90 --up --set subject.depth=3000\n"
    "  ffmpeg -framerate 30 -i 'frames/%04d.png' -crf 18 dive.mp4\n\n"
    "Every picture holds the scene that it shows. Frames are --speed / --fps distances to the ground apart.";

struct DiveOptions {
    std::string scene;
    std::string output;
    SceneOptions edits;
    DeviceOptions device;
    std::string frames = "60";
    std::string levels;
    std::string fps = "30";
    std::string speed = "1";
    bool up = false;
    bool quiet = false;
};

/// File names with a number in them.
class Pattern {
  public:
    /// @throws Error (BadInput) for one without exactly one %d or %04d.
    explicit Pattern(const std::string& text) {
        const std::size_t percent = text.find('%');
        const std::size_t end = percent == std::string::npos ? percent : text.find('d', percent);
        const std::string digits = end == std::string::npos ? "x" : text.substr(percent + 1, end - percent - 1);
        const bool good = digits.size() <= 2 && digits.find_first_not_of("0123456789") == std::string::npos &&
                          (digits.empty() || digits.front() == '0') && text.find('%', percent + 1) == std::string::npos;
        if (!good)
            throw Error(ErrorKind::BadInput, "expected a file name with a place for the number, got " + inQuotes(text),
                        "-o", "such as 'frames/%04d.png'");
        before_ = text.substr(0, percent);
        after_ = text.substr(end + 1);
        width_ = digits.empty() ? 0 : digits.back() - '0';
    }
    std::string file(std::int64_t number) const { return fmt::format("{}{:0{}}{}", before_, number, width_, after_); }

  private:
    std::string before_;
    std::string after_;
    int width_ = 0;
};

int dive(const DiveOptions& options) {
    const Pattern pattern(options.output);
    const std::int64_t frames = wholeNumber("--frames", options.frames, 1, 1'000'000);
    const double levels =
        options.levels.empty() ? std::numeric_limits<double>::infinity() : positiveNumber("--levels", options.levels);
    const double seconds = 1.0 / positiveNumber("--fps", options.fps);
    const double speed = positiveNumber("--speed", options.speed);
    scene::Scene scene = loadScene(options.scene);
    options.edits.apply(scene);
    const io::ImageFormat format = io::imageFormat(pattern.file(0));
    if (format == io::ImageFormat::Exr) throw Error(ErrorKind::BadInput, "frames are .png or .jpg, not .exr", "-o");
    requireWritable(pattern.file(0));
    if (scene.subject.type().name != "terrain")
        throw Error(ErrorKind::BadInput,
                    "only terrain has an autopilot, and this scene shows " + inQuotes(scene.subject.type().name),
                    options.scene);
    // Every picture is a finished one.
    scene.subject.set("background", false);

    const auto context = gpu::Context::create(options.device.context());
    session::Options sessionOptions;
    sessionOptions.stage = options.device.chosenStage();
    sessionOptions.reproject = false;
    const Interrupt interrupt;
    session::Session session(*context, std::move(scene), sessionOptions);
    const auto way = options.up ? render::Autopilot::Rise : render::Autopilot::Dive;
    constexpr double kBudget = 0.1; // of a step, after which Ctrl-C is looked at [s]
    const double start = session.scalePower().value_or(0.0);
    double scale = start;
    std::int64_t frame = 0;
    for (; frame < frames && std::abs(scale - start) < levels * std::log10(2.0); ++frame) {
        if (frame > 0 && !session.autopilot(way, speed, seconds)) break;
        while (!interrupt.requested() && !session.step(kBudget).finished) {
        }
        if (interrupt.requested()) break;
        scale = session.scalePower().value_or(0.0);
        const std::string file = pattern.file(frame);
        io::writeImage(file, session.picture(io::stepSize(format, 8)), 8, session.scene().toJson());
        if (!options.quiet) fmt::print("{}  scale 10^{:.2f}\n", file, scale);
    }
    if (interrupt.requested()) {
        fmt::print(stderr, "apeiron: interrupted after {} of {} frames\n", frame, frames);
        return kInterrupted;
    }
    return kDone;
}

} // namespace

void addDiveCommand(CLI::App& terrain, Action& action) {
    const auto options = std::make_shared<DiveOptions>();
    CLI::App* command = terrain.add_subcommand("dive", "Render the frames of a flight on autopilot, into the terrain");
    command->footer(kDiveExamples);
    command->add_option("SCENE", options->scene, kSceneHelp)->required()->type_name("");
    command->add_option("-o,--output", options->output, "Files to write, with a place for the frame's number: %04d")
        ->required()
        ->type_name("PATTERN");
    options->edits.addTo(*command);
    command->add_option("--frames", options->frames, "Most frames to write")->type_name("N");
    command->add_option("--levels", options->levels, "End when the scale has halved (or doubled) so often")
        ->type_name("N");
    command->add_option("--fps", options->fps, "Frames per second of flight")->type_name("RATE");
    command->add_option("--speed", options->speed, "Distances to the ground per second")->type_name("SPEED");
    command->add_flag("--up", options->up, "Rise instead, out of the terrain");
    options->device.addTo(*command);
    command->add_flag("-q,--quiet", options->quiet, "Print errors only");
    command->callback([options, &action] { action = [options] { return dive(*options); }; });
}

} // namespace apeiron::cli
