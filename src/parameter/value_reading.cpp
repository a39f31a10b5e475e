#include "core/error.hpp"
#include "core/suggest.hpp"
#include "parameter/json_source.hpp"
#include "parameter/parameter.hpp"
#include "parameter/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

// Values from JSON and from a command line's text.
namespace apeiron::parameter {
namespace {

/// Beyond 2^53 a double no longer tells neighbouring integers apart.
constexpr double kLargestExactInteger = 9007199254740992.0;

std::string expectation(const Parameter& parameter) {
    switch (parameter.type) {
    case Type::Bool:
        return "true or false";
    case Type::Int:
        return "a whole number";
    case Type::Float:
        return "a number";
    case Type::Vec2:
        return "2 numbers, such as [0, 1]";
    case Type::Vec3:
        return "3 numbers, such as [0, 0.5, 1]";
    case Type::Vec4:
        return "4 numbers, such as [0, 0, 0, 1]";
    case Type::Choice:
        return "a label";
    case Type::Text:
        return "a text";
    case Type::Decimal3:
        return R"(3 decimal numbers, such as ["0", "0.5", "1"])";
    case Type::Module:
        return R"(the name of a module, or {"name": ..., "source": ...})";
    case Type::Structure:
        return "a JSON value";
    }
    return {};
}

std::string shown(const Json& json) {
    // Strings keep their own quotes; replacing bad UTF-8 keeps dump() from throwing.
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (json.is_string()) return inQuotes(json.get_ref<const std::string&>());
    constexpr std::size_t kLongest = 60;
    return text.size() <= kLongest ? text : "a longer " + std::string(json.type_name());
}

[[noreturn]] void failExpected(const Parameter& parameter, const std::string& got) {
    std::string hint;
    if (parameter.type == Type::Choice) hint = suggestion({}, parameter.choices);
    throw Error(ErrorKind::BadInput, fmt::format("expected {}, got {}", expectation(parameter), got), {}, hint);
}

std::int64_t toInteger(const Parameter& parameter, double number, const std::string& got) {
    if (number != std::trunc(number) || std::abs(number) > kLargestExactInteger) failExpected(parameter, got);
    return static_cast<std::int64_t>(number);
}

Value integerFromJson(const Parameter& parameter, const Json& json) {
    if (json.is_number_unsigned() &&
        json.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        failExpected(parameter, shown(json));
    if (json.is_number_integer()) return json.get<std::int64_t>();
    if (!json.is_number()) failExpected(parameter, shown(json));
    return toInteger(parameter, json.get<double>(), shown(json));
}

template <class V> Value vectorFromJson(const Parameter& parameter, const Json& json) {
    V vector;
    if (!json.is_array() || json.size() != static_cast<std::size_t>(V::length())) failExpected(parameter, shown(json));
    for (int i = 0; i < V::length(); ++i) {
        const Json& component = json[static_cast<std::size_t>(i)];
        if (!component.is_number()) failExpected(parameter, shown(json));
        vector[i] = component.get<double>();
    }
    return vector;
}

Value decimalsFromJson(const Parameter& parameter, const Json& json) {
    Decimal3 decimals;
    if (!json.is_array() || json.size() != decimals.size()) failExpected(parameter, shown(json));
    for (std::size_t i = 0; i < decimals.size(); ++i) {
        const Json& component = json[i];
        if (component.is_string())
            decimals[i] = Decimal::parse(component.get_ref<const std::string&>());
        else if (component.is_number_integer())
            decimals[i] = Decimal::parse(component.dump());
        else if (component.is_number() && std::isfinite(component.get<double>()))
            decimals[i] = Decimal(component.get<double>());
        else
            failExpected(parameter, shown(json));
    }
    return decimals;
}

Value moduleFromJson(const Parameter& parameter, const Json& json) {
    if (json.is_string()) return ModuleReference{json.get<std::string>(), {}};
    if (!json.is_object() || !json.contains("name")) failExpected(parameter, shown(json));
    ModuleReference reference;
    for (const auto& [key, member] : json.items()) {
        if (key != "name" && key != "source")
            throw Error(ErrorKind::BadInput, "unknown key " + inQuotes(key), {}, "known: name, source");
        if (!member.is_string()) throw Error(ErrorKind::BadInput, key + ": expected a text, got " + shown(member));
        if (key == "name") reference.name = member.get<std::string>();
        if (key == "source") reference.source = member.get<std::string>();
    }
    return reference;
}

/// `a, b`, `(a, b)` and `[a, b]` without the brackets; nothing when they do not match.
std::optional<std::string_view> withoutBrackets(std::string_view text) {
    text = trimmed(text);
    if (text.empty()) return std::nullopt;
    const char open = text.front();
    if (open != '(' && open != '[') return text;
    if (text.size() < 2 || text.back() != (open == '(' ? ')' : ']')) return std::nullopt;
    return text.substr(1, text.size() - 2);
}

template <class V> Value vectorFromText(const Parameter& parameter, std::string_view text) {
    const auto inner = withoutBrackets(text);
    if (!inner) failExpected(parameter, inQuotes(text));
    const std::vector<std::string_view> pieces = splitAtCommas(*inner);
    if (pieces.size() != static_cast<std::size_t>(V::length())) failExpected(parameter, inQuotes(text));
    V vector;
    for (int i = 0; i < V::length(); ++i) {
        const std::optional<double> number = parseNumber(pieces[static_cast<std::size_t>(i)]);
        if (!number) failExpected(parameter, inQuotes(text));
        vector[i] = *number;
    }
    return vector;
}

Value decimalsFromText(const Parameter& parameter, std::string_view text) {
    const auto inner = withoutBrackets(text);
    if (!inner) failExpected(parameter, inQuotes(text));
    const std::vector<std::string_view> pieces = splitAtCommas(*inner);
    Decimal3 decimals;
    if (pieces.size() != decimals.size()) failExpected(parameter, inQuotes(text));
    for (std::size_t i = 0; i < decimals.size(); ++i) {
        std::string_view piece = pieces[i];
        if (piece.size() >= 2 && piece.front() == '"' && piece.back() == '"') piece = piece.substr(1, piece.size() - 2);
        decimals[i] = Decimal::parse(piece);
    }
    return decimals;
}

/// JSON where the text is an object, a list or a string in quotes; other text is a string.
Value structureFromText(std::string_view text) {
    const std::string_view word = trimmed(text);
    if (word.empty() || std::string_view("{[\"").find(word.front()) == std::string_view::npos)
        return Structure{Json(std::string(word))};
    return Structure{JsonSource::parse("value", std::string(text)).root()};
}

/// Text that is plainly JSON: a string in quotes or an object. Other text stands for itself.
std::optional<Json> quotedJson(std::string_view text) {
    text = trimmed(text);
    if (text.size() < 2 || (text.front() != '"' && text.front() != '{')) return std::nullopt;
    Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (json.is_discarded()) return std::nullopt;
    return json;
}

Value readJson(const Parameter& parameter, const Json& json) {
    switch (parameter.type) {
    case Type::Bool:
        if (!json.is_boolean()) break;
        return json.get<bool>();
    case Type::Int:
        return integerFromJson(parameter, json);
    case Type::Float:
        if (!json.is_number()) break;
        return json.get<double>();
    case Type::Vec2:
        return vectorFromJson<glm::dvec2>(parameter, json);
    case Type::Vec3:
        return vectorFromJson<glm::dvec3>(parameter, json);
    case Type::Vec4:
        return vectorFromJson<glm::dvec4>(parameter, json);
    case Type::Choice:
    case Type::Text:
        if (!json.is_string()) break;
        return json.get<std::string>();
    case Type::Decimal3:
        return decimalsFromJson(parameter, json);
    case Type::Module:
        return moduleFromJson(parameter, json);
    case Type::Structure:
        return Structure{json};
    }
    failExpected(parameter, shown(json));
}

Value readText(const Parameter& parameter, std::string_view text) {
    const std::string_view word = trimmed(text);
    switch (parameter.type) {
    case Type::Bool:
        if (word != "true" && word != "false") break;
        return word == "true";
    case Type::Int:
    case Type::Float: {
        const std::optional<double> number = parseNumber(word);
        if (!number) break;
        if (parameter.type == Type::Float) return *number;
        return toInteger(parameter, *number, inQuotes(text));
    }
    case Type::Vec2:
        return vectorFromText<glm::dvec2>(parameter, text);
    case Type::Vec3:
        return vectorFromText<glm::dvec3>(parameter, text);
    case Type::Vec4:
        return vectorFromText<glm::dvec4>(parameter, text);
    case Type::Decimal3:
        return decimalsFromText(parameter, text);
    case Type::Choice:
        if (const auto json = quotedJson(text)) return readJson(parameter, *json);
        return std::string(word);
    case Type::Text:
        if (const auto json = quotedJson(text); json && json->is_string()) return json->get<std::string>();
        return std::string(text);
    case Type::Module:
        if (const auto json = quotedJson(text)) return readJson(parameter, *json);
        return ModuleReference{std::string(word), {}};
    case Type::Structure:
        return structureFromText(text);
    }
    failExpected(parameter, inQuotes(text));
}

} // namespace

Value valueFromJson(const Parameter& parameter, const Json& json) {
    Value value = readJson(parameter, json);
    validate(parameter, value);
    return value;
}

Value valueFromText(const Parameter& parameter, std::string_view text) {
    Value value = readText(parameter, text);
    validate(parameter, value);
    return value;
}

} // namespace apeiron::parameter
