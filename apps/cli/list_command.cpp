#include "commands.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "gpu/context.hpp"
#include "parameter/glsl_module.hpp"
#include "scene_argument.hpp"
#include "session/session.hpp"
#include "table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace apeiron::cli {
namespace {

/// The kinds whose members are GLSL files: named like their folders.
const std::vector<std::string> kModuleKinds{"formulas",    "renderers",    "effects",
                                            "tonemappers", "environments", "palettes"};

struct Entry {
    std::string name;
    std::string doc;
};

std::vector<std::string> kinds() {
    std::vector<std::string> all{"scenes", "subjects"};
    all.insert(all.end(), kModuleKinds.begin(), kModuleKinds.end());
    all.emplace_back("devices");
    return all;
}

std::vector<Entry> entriesOf(const std::string& kind) {
    std::vector<Entry> entries;
    if (kind == "scenes") {
        for (const std::string& name : galleryNames())
            entries.push_back({name, loadScene(name).title});
    } else if (kind == "subjects") {
        for (const auto& type : session::catalogue()->types("subject"))
            entries.push_back({type->name, firstLine(type->doc)});
    } else {
        for (const std::string& name : parameter::moduleNames(kind))
            entries.push_back({name, firstLine(parameter::loadModule(kind, {name, {}}).doc)});
    }
    return entries;
}

void listEntries(const std::string& kind, bool json) {
    Json array = Json::array();
    std::vector<Row> rows;
    for (const Entry& entry : entriesOf(kind)) {
        array.push_back({{"name", entry.name}, {"doc", entry.doc}});
        rows.push_back({entry.name, entry.doc});
    }
    fmt::print("{}", json ? array.dump(2) + "\n" : alignedTable(rows));
}

void listDevices(bool json) {
    Json array = Json::array();
    std::vector<Row> rows;
    for (const gpu::Device& device : gpu::Context::devices()) {
        array.push_back({{"index", device.index},
                         {"name", device.name},
                         {"driver", device.driver},
                         {"software", device.software},
                         {"usable", device.usable},
                         {"problem", device.problem}});
        rows.push_back({std::to_string(device.index), device.name,
                        device.usable ? device.driver : "not usable: " + device.problem});
    }
    if (json) {
        fmt::print("{}\n", array.dump(2));
    } else if (rows.empty()) {
        fmt::print("no EGL device on this machine\n");
    } else {
        fmt::print("{}", alignedTable(rows));
    }
}

int list(const std::string& kind, bool json) {
    const std::vector<std::string> known = kinds();
    if (std::find(known.begin(), known.end(), kind) == known.end())
        throw Error(ErrorKind::BadInput, "there are no lists of " + inQuotes(kind), {}, suggestion(kind, known));
    if (kind == "devices")
        listDevices(json);
    else
        listEntries(kind, json);
    return kDone;
}

} // namespace

void addListCommand(CLI::App& app, Action& action) {
    struct Options {
        std::string kind;
        bool json = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("list", "List what there is to choose from");
    command->footer("Example: apeiron list formulas");
    command->add_option("KIND", options->kind, fmt::format("One of {}", fmt::join(kinds(), ", ")))
        ->required()
        ->type_name("");
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &action] { action = [options] { return list(options->kind, options->json); }; });
}

} // namespace apeiron::cli
