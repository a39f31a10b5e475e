#include "parameter/parameter.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "parameter/fail.hpp"
#include "parameter/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace apeiron::parameter {
namespace {

/// What a GLSL uniform of that type can hold; a host-only parameter has no such limit.
double limitOf(const Parameter& parameter) {
    if (!parameter.uniform) return std::numeric_limits<double>::max();
    return parameter.type == Type::Int ? double{std::numeric_limits<std::int32_t>::max()}
                                       : double{std::numeric_limits<float>::max()};
}

void checkNumber(const Parameter& parameter, double number) {
    if (!std::isfinite(number)) fail("expected a finite number");
    const std::optional<double>& minimum = parameter.minimum;
    const std::optional<double>& maximum = parameter.maximum;
    const bool tooSmall = minimum && number < *minimum;
    const bool tooLarge = maximum && number > *maximum;
    if ((tooSmall || tooLarge) && minimum && maximum)
        fail(fmt::format("{} is outside [{}, {}]", number, *minimum, *maximum));
    if (tooSmall) fail(fmt::format("{} is below {}", number, *minimum));
    if (tooLarge) fail(fmt::format("{} is above {}", number, *maximum));
    if (std::abs(number) > limitOf(parameter)) fail(fmt::format("{} is too large for a shader", number));
}

template <class V> void checkVector(const Parameter& parameter, const V& vector) {
    for (int i = 0; i < V::length(); ++i)
        checkNumber(parameter, vector[i]);
    if (parameter.nonZero && vector == V(0.0)) fail("expected a vector that is not zero");
}

void checkChoice(const Parameter& parameter, const std::string& label) {
    if (std::find(parameter.choices.begin(), parameter.choices.end(), label) == parameter.choices.end())
        fail("unknown value " + inQuotes(label), suggestion(label, parameter.choices));
}

template <class T> const T& expect(const Value& value, const char* what) {
    const T* typed = std::get_if<T>(&value);
    if (typed == nullptr) {
        const std::string got = toJson(value).dump(-1, ' ', false, Json::error_handler_t::replace);
        fail(fmt::format("expected {}, got {}", what, inQuotes(got)));
    }
    return *typed;
}

template <class V> Json vectorToJson(const V& vector) {
    Json array = Json::array();
    for (int i = 0; i < V::length(); ++i)
        array.push_back(vector[i]);
    return array;
}

Json toJsonValue(bool value) {
    return value;
}
Json toJsonValue(std::int64_t value) {
    return value;
}
Json toJsonValue(double value) {
    return value;
}
Json toJsonValue(const glm::dvec2& value) {
    return vectorToJson(value);
}
Json toJsonValue(const glm::dvec3& value) {
    return vectorToJson(value);
}
Json toJsonValue(const glm::dvec4& value) {
    return vectorToJson(value);
}
Json toJsonValue(const std::string& value) {
    return value;
}
Json toJsonValue(const Decimal3& value) {
    return Json::array({value[0].toString(), value[1].toString(), value[2].toString()});
}
Json toJsonValue(const ModuleReference& value) {
    if (!value.source) return value.name;
    Json json = Json::object();
    json["name"] = value.name;
    json["source"] = *value.source;
    return json;
}
Json toJsonValue(const Structure& value) {
    return value.json;
}

} // namespace

std::string_view toString(Type type) {
    switch (type) {
    case Type::Bool:
        return "bool";
    case Type::Int:
        return "int";
    case Type::Float:
        return "float";
    case Type::Vec2:
        return "vec2";
    case Type::Vec3:
        return "vec3";
    case Type::Vec4:
        return "vec4";
    case Type::Choice:
        return "choice";
    case Type::Text:
        return "text";
    case Type::Decimal3:
        return "decimal3";
    case Type::Module:
        return "module";
    case Type::Structure:
        return "structure";
    }
    return {};
}

std::string_view toString(Invalidates invalidates) {
    switch (invalidates) {
    case Invalidates::Nothing:
        return "nothing";
    case Invalidates::Present:
        return "present";
    case Invalidates::Samples:
        return "samples";
    case Invalidates::Program:
        return "program";
    }
    return {};
}

Value adapted(const Parameter& parameter, Value value) {
    if (parameter.type == Type::Float)
        if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
    if (parameter.type == Type::Module)
        if (auto* name = std::get_if<std::string>(&value)) return ModuleReference{std::move(*name), {}};
    return value;
}

void validate(const Parameter& parameter, const Value& value) {
    switch (parameter.type) {
    case Type::Bool:
        expect<bool>(value, "true or false");
        break;
    case Type::Int:
        checkNumber(parameter, static_cast<double>(expect<std::int64_t>(value, "a whole number")));
        break;
    case Type::Float:
        checkNumber(parameter, expect<double>(value, "a number"));
        break;
    case Type::Vec2:
        checkVector(parameter, expect<glm::dvec2>(value, "2 numbers"));
        break;
    case Type::Vec3:
        checkVector(parameter, expect<glm::dvec3>(value, "3 numbers"));
        break;
    case Type::Vec4:
        checkVector(parameter, expect<glm::dvec4>(value, "4 numbers"));
        break;
    case Type::Choice:
        checkChoice(parameter, expect<std::string>(value, "a label"));
        break;
    case Type::Text:
        if (!isUtf8(expect<std::string>(value, "a text"))) fail("expected a text in UTF-8");
        break;
    case Type::Decimal3:
        expect<Decimal3>(value, "3 decimal numbers");
        break;
    case Type::Module:
        if (expect<ModuleReference>(value, "the name of a module").name.empty())
            fail("expected the name of a module, got \"\"");
        break;
    case Type::Structure:
        if (parameter.check != nullptr) parameter.check(expect<Structure>(value, "a JSON value").json);
        break;
    }
}

Json toJson(const Value& value) {
    return std::visit([](const auto& typed) { return toJsonValue(typed); }, value);
}

Json toJson(const Parameter& parameter) {
    Json json = Json::object();
    json["name"] = parameter.name;
    json["type"] = toString(parameter.type);
    json["default"] = toJson(parameter.defaultValue);
    if (parameter.minimum) json["min"] = *parameter.minimum;
    if (parameter.maximum) json["max"] = *parameter.maximum;
    if (parameter.step) json["step"] = *parameter.step;
    if (!parameter.unit.empty()) json["unit"] = parameter.unit;
    if (!parameter.choices.empty()) json["choices"] = parameter.choices;
    if (!parameter.folder.empty()) json["folder"] = parameter.folder;
    if (!parameter.shorthand.empty()) json["shorthand"] = parameter.shorthand;
    json["invalidates"] = toString(parameter.invalidates);
    if (parameter.color) json["color"] = true;
    if (parameter.logarithmic) json["logarithmic"] = true;
    if (parameter.path) json["path"] = true;
    if (parameter.nonZero) json["nonZero"] = true;
    json["doc"] = parameter.doc;
    return json;
}

} // namespace apeiron::parameter
