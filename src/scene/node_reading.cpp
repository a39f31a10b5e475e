#include "scene/node_reading.hpp"

#include "core/suggest.hpp"
#include "parameter/json_source.hpp"

#include <algorithm>

namespace apeiron::scene {
namespace {

using parameter::JsonSource;
using parameter::Node;

/// The type that the JSON asks for, or the role's first one.
std::shared_ptr<const parameter::NodeType> readType(const ReadContext& context, std::string_view role, const Json& json,
                                                    const std::string& pointer) {
    auto first = context.catalogue.type(role, "");
    if (first->name.empty() || !json.contains("type")) return first;
    const Json& name = json["type"];
    const std::string where = context.where(JsonSource::child(pointer, "type"));
    if (!name.is_string()) throw Error(ErrorKind::BadInput, "expected the name of a type", where);
    try {
        return context.catalogue.type(role, name.get<std::string>());
    } catch (const Error& error) {
        throw error.at(where);
    }
}

} // namespace

void requireObject(const ReadContext& context, const Json& json, const std::string& pointer) {
    if (!json.is_object())
        throw Error(ErrorKind::BadInput, std::string("expected an object {...}, got ") + json.type_name(),
                    context.where(pointer));
}

Error tooMany(std::string_view role, std::size_t limit) {
    return {ErrorKind::BadInput, "at most " + std::to_string(limit) + " " + std::string(role) + "s are possible"};
}

Node readNode(const ReadContext& context, std::string_view role, const Json& json, const std::string& pointer,
              std::span<const std::string> otherKeys) {
    requireObject(context, json, pointer);
    Node node(readType(context, role, json, pointer));

    const auto isRead = [&](const std::string& key) {
        return (key == "type" && !node.type().name.empty()) ||
               std::find(otherKeys.begin(), otherKeys.end(), key) != otherKeys.end();
    };
    const auto set = [&](const std::string& key, const Json& value) {
        try {
            node.setFromJson(key, value, context.base);
        } catch (const Error& error) {
            throw error.at(context.where(JsonSource::child(pointer, key)));
        }
    };
    const auto isModule = [&](const std::string& key) {
        const parameter::Parameter* parameter = node.schema().find(key);
        return parameter != nullptr && parameter->type == parameter::Type::Module;
    };

    // Modules first, whatever the order of keys: they decide which other keys there are.
    for (const auto& [key, value] : json.items())
        if (!isRead(key) && isModule(key)) set(key, value);
    for (const auto& [key, value] : json.items()) {
        if (isRead(key) || isModule(key)) continue;
        if (node.schema().find(key) == nullptr) {
            std::vector<std::string> known = node.schema().names();
            known.insert(known.end(), otherKeys.begin(), otherKeys.end());
            if (!node.type().name.empty()) known.emplace_back("type");
            throw Error(ErrorKind::BadInput, "unknown parameter '" + key + "'",
                        context.where(JsonSource::child(pointer, key)), suggestion(key, known));
        }
        set(key, value);
    }
    return node;
}

std::vector<Node> readNodes(const ReadContext& context, std::string_view role, const Json& json,
                            const std::string& pointer, std::size_t limit) {
    if (!json.is_array())
        throw Error(ErrorKind::BadInput, std::string("expected a list [...], got ") + json.type_name(),
                    context.where(pointer));
    if (json.size() > limit) throw tooMany(role, limit).at(context.where(pointer));
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < json.size(); ++i)
        nodes.push_back(readNode(context, role, json[i], JsonSource::child(pointer, std::to_string(i))));
    return nodes;
}

} // namespace apeiron::scene
