#include "options.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "parameter/text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

namespace apeiron::cli {
namespace {

void set(parameter::Node& node, const char* parameter, const std::string& text, const std::string& option) {
    try {
        node.setFromText(parameter, text);
    } catch (const Error& error) {
        throw error.at(option);
    }
}

bool isWhole(std::string_view text) {
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// @param text a number of bytes such as 800000, 64K, 256M or 2G, of which a K is 1024
void setMemory(parameter::Node& subject, const std::string& text) {
    if (subject.schema().find("memory") == nullptr)
        throw Error(ErrorKind::BadInput, "a " + subject.type().name + " has no limit of memory", "--memory");
    const std::string units = "KMG";
    const std::size_t unit = text.empty() ? std::string::npos : units.find(text.back());
    const bool none = unit == std::string::npos;
    const std::optional<double> number = parameter::parseNumber(none ? text : text.substr(0, text.size() - 1));
    if (!number || !(*number > 0.0))
        throw Error(ErrorKind::BadInput, "expected a number of bytes such as 256M or 2G, got " + inQuotes(text),
                    "--memory");
    const double mebibytes = std::ldexp(*number, none ? -20 : 10 * static_cast<int>(unit) - 10);
    set(subject, "memory", fmt::format("{}", mebibytes), "--memory [MiB]");
}

void setSize(parameter::Node& output, const std::string& text) {
    const std::size_t x = text.find('x');
    const std::string width = text.substr(0, x);
    const std::string height = x == std::string::npos ? "" : text.substr(x + 1);
    if (!isWhole(width) || !isWhole(height))
        throw Error(ErrorKind::BadInput, "expected WIDTHxHEIGHT such as 1280x720, got " + inQuotes(text), "--size");
    set(output, "width", width, "--size: width");
    set(output, "height", height, "--size: height");
}

} // namespace

void SceneOptions::addTo(CLI::App& command) {
    const auto add = [&](const char* names, std::optional<std::string>& value, const char* type, const char* doc) {
        command.add_option(names, value, doc)->type_name(type);
    };
    add("--size", size, "WxH", "Size of the picture in pixels (output.width, output.height)");
    add("--samples", samples, "N", "Samples per pixel (output.samples)");
    add("--time", time, "SECONDS", "Render for so long; alone, as many samples as fit (output.time)");
    add("--noise", noise, "TARGET", "Render until the estimated relative error is below (output.noise)");
    add("--seed", seed, "K", "Start of all random numbers (output.seed)");
    add("--memory", memory, "BYTES",
        "Most memory for a volume's voxels or a terrain's tiles, such as 256M or 2G (subject.memory, in MiB)");
    add("--first-sample", firstSample, "K", "Index of the first sample, to divide work (output.first_sample)");
    command.add_option("--set", sets, "Set any parameter (see 'apeiron schema'), such as subject.power=9; repeatable")
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
}

void SceneOptions::apply(scene::Scene& scene) const {
    for (const std::string& edit : sets) {
        const std::size_t equals = edit.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(ErrorKind::BadInput, "expected PATH=VALUE such as subject.power=9, got " + inQuotes(edit),
                        "--set");
        try {
            scene.set(edit.substr(0, equals), std::string_view(edit).substr(equals + 1),
                      std::filesystem::current_path());
        } catch (const Error& error) {
            throw error.at("--set");
        }
    }
    if (memory) setMemory(scene.subject, *memory);
    parameter::Node& output = scene.output;
    if (size) setSize(output, *size);
    if (samples) set(output, "samples", *samples, "--samples");
    if (time) set(output, "time", *time, "--time");
    if (noise) set(output, "noise", *noise, "--noise");
    if (seed) set(output, "seed", *seed, "--seed");
    if (firstSample) set(output, "first_sample", *firstSample, "--first-sample");
    // Another goal instead of the scene's number of samples, not one more.
    if ((time || noise) && !samples) {
        const parameter::Parameter& declared = output.schema().at("samples");
        output.set("samples", static_cast<std::int64_t>(declared.maximum.value()));
    }
}

void DeviceOptions::addTo(CLI::App& command) {
    command.add_option("--device", device, "auto, or an index of 'apeiron list devices'")->type_name("INDEX");
    command.add_option("--stage", stage, "How kernels run: auto, fragment or compute")->type_name("STAGE");
}

gpu::ContextOptions DeviceOptions::context() const {
    gpu::ContextOptions options;
    if (device != "auto") options.device = static_cast<int>(wholeNumber("--device", device, 0, 1000));
    return options;
}

std::optional<gpu::Stage> DeviceOptions::chosenStage() const {
    if (stage == "auto") return std::nullopt;
    if (stage == "fragment") return gpu::Stage::Fragment;
    if (stage == "compute") return gpu::Stage::Compute;
    throw Error(ErrorKind::BadInput, "unknown stage " + inQuotes(stage), "--stage",
                suggestion(stage, std::vector<std::string>{"auto", "fragment", "compute"}));
}

std::int64_t wholeNumber(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most) {
    const std::optional<double> number = parameter::parseNumber(text);
    if (!isWhole(text) || !number || *number < static_cast<double>(least) || *number > static_cast<double>(most))
        throw Error(ErrorKind::BadInput,
                    fmt::format("expected a whole number from {} to {}, got {}", least, most, inQuotes(text)), option);
    return static_cast<std::int64_t>(*number);
}

double positiveNumber(const std::string& option, const std::string& text) {
    const std::optional<double> number = parameter::parseNumber(text);
    if (!number || !(*number > 0.0))
        throw Error(ErrorKind::BadInput, "expected a number greater than 0, got " + inQuotes(text), option);
    return *number;
}

} // namespace apeiron::cli
