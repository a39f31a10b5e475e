#include "parameter/node.hpp"

#include "core/error.hpp"
#include "core/resources.hpp"

#include <algorithm>
#include <cassert>

namespace apeiron::parameter {
namespace {

std::shared_ptr<const GlslModule> loadOwnFile(const std::string& path) {
    const std::optional<Resource> resource = findResource(path);
    if (!resource) throw Error(ErrorKind::BadInput, "there is no embedded file " + inQuotes(path));
    const std::string stem = std::filesystem::path(path).stem().string();
    return std::make_shared<const GlslModule>(parseModule(stem, path, std::string(resource->text)));
}

/// How a node remembers a module. A user's carries its source: the document must not depend on a file that may go.
ModuleReference referenceTo(const GlslModule& module) {
    if (module.embedded) return {module.name, {}};
    return {module.name, module.source};
}

bool isValid(const Parameter& parameter, const Value& value) {
    try {
        validate(parameter, value);
        return true;
    } catch (const Error&) {
        return false;
    }
}

} // namespace

Node::Node(std::shared_ptr<const NodeType> type) : type_(std::move(type)) {
    assert(type_);
    for (const std::string& path : type_->glsl)
        files_.push_back(loadOwnFile(path));
    for (const Parameter& parameter : type_->parameters) {
        if (parameter.type != Type::Module) continue;
        const Value reference = adapted(parameter, parameter.defaultValue);
        validate(parameter, reference);
        modules_[parameter.name] =
            std::make_shared<const GlslModule>(loadModule(parameter.folder, std::get<ModuleReference>(reference)));
    }
    rebuildSchema();
}

int Node::choice(std::string_view name) const {
    const Parameter* parameter = schema_.find(name);
    assert(parameter != nullptr && parameter->type == Type::Choice);
    const auto label = std::find(parameter->choices.begin(), parameter->choices.end(), text(name));
    return static_cast<int>(label - parameter->choices.begin());
}

const Value& Node::value(std::string_view name) const {
    const auto found = values_.find(name);
    assert(found != values_.end());
    return found->second;
}

Invalidates Node::set(std::string_view name, Value value, const std::filesystem::path& base) {
    const Parameter& parameter = schema_.at(name);
    const Invalidates invalidates = parameter.invalidates;
    value = adapted(parameter, std::move(value));
    validate(parameter, value);
    const auto current = values_.find(name);
    assert(current != values_.end());

    if (parameter.path) {
        auto& text = std::get<std::string>(value);
        const std::filesystem::path file(text);
        // (A bare word may be something's name.)
        if (text.find_first_of("./") != std::string::npos && !base.empty() && file.is_relative())
            text = (base / file).lexically_normal().string();
    }
    if (parameter.type != Type::Module) {
        if (current->second == value) return Invalidates::Nothing;
        current->second = std::move(value);
        return invalidates;
    }

    auto module =
        std::make_shared<const GlslModule>(loadModule(parameter.folder, std::get<ModuleReference>(value), base));
    if (std::get<ModuleReference>(current->second) == referenceTo(*module)) return Invalidates::Nothing;
    Node changed = *this;
    changed.modules_.find(name)->second = std::move(module);
    changed.rebuildSchema();
    *this = std::move(changed);
    return invalidates;
}

Invalidates Node::setFromText(std::string_view name, std::string_view text, const std::filesystem::path& base) {
    return set(name, valueFromText(schema_.at(name), text), base);
}

Invalidates Node::setFromJson(std::string_view name, const Json& json, const std::filesystem::path& base) {
    return set(name, valueFromJson(schema_.at(name), json), base);
}

const GlslModule& Node::module(std::string_view name) const {
    const auto found = modules_.find(name);
    assert(found != modules_.end());
    return *found->second;
}

const GlslModule& Node::file(std::string_view path) const {
    const auto found =
        std::find_if(files_.begin(), files_.end(), [&](const auto& module) { return module->file == path; });
    assert(found != files_.end());
    return **found;
}

Json Node::toJson(bool all) const {
    Json json = Json::object();
    if (!type_->name.empty()) json["type"] = type_->name;
    for (const Parameter& parameter : schema_) {
        const Value& current = value(parameter.name);
        // Which node of a list this is should be seen, whatever the default.
        if (all || parameter.name == "type" || current != parameter.defaultValue)
            json[parameter.name] = parameter::toJson(current);
    }
    return json;
}

bool Node::operator==(const Node& other) const {
    return type_->role == other.type_->role && type_->name == other.type_->name && values_ == other.values_;
}

void Node::rebuildSchema() {
    Schema schema;
    schema.add(type_->parameters);
    for (const auto& file : files_)
        schema.add(file->parameters);
    for (const Parameter& parameter : type_->parameters)
        if (parameter.type == Type::Module) schema.add(modules_.find(parameter.name)->second->parameters);
    assert(type_->name.empty() || schema.find("type") == nullptr); // the JSON key is taken

    std::map<std::string, Value, std::less<>> values;
    for (const Parameter& parameter : schema) {
        Value& value = values[parameter.name] = parameter.defaultValue;
        if (parameter.type == Type::Module) {
            value = referenceTo(*modules_.find(parameter.name)->second);
            continue;
        }
        const Parameter* old = schema_.find(parameter.name);
        const auto current = values_.find(parameter.name);
        if (old == nullptr || current == values_.end() || current->second == old->defaultValue) continue;
        if (isValid(parameter, current->second)) value = current->second;
    }
    schema_ = std::move(schema);
    values_ = std::move(values);
}

} // namespace apeiron::parameter
