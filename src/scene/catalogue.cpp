#include "scene/catalogue.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "scene/own_types.hpp"

#include <algorithm>
#include <cassert>
#include <set>

namespace apeiron::scene {

using parameter::NodeType;
using parameter::Parameter;
using parameter::Type;

namespace {

/// The order of roles in the document, which is also the order people think of them.
constexpr std::string_view kRoles[] = {"camera",      "subject", "slot",   "renderer", "light",
                                       "environment", "post",    "effect", "output"};

Json toJsonArray(const std::vector<Parameter>& parameters) {
    Json array = Json::array();
    for (const Parameter& parameter : parameters)
        array.push_back(parameter::toJson(parameter));
    return array;
}

Json toJsonType(const std::shared_ptr<const NodeType>& type) {
    Json json = Json::object();
    json["doc"] = type->doc;
    json["parameters"] = toJsonArray(type->parameters);
    const parameter::Node node(type);
    for (const auto& file : node.files())
        for (const Parameter& parameter : file->parameters)
            json["parameters"].push_back(parameter::toJson(parameter));
    return json;
}

Json toJsonFolder(std::string_view folder) {
    Json json = Json::object();
    for (const std::string& name : parameter::moduleNames(folder)) {
        const parameter::GlslModule module = parameter::loadModule(folder, {name, {}});
        Json tags = Json::object();
        for (const auto& [key, value] : module.tags)
            tags[key] = value;
        json[name] = {{"doc", module.doc}, {"tags", tags}, {"parameters", toJsonArray(module.parameters)}};
    }
    return json;
}

} // namespace

Catalogue::Catalogue() {
    for (NodeType& type : ownTypes())
        add(std::move(type));
}

bool Catalogue::isList(std::string_view role) {
    return role == "light" || role == "effect" || role == "slot";
}

void Catalogue::add(NodeType type) {
    assert(std::find(std::begin(kRoles), std::end(kRoles), type.role) != std::end(kRoles));
    auto& types = types_[type.role];
    types.push_back(std::make_shared<const NodeType>(std::move(type)));
}

const std::vector<std::shared_ptr<const NodeType>>& Catalogue::types(std::string_view role) const {
    static const std::vector<std::shared_ptr<const NodeType>> none;
    const auto found = types_.find(role);
    return found == types_.end() ? none : found->second;
}

std::shared_ptr<const NodeType> Catalogue::type(std::string_view role, std::string_view name) const {
    const auto& candidates = types(role);
    if (candidates.empty()) throw Error(ErrorKind::BadInput, "there are no types of " + std::string(role));
    if (name.empty()) return candidates.front();
    std::vector<std::string> names;
    for (const auto& candidate : candidates) {
        if (candidate->name == name) return candidate;
        names.push_back(candidate->name);
    }
    throw Error(ErrorKind::BadInput, "unknown " + std::string(role) + " type " + inQuotes(name), {},
                suggestion(name, names));
}

Json Catalogue::toJson() const {
    Json roles = Json::object();
    std::set<std::string> folders;
    for (const std::string_view role : kRoles) {
        Json typesJson = Json::object();
        for (const auto& type : types(role)) {
            typesJson[type->name] = toJsonType(type);
            for (const Parameter& parameter : type->parameters)
                if (parameter.type == Type::Module) folders.insert(parameter.folder);
        }
        roles[std::string(role)] = {{"list", isList(role)}, {"types", std::move(typesJson)}};
    }
    Json modules = Json::object();
    for (const std::string& folder : folders)
        modules[folder] = toJsonFolder(folder);
    return {{"version", 1}, {"roles", std::move(roles)}, {"modules", std::move(modules)}};
}

} // namespace apeiron::scene
