#include "commands.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "core/json.hpp"
#include "core/suggest.hpp"
#include "options.hpp"
#include "terrain/place.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>

namespace apeiron::cli {
namespace {

struct HeightOptions {
    std::string seed = "0";
    std::string path;
    std::string kernel = "bspline";
    std::string hurst = "1";
    bool json = false;
};

terrain::Kernel kernelOf(const std::string& name) {
    if (name == "bspline") return terrain::Kernel::BSpline;
    if (name == "bilinear") return terrain::Kernel::Bilinear;
    throw Error(ErrorKind::BadInput, "unknown kernel " + inQuotes(name), "--kernel",
                suggestion(name, std::vector<std::string>{"bspline", "bilinear"}));
}

int hurstOf(const std::string& text) {
    const double hurst = positiveNumber("--hurst", text);
    const double thousandths = std::round(1000.0 * hurst);
    if (!(thousandths >= 1.0 && thousandths <= 1000.0))
        throw Error(ErrorKind::BadInput, "expected a number from 0.001 to 1, got " + inQuotes(text), "--hurst");
    return static_cast<int>(thousandths);
}

/// The digits themselves, of a file (@FILE) or of standard input (-).
std::string pathText(const std::string& argument) {
    if (argument == "-") return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
    if (argument.starts_with('@')) return readFile(argument.substr(1));
    return argument;
}

int height(const HeightOptions& options) {
    terrain::Shape shape;
    shape.kernel = kernelOf(options.kernel);
    shape.hurst = hurstOf(options.hurst);
    shape.seed =
        static_cast<std::uint32_t>(wholeNumber("--seed", options.seed, 0, std::numeric_limits<std::uint32_t>::max()));
    terrain::Address address;
    try {
        address = terrain::Address::parse(pathText(options.path));
    } catch (const Error& error) {
        throw error.at("--path");
    }
    terrain::Cell cell = terrain::rootCell(shape);
    for (std::int64_t level = 0; level < address.levels(); ++level)
        cell = terrain::childCell(shape, cell, address.digit(level));

    const std::array<std::int32_t, 4> corners{cell.window[5], cell.window[6], cell.window[9], cell.window[10]};
    const bool window = shape.kernel == terrain::Kernel::BSpline;
    if (options.json) {
        Json json = {{"kernel", options.kernel}, {"seed", shape.seed}, {"hurst", shape.hurst / 1000.0},
                     {"level", cell.level},      {"x", cell.x},        {"y", cell.y},
                     {"corners", corners}};
        if (window) json["window"] = cell.window;
        fmt::print("{}\n", json.dump(2));
        return kDone;
    }
    fmt::print("level    {}\nx, y     {} {}\ncorners  {}\n", cell.level, cell.x, cell.y, fmt::join(corners, " "));
    for (std::size_t j = 0; window && j < 4; ++j)
        fmt::print("{}  {}\n", j == 0 ? "window " : "       ",
                   fmt::join(cell.window.begin() + static_cast<std::ptrdiff_t>(4 * j),
                             cell.window.begin() + static_cast<std::ptrdiff_t>(4 * j + 4), " "));
    return kDone;
}

void addHeight(CLI::App& terrain, Action& action) {
    const auto options = std::make_shared<HeightOptions>();
    CLI::App* command = terrain.add_subcommand("height", "Print a cell's exact heights, modulo 2^32");
    command->footer("Example: apeiron terrain height --seed 19088743 --path 33013\n\n"
                    "Heights are in 1/4096 of the cell's edge. The window holds lattice points (x - 1, y - 1) to\n"
                    "(x + 2, y + 2), row by row; the corners are (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).");
    command
        ->add_option("--path", options->path,
                     "Digits from the root cell on, 0 to 3 (x half + 2 * y half); @FILE, or - for standard input")
        ->required()
        ->type_name("DIGITS");
    command->add_option("--seed", options->seed, "Which terrain, 0 to 4294967295")->type_name("S");
    command->add_option("--kernel", options->kernel, "bspline or bilinear")->type_name("KERNEL");
    command->add_option("--hurst", options->hurst, "Hurst exponent, 0.001 to 1 (1: not self-affine)")->type_name("H");
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &action] { action = [options] { return height(*options); }; });
}

} // namespace

void addTerrainCommand(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("terrain", "Ask a terrain for its heights, or fly into it");
    command->require_subcommand(1);
    command->footer("Example: apeiron terrain height --seed 19088743 --path 33013 --json");
    addHeight(*command, action);
    addDiveCommand(*command, action);
}

} // namespace apeiron::cli
