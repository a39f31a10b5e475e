#include "parameter/schema.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"

namespace apeiron::parameter {
namespace {

std::string placeOf(const Parameter& parameter) {
    return parameter.where.empty() ? "the engine" : parameter.where;
}

} // namespace

void Schema::add(Parameter parameter) {
    if (const Parameter* taken = find(parameter.name))
        throw Error(ErrorKind::BadInput,
                    "the parameter '" + parameter.name + "' is already declared in " + placeOf(*taken),
                    placeOf(parameter), "give it another name");
    if (parameter.type == Type::Module && parameter.invalidates == Invalidates::Samples)
        parameter.invalidates = Invalidates::Program;
    parameter.defaultValue = adapted(parameter, std::move(parameter.defaultValue));
    try {
        validate(parameter, parameter.defaultValue);
    } catch (const Error& error) {
        throw error.at("default of '" + parameter.name + "'").at(placeOf(parameter));
    }
    parameters_.push_back(std::move(parameter));
}

void Schema::add(const std::vector<Parameter>& parameters) {
    for (const Parameter& parameter : parameters)
        add(parameter);
}

const Parameter* Schema::find(std::string_view name) const {
    for (const Parameter& parameter : parameters_)
        if (parameter.name == name) return &parameter;
    return nullptr;
}

const Parameter& Schema::at(std::string_view name) const {
    if (const Parameter* parameter = find(name)) return *parameter;
    throw Error(ErrorKind::BadInput, "unknown parameter '" + std::string(name) + "'", {}, suggestion(name, names()));
}

std::vector<std::string> Schema::names() const {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters_)
        names.push_back(parameter.name);
    return names;
}

} // namespace apeiron::parameter
