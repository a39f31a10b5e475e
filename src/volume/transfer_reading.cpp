#include "core/error.hpp"
#include "core/resources.hpp"
#include "core/suggest.hpp"
#include "volume/transfer_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>

// Transfer functions from JSON.
namespace apeiron::volume {
namespace {

constexpr int kMaxPresets = 8; ///< that stand on each other

[[noreturn]] void fail(const std::string& what, const std::string& hint = {}) {
    throw Error(ErrorKind::BadInput, what, {}, hint);
}

/// Reads a part, whose name stands in front of what is wrong in it.
template <class Read> auto inside(const std::string& place, const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        throw error.at(place);
    }
}

std::string shown(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() <= 40 ? text : "a longer " + std::string(json.type_name());
}

double readNumber(const Json& json, double minimum, double maximum) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) fail("expected a number, got " + shown(json));
    const double number = json.get<double>();
    if (number < minimum || number > maximum) fail(fmt::format("{} is outside [{}, {}]", number, minimum, maximum));
    return number;
}

constexpr double kFar = 1e30; ///< what a float can hold, with room for sums

double linear(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); // IEC 61966-2-1
}

glm::dvec3 readColor(const Json& json, bool srgb) {
    glm::dvec3 color(0.0);
    if (json.is_string()) {
        const auto& text = json.get_ref<const std::string&>();
        constexpr std::string_view kDigits = "0123456789abcdefABCDEF";
        if (text.size() != 7 || text[0] != '#' || text.find_first_not_of(kDigits, 1) != std::string::npos)
            fail("expected a color such as \"#ffcc88\" or [1, 0.8, 0.5], got " + inQuotes(text));
        for (std::size_t c = 0; c < 3; ++c)
            color[static_cast<int>(c)] = linear(std::stoi(text.substr(1 + 2 * c, 2), nullptr, 16) / 255.0);
        return color;
    }
    if (!json.is_array() || json.size() != 3)
        fail("expected a color such as \"#ffcc88\" or [1, 0.8, 0.5], got " + shown(json));
    for (int c = 0; c < 3; ++c) {
        const double part = readNumber(json[static_cast<std::size_t>(c)], 0.0, 1.0);
        color[c] = srgb ? linear(part) : part;
    }
    return color;
}

glm::dvec2 readPair(const Json& json, double minimum) {
    if (!json.is_array() || json.size() != 2) fail("expected 2 numbers (value, gradient), got " + shown(json));
    return {readNumber(json[0], minimum, kFar), readNumber(json[1], minimum, kFar)};
}

using Reader = std::function<void(const Json&)>;
using Members = std::vector<std::pair<std::string, Reader>>;

/// Reads the members of an object, each by its reader. @throws Error for other keys, and where it is no object.
void readObject(const Json& json, const Members& members) {
    if (!json.is_object()) fail("expected an object {...}, got " + shown(json));
    for (const auto& [key, value] : json.items()) {
        const auto member = std::find_if(members.begin(), members.end(),
                                         [&name = key](const auto& known) { return known.first == name; });
        if (member == members.end()) {
            std::vector<std::string> names;
            for (const auto& known : members)
                names.push_back(known.first);
            fail("unknown key " + inQuotes(key), suggestion(key, names));
        }
        inside(key, [&read = member->second, &part = value] { read(part); });
    }
}

std::size_t indexOf(const Json& json, const std::vector<std::string>& labels) {
    const std::string text = json.is_string() ? json.get<std::string>() : shown(json);
    const auto label = std::find(labels.begin(), labels.end(), text);
    if (!json.is_string() || label == labels.end()) fail("unknown value " + inQuotes(text), suggestion(text, labels));
    return static_cast<std::size_t>(label - labels.begin());
}

TransferPoint readPoint(const Json& json, bool srgb) {
    TransferPoint point;
    readObject(json, {{"value", [&](const Json& value) { point.value = readNumber(value, -kFar, kFar); }},
                      {"color", [&](const Json& value) { point.color = readColor(value, srgb); }},
                      {"opacity", [&](const Json& value) { point.opacity = readNumber(value, 0.0, 1.0); }},
                      {"emission", [&](const Json& value) { point.emission = readNumber(value, 0.0, 1e6); }}});
    if (!json.contains("value")) fail("a point needs a \"value\"");
    return point;
}

TransferShape readShape(const Json& json, bool srgb) {
    static const std::vector<std::string> kKinds{"box", "gaussian", "triangle"};
    TransferShape shape;
    readObject(
        json,
        {{"type", [&](const Json& value) { shape.kind = static_cast<TransferShape::Kind>(indexOf(value, kKinds)); }},
         {"center", [&](const Json& value) { shape.center = readPair(value, -kFar); }},
         {"size",
          [&](const Json& value) {
              shape.size = readPair(value, 0.0);
              if (shape.size.x <= 0.0 || shape.size.y <= 0.0) fail("a shape's width and height are above 0");
          }},
         {"color", [&](const Json& value) { shape.color = readColor(value, srgb); }},
         {"opacity", [&](const Json& value) { shape.opacity = readNumber(value, 0.0, 1.0); }},
         {"emission", [&](const Json& value) { shape.emission = readNumber(value, 0.0, 1e6); }}});
    for (const char* needed : {"type", "center", "size"})
        if (!json.contains(needed)) fail(fmt::format("a shape needs a \"{}\"", needed));
    return shape;
}

/// The elements of a list, at most `limit`. @param read makes one of its JSON
template <class Read> auto readList(const Json& json, std::size_t limit, const Read& read) {
    std::vector<decltype(read(json))> list;
    if (!json.is_array()) fail("expected a list [...], got " + shown(json));
    if (json.size() > limit) fail(fmt::format("at most {} are possible", limit));
    for (std::size_t i = 0; i < json.size(); ++i)
        list.push_back(inside(std::to_string(i), [&] { return read(json[i]); }));
    return list;
}

void readWindow(const Json& json, TransferFunction& function) {
    if (!json.is_object()) {
        static const std::vector<std::string> kNames{"none", "data"};
        constexpr std::array kWindows{TransferFunction::Window::None, TransferFunction::Window::Data};
        if (!json.is_string()) fail("expected {\"level\", \"width\"}, \"data\" or \"none\", got " + shown(json));
        function.window = kWindows[indexOf(json, kNames)];
        return;
    }
    function.window = TransferFunction::Window::Given;
    readObject(json, {{"level", [&](const Json& value) { function.level = readNumber(value, -kFar, kFar); }},
                      {"width", [&](const Json& value) { function.width = readNumber(value, 1e-30, kFar); }}});
    for (const char* needed : {"level", "width"})
        if (!json.contains(needed)) fail(fmt::format("a window needs a \"{}\"", needed));
}

/// @param automatic what "auto" stands for
std::vector<TransferFunction> readTransfer(const Json& json, const Json& automatic, int depth);

/// The functions of a preset.
std::vector<TransferFunction> readPreset(const Json& name, const Json& automatic, int depth) {
    if (depth > kMaxPresets) fail("presets that stand on each other without an end");
    if (name == "auto") return readTransfer(automatic, automatic, depth + 1);
    std::vector<std::string> names;
    for (const TransferPreset& preset : transferPresets()) {
        if (name == preset.name) return readTransfer(preset.transfer, automatic, depth + 1);
        names.push_back(preset.name);
    }
    names.emplace_back("auto");
    const std::string text = name.is_string() ? name.get<std::string>() : shown(name);
    fail("unknown preset " + inQuotes(text), suggestion(text, names));
}

/// An object on top of the function that it begins with.
TransferFunction readFunction(const Json& json, TransferFunction function) {
    bool srgb = true;
    if (json.contains("space")) srgb = inside("space", [&] { return indexOf(json["space"], {"linear", "srgb"}) == 1; });
    const auto point = [srgb](const Json& one) { return readPoint(one, srgb); };
    const auto shape = [srgb](const Json& one) { return readShape(one, srgb); };
    readObject(json, {{"preset", [](const Json&) {}},
                      {"space", [](const Json&) {}},
                      {"window", [&](const Json& value) { readWindow(value, function); }},
                      {"points", [&](const Json& value) { function.points = readList(value, kMaxPoints, point); }},
                      {"shapes", [&](const Json& value) { function.shapes = readList(value, kMaxShapes, shape); }}});
    for (std::size_t i = 1; i < function.points.size(); ++i)
        if (function.points[i].value < function.points[i - 1].value)
            throw Error(ErrorKind::BadInput, "values must ascend", fmt::format("points: {}", i));
    if (function.points.empty() && function.shapes.empty())
        fail("a transfer function needs \"points\" or \"shapes\"", "or a \"preset\" that has them");
    return function;
}

std::vector<TransferFunction> readTransfer(const Json& json, const Json& automatic, int depth) {
    if (json.is_string()) return readPreset(json, automatic, depth);
    if (json.is_array()) {
        constexpr std::size_t kMostChannels = 4;
        if (json.empty()) fail("expected a function for each channel, got an empty list");
        return readList(json, kMostChannels, [&](const Json& one) {
            if (one.is_array()) fail("a list inside a list");
            return readTransfer(one, automatic, depth).front();
        });
    }
    if (!json.is_object()) fail("expected a preset's name, a function {...} or a list of them, got " + shown(json));
    std::vector<TransferFunction> functions(1);
    if (json.contains("preset"))
        functions = inside("preset", [&] { return readPreset(json["preset"], automatic, depth); });
    for (TransferFunction& function : functions)
        function = readFunction(json, function);
    return functions;
}

std::vector<TransferPreset> loadPresets() {
    std::vector<TransferPreset> presets;
    for (const Resource& resource : resourcesInFolder("presets", ".json")) {
        const Json json = Json::parse(resource.text);
        TransferPreset preset;
        preset.name = resource.path.substr(resource.path.rfind('/') + 1);
        preset.name.erase(preset.name.size() - std::string_view(".json").size());
        preset.doc = json.at("doc").get<std::string>();
        preset.modality = json.at("modality").get<std::string>();
        preset.transfer = json.at("transfer");
        presets.push_back(std::move(preset));
    }
    return presets;
}

} // namespace

const std::vector<TransferPreset>& transferPresets() {
    static const std::vector<TransferPreset> kPresets = loadPresets();
    return kPresets;
}

std::vector<TransferFunction> transferFunctions(const Json& json, const Json& automatic) {
    return readTransfer(json, automatic, 0);
}

void checkTransfer(const Json& json) {
    // What "auto" will be depends on the data; it always has points.
    static const Json kAnything = Json::parse(R"({"points": [{"value": 0}]})");
    readTransfer(json, kAnything, 0);
}

parameter::Parameter transferParameter() {
    parameter::Parameter parameter;
    parameter.name = "transfer";
    parameter.type = parameter::Type::Structure;
    parameter.defaultValue = parameter::Structure{Json("auto")};
    parameter.check = checkTransfer;
    parameter.shorthand = "preset";
    parameter.choices.emplace_back("auto");
    for (const TransferPreset& preset : transferPresets())
        parameter.choices.push_back(preset.name);
    parameter.doc =
        "How values become colour and opacity: auto (from the data), a preset's name, a function, or a list "
        "of one for each channel";
    parameter.where = "src/volume/transfer_reading.cpp";
    return parameter;
}

} // namespace apeiron::volume
