#include "commands.hpp"

#include "scene/catalogue.hpp"
#include "session/session.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>

namespace apeiron::cli {
namespace {

constexpr const char* kHead = R"(# Parameters

<!-- Made by `apeiron schema`; do not edit. -->

Everything that a scene can say, part by part. A scene document holds only what is not at its default; on the command line,
`--set PATH=VALUE` sets one parameter. *Invalidates* is what an edit makes stale: `nothing`, the way the samples are
shown (`present`), the `samples`, or the compiled `program`.
)";

/// A text inside a table's cell: one line, no column breaks.
std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find_first_of("|\n", at)) != std::string::npos; at += 2)
        text.replace(at, 1, text[at] == '|' ? "\\|" : "  ");
    return text;
}

std::string value(const Json& json) {
    if (json.is_string()) return json.get<std::string>();
    if (json.is_number_float()) return fmt::format("{}", json.get<double>());
    if (!json.is_array()) return json.dump();
    std::string text;
    for (const Json& component : json)
        text += (text.empty() ? "" : ", ") + value(component);
    return "(" + text + ")";
}

std::string type(const Json& parameter) {
    std::string text = parameter["type"].get<std::string>();
    if (parameter.contains("choices")) {
        std::string labels;
        for (const Json& label : parameter["choices"])
            labels += (labels.empty() ? "" : ", ") + label.get<std::string>();
        text = labels;
    }
    if (parameter.contains("folder")) text = "one of the " + parameter["folder"].get<std::string>();
    return text;
}

std::string range(const Json& parameter) {
    const std::string least = parameter.contains("min") ? value(parameter["min"]) : "";
    const std::string most = parameter.contains("max") ? value(parameter["max"]) : "";
    const std::string unit = parameter.contains("unit") ? " " + parameter["unit"].get<std::string>() : "";
    if (least.empty() && most.empty()) return unit.empty() ? "" : unit.substr(1);
    return fmt::format("{} to {}{}", least, most, unit);
}

std::string parameterTable(const Json& parameters) {
    if (parameters.empty()) return "No parameters.\n";
    std::string text = "| parameter | default | type | range | invalidates | meaning |\n|---|---|---|---|---|---|\n";
    for (const Json& parameter : parameters)
        text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", parameter["name"].get<std::string>(),
                            cell(value(parameter["default"])), cell(type(parameter)), range(parameter),
                            parameter["invalidates"].get<std::string>(), cell(parameter["doc"].get<std::string>()));
    return text;
}

/// Where a document keeps its lists.
const std::map<std::string, std::string> kListPaths{
    {"light", "lights"}, {"effect", "post.effects"}, {"slot", "subject.slots"}};

/// Without the full stop, for a sentence that goes on.
std::string phrase(std::string doc) {
    while (doc.ends_with('.'))
        doc.pop_back();
    return doc;
}

/// The reference page of all parameters.
std::string markdown(const Json& schema) {
    std::string text = kHead;
    for (const auto& [role, description] : schema["roles"].items()) {
        const bool list = description["list"].get<bool>();
        for (const auto& [name, type] : description["types"].items()) {
            const auto place = kListPaths.find(role);
            const std::string path = place != kListPaths.end() ? place->second + ".0" : role;
            text += fmt::format("\n## {}{}\n\n{}. Path: `{}`{}\n\n{}", role, name.empty() ? "" : ": " + name,
                                phrase(type["doc"].get<std::string>()), path + ".NAME", list ? " and so on." : ".",
                                parameterTable(type["parameters"]));
        }
    }
    for (const auto& [folder, modules] : schema["modules"].items()) {
        text += fmt::format("\n## The {}\n", folder);
        for (const auto& [name, module] : modules.items())
            text += fmt::format("\n### {}\n\n{}\n\n{}", name, module["doc"].get<std::string>(),
                                parameterTable(module["parameters"]));
    }
    return text;
}

int schema(bool json) {
    const Json all = session::catalogue()->toJson();
    fmt::print("{}", json ? all.dump(2) + "\n" : markdown(all));
    return kDone;
}

} // namespace

void addSchemaCommand(CLI::App& app, Action& action) {
    struct Options {
        bool json = false;
        bool markdown = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("schema", "Print every parameter that a scene can have");
    command->footer("Example: apeiron schema > docs/parameters.md");
    CLI::Option* json = command->add_flag("--json", options->json, "Print JSON");
    command->add_flag("--markdown", options->markdown, "Print the reference page (the default)")->excludes(json);
    command->callback([options, &action] { action = [options] { return schema(options->json); }; });
}

} // namespace apeiron::cli
