#include "core/error.hpp"
#include "core/suggest.hpp"
#include "scene/node_reading.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <variant>

// Scene::set(): one value of the document by its path.
namespace apeiron::scene {
namespace {

using parameter::Invalidates;
using parameter::JsonSource;
using parameter::Node;
using parameter::NodeType;

using Keys = std::span<const std::string>;
/// Command-line text or JSON.
using Input = std::variant<std::string_view, const Json*>;

[[noreturn]] void fail(const std::string& what, const std::string& hint = {}) {
    throw Error(ErrorKind::BadInput, what, {}, hint);
}

/// `lights[0].color` and `lights.0.color` as {"lights", "0", "color"}.
std::vector<std::string> splitPath(std::string_view path) {
    std::string dotted;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] == '[') {
            if (!dotted.empty()) dotted += '.';
        } else if (path[i] != ']') {
            dotted += path[i];
        } else if (i + 1 < path.size() && path[i + 1] != '.' && path[i + 1] != '[') {
            fail("expected '.' or '[' after ']'");
        }
    }
    std::vector<std::string> keys(1);
    for (const char c : dotted) {
        if (c == '.')
            keys.emplace_back();
        else
            keys.back() += c;
    }
    if (std::find(keys.begin(), keys.end(), "") != keys.end()) fail("expected a path such as camera.fov");
    return keys;
}

/// One of the scene's lists of nodes.
struct List {
    std::vector<Node>& nodes;
    std::string role;
    std::size_t limit;
    Invalidates structure; ///< as difference() takes it
};

/// Performs one edit on a scene, which is left as it was by an edit that throws.
class Edit {
  public:
    Edit(Scene& scene, const Input& input, const std::filesystem::path& base)
        : scene_(scene),
          input_(input), context_{scene.catalogue(), [](const std::string& pointer) { return pointer; }, base} {}

    Invalidates perform(Keys keys) {
        const std::string& key = keys.front();
        const Keys rest = keys.subspan(1);
        if (key == "title") return setTitle(rest);
        if (key == "lights") return setList({scene_.lights, "light", Scene::kMaxLights, Invalidates::Samples}, rest);
        if (key == "post" && rest.empty()) return replaceWithList(scene_.post, "effects", effects());
        if (key == "subject" && rest.empty()) return replaceWithList(scene_.subject, "slots", slots());
        if (key == "post" && rest.front() == "effects") return setList(effects(), rest.subspan(1));
        if (key == "subject" && rest.front() == "slots") return setList(slots(), rest.subspan(1));
        if (key == "subject" && rest.size() == 1 && rest.front() == "type") return setSubjectType(rest);
        for (const auto& [name, node] :
             {std::pair("camera", &scene_.camera), std::pair("subject", &scene_.subject),
              std::pair("renderer", &scene_.renderer), std::pair("environment", &scene_.environment),
              std::pair("post", &scene_.post), std::pair("output", &scene_.output)})
            if (key == name) return setNode(*node, rest);
        static const std::vector<std::string> known{"title",  "camera",      "subject", "renderer",
                                                    "lights", "environment", "post",    "output"};
        fail("unknown part '" + key + "'", suggestion(key, known));
    }

  private:
    Json json() const {
        if (const auto* given = std::get_if<const Json*>(&input_)) return **given;
        return JsonSource::parse("value", std::string(std::get<std::string_view>(input_))).root();
    }

    std::string text() const {
        parameter::Parameter any;
        any.type = parameter::Type::Text;
        if (const auto* given = std::get_if<const Json*>(&input_))
            return std::get<std::string>(parameter::valueFromJson(any, **given));
        return std::get<std::string>(parameter::valueFromText(any, std::get<std::string_view>(input_)));
    }

    Invalidates setTitle(Keys rest) {
        if (!rest.empty()) fail("the title has no parts");
        scene_.title = text();
        return Invalidates::Nothing;
    }

    /// The node itself, its type, or one of its parameters.
    Invalidates setNode(Node& node, Keys rest) {
        if (rest.empty()) return replace(node, readNode(context_, node.type().role, json(), ""));
        if (rest.size() > 1) return setInside(node, rest[0], rest.subspan(1));
        if (rest[0] == "type" && !node.type().name.empty()) {
            const std::shared_ptr<const NodeType> type = typeNamed(node.type().role);
            if (type->name == node.type().name) return Invalidates::Nothing;
            node = Node(type);
            return Invalidates::Program;
        }
        if (const auto* given = std::get_if<const Json*>(&input_))
            return node.setFromJson(rest[0], **given, context_.base);
        return node.setFromText(rest[0], std::get<std::string_view>(input_), context_.base);
    }

    /// A part of a Structure: `subject.transfer.window.width`, `subject.transfer.points.2.opacity`.
    Invalidates setInside(Node& node, const std::string& name, Keys keys) {
        const parameter::Parameter& parameter = node.schema().at(name);
        if (parameter.type != parameter::Type::Structure) fail("'" + name + "' has no parts");
        Json whole = node.get<parameter::Structure>(name).json;
        if (whole.is_string() && !parameter.shorthand.empty()) whole = Json{{parameter.shorthand, whole}};
        Json* parent = &whole;
        for (const std::string& key : keys.first(keys.size() - 1))
            parent = &member(*parent, key);
        const Json value = jsonOrText();
        if (value.is_null())
            remove(*parent, keys.back());
        else
            member(*parent, keys.back()) = value;
        return node.set(name, parameter::Structure{std::move(whole)}, context_.base);
    }

    static std::size_t elementOf(const Json& list, const std::string& key) {
        const bool digits = std::all_of(key.begin(), key.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (!digits) fail("expected a number of an element, got " + inQuotes(key));
        const std::size_t index = key.size() > 6 ? std::size_t{1'000'000} : std::stoul(key);
        if (index > list.size())
            fail("there is no element " + key, std::to_string(list.size()) + " there, counted from 0");
        return index;
    }

    /// A member or element; a new one where it is missing, as the last one of a list.
    static Json& member(Json& parent, const std::string& key) {
        if (parent.is_array()) {
            const std::size_t index = elementOf(parent, key);
            if (index == parent.size()) parent.push_back(nullptr);
            return parent[index];
        }
        if (!parent.is_object() && !parent.is_null()) fail("there is nothing inside " + inQuotes(parent.dump()));
        return parent[key];
    }

    static void remove(Json& parent, const std::string& key) {
        if (parent.is_array()) {
            const std::size_t index = elementOf(parent, key);
            if (index < parent.size()) parent.erase(parent.begin() + static_cast<std::ptrdiff_t>(index));
        } else if (parent.is_object()) {
            parent.erase(key);
        }
    }

    /// JSON where the input is JSON, else a text.
    Json jsonOrText() const {
        if (const auto* given = std::get_if<const Json*>(&input_)) return **given;
        const std::string_view words = std::get<std::string_view>(input_);
        Json value = Json::parse(words.begin(), words.end(), nullptr, false);
        return value.is_discarded() ? Json(std::string(words)) : value;
    }

    std::shared_ptr<const NodeType> typeNamed(const std::string& role) const {
        const std::string name = text();
        if (name.empty()) fail("expected the name of a type");
        return scene_.catalogue().type(role, name);
    }

    static Invalidates replace(Node& node, Node changed) {
        const Invalidates result = difference(node, changed);
        node = std::move(changed);
        return result;
    }

    List effects() { return {scene_.effects, "effect", Scene::kMaxEffects, Invalidates::Present}; }
    List slots() { return {scene_.slots, "slot", Scene::kMaxSlots, Invalidates::Program}; }

    /// Replaces a node together with the list that is written among its parameters.
    Invalidates replaceWithList(Node& node, const std::string& key, const List& list) {
        const std::vector<std::string> otherKeys{key};
        const Json value = json();
        Node changed = readNode(context_, node.type().role, value, "", otherKeys);
        std::vector<Node> nodes;
        if (value.contains(key)) nodes = readNodes(context_, list.role, value[key], "/" + key, list.limit);
        const Invalidates result = difference(list.nodes, nodes, list.structure);
        list.nodes = std::move(nodes);
        return strongest(result, replace(node, std::move(changed)));
    }

    /// Another type of subject has no use for the old one's slots.
    Invalidates setSubjectType(Keys rest) {
        const Invalidates result = setNode(scene_.subject, rest);
        if (result != Invalidates::Nothing) scene_.slots.clear();
        return result;
    }

    Invalidates setList(const List& list, Keys rest) {
        if (rest.empty()) {
            std::vector<Node> nodes = readNodes(context_, list.role, json(), "", list.limit);
            const Invalidates result = difference(list.nodes, nodes, list.structure);
            list.nodes = std::move(nodes);
            return result;
        }
        const std::size_t index = indexIn(list, rest[0]);
        if (index == list.nodes.size()) return append(list, rest.subspan(1));
        if (rest.size() == 1 && json().is_null()) {
            list.nodes.erase(list.nodes.begin() + static_cast<std::ptrdiff_t>(index));
            return list.structure;
        }
        return std::min(setNode(list.nodes[index], rest.subspan(1)), list.structure);
    }

    static std::size_t indexIn(const List& list, const std::string& key) {
        const bool digits = std::all_of(key.begin(), key.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (!digits) fail("expected a number of a " + list.role + ", got " + inQuotes(key));
        const std::size_t index = key.size() > 6 ? std::size_t{1'000'000} : std::stoul(key);
        if (index > list.nodes.size())
            fail("there is no " + list.role + " " + key, std::to_string(list.nodes.size()) + " there, counted from 0");
        return index;
    }

    /// What decides which node of its role this is: its type, or else its module.
    static std::string chooserOf(const NodeType& type) {
        if (type.name.empty())
            for (const parameter::Parameter& parameter : type.parameters)
                if (parameter.type == parameter::Type::Module) return parameter.name;
        return "type";
    }

    Invalidates append(const List& list, Keys rest) {
        if (list.nodes.size() >= list.limit) throw tooMany(list.role, list.limit);
        if (rest.empty()) {
            list.nodes.push_back(readNode(context_, list.role, json(), ""));
            return list.structure;
        }
        Node node(scene_.catalogue().type(list.role, ""));
        const std::string chooser = chooserOf(node.type());
        if (rest.size() > 1 || rest[0] != chooser)
            fail("there is no " + list.role + " " + std::to_string(list.nodes.size()),
                 "set its ." + chooser + " first");
        setNode(node, rest);
        list.nodes.push_back(std::move(node));
        return list.structure;
    }

    Scene& scene_;
    Input input_;
    ReadContext context_;
};

Invalidates setPath(Scene& scene, std::string_view path, const Input& input, const std::filesystem::path& base) {
    try {
        const std::vector<std::string> keys = splitPath(path);
        return Edit(scene, input, base).perform(keys);
    } catch (const Error& error) {
        throw error.at(std::string(path));
    }
}

} // namespace

Invalidates Scene::set(std::string_view path, std::string_view text, const std::filesystem::path& base) {
    return setPath(*this, path, text, base);
}

Invalidates Scene::set(std::string_view path, const Json& value, const std::filesystem::path& base) {
    return setPath(*this, path, &value, base);
}

} // namespace apeiron::scene
