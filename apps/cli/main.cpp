#include "commands.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "io/radiance_file.hpp"
#include "io/volume_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <new>

namespace apeiron::cli {
namespace {

constexpr const char* kAbout = "Apeiron renders worlds without triangles: 3D fractals, endless terrain, volumes.\n"
                               "Each command has its own --help.";
constexpr const char* kExamples =
    "Examples:\n"
    "  apeiron render mandelbulb -o bulb.png\n"
    "  apeiron render scene.json -o big.png --size 3840x2160 --samples 256\n"
    "  apeiron list scenes\n\n"
    "Exit codes: 0 done, 2 wrong input or usage, 3 no usable GPU context, 130 interrupted,\n"
    "1 anything else.";

int report(const std::string& message, int code) {
    fmt::print(stderr, "apeiron: {}\n", message);
    return code;
}

int exitCode(ErrorKind kind) {
    switch (kind) {
    case ErrorKind::BadInput:
    case ErrorKind::Io:
        return kBadInput;
    case ErrorKind::NoContext:
    case ErrorKind::Gpu:
        return kNoGpu;
    }
    return kInternal;
}

std::vector<std::string> commandNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

/// The command that was given, or the program itself.
const CLI::App& chosen(const CLI::App& app) {
    const auto commands = app.get_subcommands();
    return commands.empty() ? app : *commands.front();
}

/// The parser's complaint in one line, with the nearest option for one that is unknown.
int reportUsage(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = chosen(app);
    const std::string help =
        fmt::format("see '{} --help'", &command == &app ? "apeiron" : "apeiron " + command.get_name());
    for (const std::string& argument : app.remaining(true)) {
        if (argument.size() < 2 || argument.front() != '-') continue;
        const std::string name = argument.substr(0, argument.find('='));
        std::vector<std::string> known;
        for (const CLI::Option* option : command.get_options())
            for (const std::string& longName : option->get_lnames())
                known.push_back("--" + longName);
        const std::string nearest = nearestName(name, known);
        return report(fmt::format("unknown option {}; {}", inQuotes(name),
                                  nearest.empty() ? help : fmt::format("did you mean {}? {}", nearest, help)),
                      kBadInput);
    }
    std::string what = error.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    while (!what.empty() && (what.back() == ' ' || what.back() == '.'))
        what.pop_back();
    return report(fmt::format("{}; {}", what, help), kBadInput);
}

/// The parser takes an unknown command for a stray argument: judge it first.
void requireKnownCommand(const CLI::App& app, int argc, char** argv) {
    if (argc < 2)
        throw Error(ErrorKind::BadInput, "which command?", {},
                    fmt::format("known: {}; see 'apeiron --help'", fmt::join(commandNames(app), ", ")));
    const std::string name = argv[1];
    if (name.starts_with('-')) return;
    const std::vector<std::string> known = commandNames(app);
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw Error(ErrorKind::BadInput, "unknown command " + inQuotes(name), {}, suggestion(name, known));
}

int run(int argc, char** argv) {
    CLI::App app(kAbout, "apeiron");
    app.footer(kExamples);
    app.set_version_flag("--version", "apeiron " APEIRON_VERSION, "Print the version and exit");
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    Action action;
    addRenderCommand(app, action);
    addInfoCommand(app, action);
    addCheckCommand(app, action);
    addListCommand(app, action);
    addSchemaCommand(app, action);
    addMergeCommand(app, action);
    addBenchCommand(app, action);
    addTerrainCommand(app, action);
    requireKnownCommand(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& request) {
        return app.exit(request);
    } catch (const CLI::ParseError& error) {
        return reportUsage(app, error);
    }
    return action();
}

/// The edge: everything that can go wrong becomes one clear line and an exit code.
int guarded(int argc, char** argv) {
    try {
        const int code = run(argc, argv);
        // A full disk behind a redirected stdout shows up only here.
        if (std::fflush(stdout) != 0) return report("standard output cannot be written", kBadInput);
        return code;
    } catch (const Error& error) {
        return report(error.what(), exitCode(error.kind()));
    } catch (const std::bad_alloc&) {
        return report("out of memory; choose a smaller --size", kInternal);
    } catch (const std::exception& error) {
        return report(fmt::format("internal error: {}", error.what()), kInternal);
    }
}

} // namespace
} // namespace apeiron::cli

int main(int argc, char** argv) {
    apeiron::io::registerPictureFiles();
    apeiron::io::registerVolumeFiles();
    return apeiron::cli::guarded(argc, argv);
}
