#include "commands.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "io/image_file.hpp"
#include "io/layers_file.hpp"
#include "scene_argument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace apeiron::cli {
namespace {

struct MergeOptions {
    std::vector<std::string> inputs;
    std::string output;
    bool quiet = false;
};

/// What must agree: all but which samples were taken and when to stop.
Json comparable(scene::Scene scene) {
    scene.output.set("first_sample", std::int64_t{0});
    scene.output.set("samples", std::int64_t{1});
    scene.output.set("time", 0.0);
    scene.output.set("noise", 0.0);
    scene.title.clear();
    return scene.toJson(true).flatten();
}

/// @throws Error (BadInput) that names the first parameter in which they differ.
void requireSameScene(const Json& a, const Json& b, const std::string& first, const std::string& other) {
    for (const auto& [one, two] : {std::pair(&a, &b), std::pair(&b, &a)}) {
        for (const auto& [key, value] : one->items()) {
            if (two->contains(key) && (*two)[key] == value) continue;
            throw Error(ErrorKind::BadInput, fmt::format("shows another scene than {}: {} differs", first, key), other,
                        "only parts of the same picture can be merged");
        }
    }
}

int merge(const MergeOptions& options) {
    if (io::imageFormat(options.output) != io::ImageFormat::Exr)
        throw Error(ErrorKind::BadInput, "merge writes EXR files only", options.output,
                    "merge into an .exr first, then render pictures from the whole");
    if (options.inputs.size() < 2)
        throw Error(ErrorKind::BadInput, "merge needs at least two files", {}, "see 'apeiron merge --help'");
    requireWritable(options.output);

    const std::string& first = options.inputs.front();
    io::Layers all = io::readLayers(first);
    scene::Scene scene = parseScene(first, all.scene);
    const Json expected = comparable(scene);
    for (std::size_t i = 1; i < options.inputs.size(); ++i) {
        const std::string& file = options.inputs[i];
        const io::Layers part = io::readLayers(file);
        requireSameScene(expected, comparable(parseScene(file, part.scene)), first, file);
        try {
            all.samples = io::joined(all.samples, part.samples);
            all.accumulation.merge(part.accumulation);
        } catch (const Error& error) {
            throw error.at(file);
        }
    }
    scene.output.set("first_sample", all.samples.front().first);
    scene.output.set("samples", all.accumulation.samples());
    io::writeLayers(options.output, all.accumulation, scene.toJson(), all.samples);
    if (!options.quiet)
        fmt::print("{}  {}x{}, {} samples of {} files\n", options.output, all.accumulation.mean.width(),
                   all.accumulation.mean.height(), all.accumulation.samples(), options.inputs.size());
    return kDone;
}

} // namespace

void addMergeCommand(CLI::App& app, Action& action) {
    const auto options = std::make_shared<MergeOptions>();
    CLI::App* command = app.add_subcommand("merge", "Merge parts of one picture that were rendered apart");
    command->footer("Example, on two machines and then on one:\n"
                    "  apeiron render scene.json -o a.exr --samples 64\n"
                    "  apeiron render scene.json -o b.exr --samples 64 --first-sample 64\n"
                    "  apeiron merge a.exr b.exr -o whole.exr");
    command->add_option("FILE", options->inputs, "EXR files by 'apeiron render'")->required()->type_name("");
    command->add_option("-o,--output", options->output, "The EXR file to write")->required()->type_name("FILE");
    command->add_flag("-q,--quiet", options->quiet, "Print errors only");
    command->callback([options, &action] { action = [options] { return merge(*options); }; });
}

} // namespace apeiron::cli
