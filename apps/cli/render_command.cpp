#include "core/error.hpp"
#include "core/file.hpp"
#include "core/suggest.hpp"
#include "interrupt.hpp"
#include "io/image_file.hpp"
#include "io/layers_file.hpp"
#include "options.hpp"
#include "parameter/text.hpp"
#include "progress_bar.hpp"
#include "scene_argument.hpp"
#include "statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

namespace apeiron::cli {
namespace {

constexpr const char* kRenderExamples =
    "Examples:\n"
    "  apeiron render mandelbulb -o bulb.png --size 1280x720 --samples 128\n"
    "  apeiron render scene.json -o picture.png -o negative.exr --time 60\n"
    "  apeiron render bulb.png -o again.png --set subject.power=9\n"
    "  apeiron render scene.json -o part2.exr --samples 64 --first-sample 64\n\n"
    "Ctrl-C saves what there is. In --stats, samples_per_second counts single pixels' samples.";

struct RenderOptions {
    std::string scene;
    std::vector<std::string> outputs;
    SceneOptions edits;
    DeviceOptions device;
    std::string bits = "8";
    std::string tile;
    std::string budget = "100";
    std::optional<std::string> focus;
    std::optional<std::string> stats;
    bool quiet = false;
};

/// The options' values once they are known to be right.
struct Plan {
    int bits = 8;
    double budget = 0.1; ///< of one step [s]
    session::Options session;
    gpu::ContextOptions context;
};

Plan makePlan(const RenderOptions& options) {
    Plan plan;
    if (options.bits != "8" && options.bits != "16")
        throw Error(ErrorKind::BadInput, "expected 8 or 16, got " + inQuotes(options.bits), "--bits");
    plan.bits = options.bits == "16" ? 16 : 8;
    plan.budget = 1e-3 * positiveNumber("--budget", options.budget);
    plan.context = options.device.context();
    plan.session.stage = options.device.chosenStage();
    plan.session.wholeData = true; // what would come of a part of it is not looked at
    if (!options.tile.empty()) plan.session.tilePixels = wholeNumber("--tile", options.tile, 1, std::int64_t{1} << 40);
    return plan;
}

void requireOutputs(const RenderOptions& options) {
    for (const std::string& output : options.outputs) {
        io::imageFormat(output);
        requireWritable(output);
    }
    if (options.stats) requireWritable(*options.stats);
}

/// Works until the scene's goal is reached. @returns false when it was interrupted.
bool renderUntilDone(session::Session& session, const Plan& plan, const Interrupt& interrupt, ProgressBar& bar) {
    const parameter::Node& output = session.scene().output;
    const auto most = static_cast<std::int64_t>(output.schema().at("samples").maximum.value());
    Progress progress;
    progress.total = output.integer("samples") < most ? output.integer("samples") : 0;
    progress.timeLimit = output.number("time");
    const Stopwatch watch;
    while (!session.step(plan.budget).finished) {
        if (interrupt.requested()) return false;
        progress.samples = static_cast<double>(session.samples()) + session.progress();
        progress.seconds = watch.seconds();
        bar.update(progress);
    }
    return true;
}

/// The document that gives this very picture again.
Json sceneOfPicture(const session::Session& session) {
    scene::Scene scene = session.scene();
    if (session.samples() > 0) {
        scene.output.set("samples", session.samples());
        scene.output.set("time", 0.0);
        scene.output.set("noise", 0.0);
    }
    return scene.toJson();
}

/// Writes the outputs, reading back from the GPU only what they need and only once.
class Writer {
  public:
    Writer(session::Session& session, Phases& phases, int bits)
        : session_(session), phases_(phases), bits_(bits), scene_(sceneOfPicture(session)) {}

    void write(const std::string& file) {
        const io::ImageFormat format = io::imageFormat(file);
        if (format == io::ImageFormat::Exr) {
            const render::Accumulation& samples = accumulation();
            const Phases::Scope scope(phases_, "write");
            const std::int64_t first = session_.scene().output.integer("first_sample");
            io::writeLayers(file, samples, scene_, {{first, session_.samples()}});
        } else {
            const Image<float>& image = picture(io::stepSize(format, bits_));
            const Phases::Scope scope(phases_, "write");
            io::writeImage(file, image, bits_, scene_);
        }
    }

    const render::Accumulation& accumulation() {
        if (!accumulation_) {
            const Phases::Scope scope(phases_, "read");
            accumulation_ = session_.accumulation();
        }
        return *accumulation_;
    }

  private:
    const Image<float>& picture(double dither) {
        const auto found = pictures_.find(dither);
        return found != pictures_.end() ? found->second : pictures_[dither] = session_.picture(dither);
    }

    session::Session& session_;
    Phases& phases_;
    int bits_;
    Json scene_;
    std::map<double, Image<float>> pictures_; ///< by size of the dither
    std::optional<render::Accumulation> accumulation_;
};

/// A place in the picture: "640,360" in pixels, or "0.5,0.25" as parts of its size, from the top left.
glm::ivec2 pixelOf(const std::string& text, glm::ivec2 size) {
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorKind::BadInput, what, "--focus",
                    "pixels from the top left such as 640,360, or parts of the picture such as 0.5,0.5");
    };
    const std::size_t comma = text.find(',');
    const std::array<std::string, 2> parts{text.substr(0, comma),
                                           comma == std::string::npos ? "" : text.substr(comma + 1)};
    const bool fraction = text.find('.') != std::string::npos;
    glm::ivec2 pixel(0);
    for (int i = 0; i < 2; ++i) {
        const std::optional<double> number = parameter::parseNumber(parts[static_cast<std::size_t>(i)]);
        if (!number) fail("expected X,Y, got " + inQuotes(text));
        const double place = fraction ? *number * size[i] : *number;
        if (place < 0.0 || place > size[i] || (!fraction && place >= size[i]))
            fail(fmt::format("{} is outside the picture of {}x{}", text, size.x, size.y));
        pixel[i] = std::min(static_cast<int>(place), size[i] - 1);
    }
    return pixel;
}

bool hasDepthOfField(const scene::Scene& scene) {
    return scene.camera.number("aperture") > 0.0 ||
           std::any_of(scene.effects.begin(), scene.effects.end(), [](const parameter::Node& effect) {
               return effect.flag("enabled") && effect.module("type").name == "depth_of_field";
           });
}

/// Puts the focus on what is seen at a place of the picture, by one sample of a pinhole: a lens would blur the
/// distance.
void focusOn(session::Session& session, const std::string& place, double budget) {
    const glm::ivec2 pixel = pixelOf(place, session.size());
    const parameter::Value aperture = session.scene().camera.value("aperture");
    const auto setAperture = [&](const parameter::Value& value) {
        parameter::Node node = session.scene().camera;
        node.set("aperture", value);
        session.setCamera(scene::Camera(node));
    };
    setAperture(0.0);
    while (session.samples() == 0 && !session.step(budget).finished) {
    }
    if (!session.focusAt(pixel))
        throw Error(ErrorKind::BadInput,
                    fmt::format("there is nothing but background at pixel {},{}", pixel.x, pixel.y), "--focus",
                    "name a place where a surface is seen");
    setAperture(aperture);
}

/// What an interrupted rendering can still save.
bool canSave(const session::Session& session, const std::string& file, bool coarse) {
    return session.samples() > 0 || (coarse && io::imageFormat(file) != io::ImageFormat::Exr);
}

std::string samplesText(std::int64_t samples) {
    return fmt::format("{} sample{}", samples, samples == 1 ? "" : "s");
}

int render(const RenderOptions& options) {
    const Plan plan = makePlan(options);
    scene::Scene scene = loadScene(options.scene);
    options.edits.apply(scene);
    requireOutputs(options);
    if (options.focus && !hasDepthOfField(scene))
        throw Error(ErrorKind::BadInput, "a pinhole camera has no focus", "--focus",
                    "set camera.aperture, such as 0.05, or add the effect depth_of_field");

    Phases phases;
    phases.times["start"] = timeSinceStart();
    std::unique_ptr<gpu::Context> context;
    {
        const Phases::Scope scope(phases, "context");
        context = gpu::Context::create(plan.context);
    }
    const std::int64_t wanted = scene.output.integer("samples");
    session::Options sessionOptions = plan.session;
    // A coarse picture first, for who interrupts a long rendering; short ones are faster without.
    constexpr int kCoarse = 4;
    if (wanted > 8) sessionOptions.interleave = kCoarse;
    sessionOptions.reproject = false; // nothing moves
    const Interrupt interrupt;
    session::Session session(*context, std::move(scene), sessionOptions);
    if (options.focus) focusOn(session, *options.focus, plan.budget);

    if (!options.quiet)
        for (const std::string& note : session.notes())
            fmt::print(stderr, "apeiron: note: {}\n", note);

    const Stopwatch watch;
    bool complete = false;
    {
        ProgressBar bar(options.quiet);
        complete = renderUntilDone(session, plan, interrupt, bar);
    }
    const double renderSeconds = watch.seconds();

    // Without a whole sample there may be a coarse picture, of at least one sub-image.
    const bool coarse = session.progress() * sessionOptions.interleave * sessionOptions.interleave >= 1.0 &&
                        sessionOptions.interleave > 1;
    Writer writer(session, phases, plan.bits);
    std::vector<std::string> saved;
    for (const std::string& file : options.outputs) {
        if (!complete && !canSave(session, file, coarse)) continue;
        writer.write(file);
        saved.push_back(file);
        if (options.quiet) continue;
        fmt::print("{}  {}x{}, {}, {:.1f} s on {}\n", file, session.size().x, session.size().y,
                   session.samples() > 0 ? samplesText(session.samples()) : "a coarse first picture", renderSeconds,
                   context->capabilities().renderer);
    }
    if (options.stats) {
        const double noise = session.samples() >= 2 ? writer.accumulation().noise() : 0.0;
        const Json stats = toJson(Measured{session, sum(phases, session.statistics().phases), renderSeconds,
                                           1e-3 * timeSinceStart().wallMs, noise});
        writeFile(*options.stats, stats.dump(2) + "\n");
    }
    if (!options.quiet && session.samples() > 0) {
        const std::string reason = session.emptyReason();
        if (!reason.empty()) fmt::print(stderr, "apeiron: {}\n", reason);
    }
    if (complete) return kDone;
    fmt::print(stderr, "apeiron: interrupted after {} of {}; {}\n", session.samples(), samplesText(wanted),
               saved.empty() ? "nothing to save yet" : fmt::format("saved {}", fmt::join(saved, ", ")));
    return kInterrupted;
}

} // namespace

void addRenderCommand(CLI::App& app, Action& action) {
    const auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render a scene into image files");
    command->footer(kRenderExamples);
    command->add_option("SCENE", options->scene, kSceneHelp)->required()->type_name("");
    command
        ->add_option("-o,--output", options->outputs,
                     "A file to write, by extension: .png, .jpg, .exr (float layers and all samples); repeatable")
        ->required()
        ->type_name("FILE")
        ->allow_extra_args(false);
    options->edits.addTo(*command);
    command
        ->add_option("--focus", options->focus,
                     "Focus on what is seen there: pixels from the top left, or parts of the picture such as 0.5,0.5")
        ->type_name("X,Y");
    command->add_option("--bits", options->bits, "Bits per channel of PNG: 8 or 16")->type_name("BITS");
    options->device.addTo(*command);
    command->add_option("--tile", options->tile, "Most pixels to submit to the GPU at once")->type_name("PIXELS");
    command->add_option("--budget", options->budget, "Time of one step, after which Ctrl-C is looked at")
        ->type_name("MS");
    command->add_option("--stats", options->stats, "Write what it took, as JSON")->type_name("FILE");
    command->add_flag("-q,--quiet", options->quiet, "Print errors only");
    command->callback([options, &action] { action = [options] { return render(*options); }; });
}

} // namespace apeiron::cli
