#include "commands.hpp"

#include "core/error.hpp"
#include "io/image_file.hpp"
#include "io/layers_file.hpp"
#include "io/volume_file.hpp"
#include "scene_argument.hpp"
#include "table.hpp"
#include "terrain/flight.hpp"
#include "volume_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

// info and check: what a scene is, without a GPU.
namespace apeiron::cli {
namespace {

/// A JSON value as people write it.
std::string plain(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const Json& component : value)
        text += (text.empty() ? "" : ", ") + plain(component);
    return "(" + text + ")";
}

/// A node's type, its modules, and what else is not at its default.
std::string summary(const parameter::Node& node) {
    std::vector<std::string> parts;
    if (!node.type().name.empty()) parts.push_back(node.type().name);
    for (const parameter::Parameter& parameter : node.schema())
        if (parameter.type == parameter::Type::Module) parts.push_back(node.module(parameter.name).name);
    for (const parameter::Parameter& parameter : node.schema())
        if (parameter.type != parameter::Type::Module && node.value(parameter.name) != parameter.defaultValue)
            parts.push_back(parameter.name + " " + plain(parameter::toJson(node.value(parameter.name))));
    return parts.empty() ? "defaults" : fmt::format("{}", fmt::join(parts, ", "));
}

/// What is known of a picture's samples.
struct Samples {
    std::int64_t count = 0;
    double noise = 0.0;
    double luminance = 0.0; ///< mean over the picture
    double coverage = 0.0;  ///< mean alpha
};

Samples measure(const render::Accumulation& accumulation) {
    Samples samples;
    samples.count = accumulation.samples();
    samples.noise = accumulation.noise();
    const std::vector<float>& mean = accumulation.mean.data();
    for (std::size_t i = 0; i < mean.size(); i += 4) {
        samples.luminance += 0.2126 * static_cast<double>(mean[i]) + 0.7152 * static_cast<double>(mean[i + 1]) +
                             0.0722 * static_cast<double>(mean[i + 2]);
        samples.coverage += static_cast<double>(accumulation.spread.data()[i + 3]);
    }
    const double pixels = static_cast<double>(mean.size()) / 4.0;
    samples.luminance /= pixels;
    samples.coverage /= pixels;
    return samples;
}

const char* nameOf(io::ImageFormat format) {
    switch (format) {
    case io::ImageFormat::Png:
        return "PNG";
    case io::ImageFormat::Jpeg:
        return "JPEG";
    case io::ImageFormat::Exr:
        return "EXR";
    }
    return "";
}

Json imageJson(const std::string& file) {
    const io::ImageInfo image = io::readImageInfo(file);
    Json json = {{"format", nameOf(image.format)},
                 {"width", image.width},
                 {"height", image.height},
                 {"channels", image.channels}};
    if (image.format != io::ImageFormat::Exr) return json;
    const io::Layers layers = io::readLayers(file);
    const Samples samples = measure(layers.accumulation);
    json["samples"] = samples.count;
    json["ranges"] = Json::array();
    for (const io::SampleRange& range : layers.samples)
        json["ranges"].push_back({{"first", range.first}, {"count", range.count}});
    json["noise"] = samples.count >= 2 ? Json(samples.noise) : Json(nullptr);
    json["mean_luminance"] = samples.luminance;
    json["mean_coverage"] = samples.coverage;
    return json;
}

/// How deep the cell is that a terrain's world units are.
std::optional<std::int64_t> terrainLevel(const scene::Scene& scene) {
    const parameter::Node& subject = scene.subject;
    if (subject.type().name != "terrain") return std::nullopt;
    return std::max(static_cast<std::int64_t>(subject.text("address").size()), subject.integer("depth"));
}

void printInfo(const scene::Scene& scene, const Json& image) {
    std::vector<Row> rows{{"title", scene.title.empty() ? "(none)" : scene.title}, {"subject", summary(scene.subject)}};
    if (const auto level = terrainLevel(scene)) {
        rows.push_back({"scale", fmt::format("10^{:.1f} of the terrain's root cell, {} levels below it",
                                             terrain::scalePower(static_cast<double>(*level)), *level)});
    }
    for (const parameter::Node& slot : scene.slots)
        rows.push_back({"slot", summary(slot)});
    rows.push_back({"renderer", summary(scene.renderer)});
    rows.push_back({"camera", summary(scene.camera)});
    for (const parameter::Node& light : scene.lights)
        rows.push_back({"light", summary(light)});
    rows.push_back({"environment", summary(scene.environment)});
    rows.push_back({"post", summary(scene.post)});
    for (const parameter::Node& effect : scene.effects)
        rows.push_back({"effect", summary(effect)});
    const parameter::Node& output = scene.output;
    rows.push_back(
        {"output", fmt::format("{}x{}, {} samples, seed {}", output.integer("width"), output.integer("height"),
                               output.integer("samples"), output.integer("seed"))});
    if (!image.is_null()) {
        std::string text = fmt::format("{}, {}x{}, {} channels", plain(image["format"]), plain(image["width"]),
                                       plain(image["height"]), plain(image["channels"]));
        if (image.contains("samples"))
            text +=
                fmt::format(", {} samples, noise {}, mean luminance {:.6g}", plain(image["samples"]),
                            image["noise"].is_null() ? "unknown" : fmt::format("{:.3g}", image["noise"].get<double>()),
                            image["mean_luminance"].get<double>());
        rows.push_back({"image", text});
    }
    fmt::print("{}", alignedTable(rows));
}

bool isGalleryScene(const std::string& name) {
    const std::vector<std::string> names = galleryNames();
    return std::find(names.begin(), names.end(), name) != names.end();
}

int info(const std::string& argument, const VolumeForm& form, const VolumeQuestions& questions, bool json) {
    if (!form.raw.empty() || (!isGalleryScene(argument) && io::isVolume(argument)))
        return volumeInfo(argument, form, questions, json);
    if (!questions.at.empty() || questions.histogram)
        throw Error(ErrorKind::BadInput, "--at and --histogram ask about a volume's file, and this is none", argument);
    const scene::Scene scene = loadScene(argument);
    const Json image = io::detectImageFormat(argument) ? imageJson(argument) : Json(nullptr);
    if (json) {
        Json all = {{"file", argument}, {"image", image}, {"scene", scene.toJson(true)}};
        if (const auto level = terrainLevel(scene))
            all["scale_power"] = terrain::scalePower(static_cast<double>(*level));
        fmt::print("{}\n", all.dump(2, ' ', false, Json::error_handler_t::replace));
    } else {
        printInfo(scene, image);
    }
    return kDone;
}

/// Looks at all scenes, also behind one that is wrong.
int check(const std::vector<std::string>& scenes) {
    int code = kDone;
    for (const std::string& argument : scenes) {
        try {
            loadScene(argument);
            fmt::print("{}: ok\n", argument);
        } catch (const Error& error) {
            fmt::print(stderr, "apeiron: {}\n", error.what());
            code = kBadInput;
        }
    }
    return code;
}

} // namespace

void addInfoCommand(CLI::App& app, Action& action) {
    struct Options {
        std::string scene;
        VolumeForm form;
        VolumeQuestions questions;
        bool json = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("info", "Say what a scene, a picture or a volume is made of");
    command->footer("Examples:\n"
                    "  apeiron info out/mandelbulb.png\n"
                    "  apeiron info head.nrrd\n"
                    "  apeiron info head.nrrd --at 12.5,-40,31\n"
                    "  apeiron info head.nrrd --histogram\n"
                    "  apeiron info folder-of-dicom-files\n"
                    "  apeiron info head.raw --raw 256x256x128:uint16:big");
    command->add_option("SCENE", options->scene, std::string(kSceneHelp) + ", or a volume's file or folder")
        ->required()
        ->type_name("");
    options->form.addTo(*command);
    options->questions.addTo(*command);
    command->add_flag("--json", options->json, "Print JSON: the complete scene, and the image's figures");
    command->callback([options, &action] {
        action = [options] { return info(options->scene, options->form, options->questions, options->json); };
    });
}

void addCheckCommand(CLI::App& app, Action& action) {
    const auto scenes = std::make_shared<std::vector<std::string>>();
    CLI::App* command = app.add_subcommand("check", "Validate scenes without rendering them");
    command->footer("Example: apeiron check scenes/*.json");
    command->add_option("SCENE", *scenes, kSceneHelp)->required()->type_name("");
    command->callback([scenes, &action] { action = [scenes] { return check(*scenes); }; });
}

} // namespace apeiron::cli
