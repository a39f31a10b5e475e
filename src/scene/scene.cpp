#include "scene/scene.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "scene/node_reading.hpp"

#include <algorithm>

namespace apeiron::scene {
namespace {

using parameter::JsonSource;
using parameter::Node;

void requireKnownKeys(const Json& root, const JsonSource& source) {
    static const std::vector<std::string> known{"apeiron", "title",       "camera", "subject", "renderer",
                                                "lights",  "environment", "post",   "output"};
    for (const auto& [key, value] : root.items())
        if (std::find(known.begin(), known.end(), key) == known.end())
            throw Error(ErrorKind::BadInput, "unknown key '" + key + "'", source.where(JsonSource::child("", key)),
                        suggestion(key, known));
}

void requireVersion(const Json& root, const JsonSource& source) {
    if (!root.contains("apeiron")) return;
    const Json& version = root["apeiron"];
    const std::string where = source.where("/apeiron");
    if (!version.is_number_integer() || version.get<std::int64_t>() < 1)
        throw Error(ErrorKind::BadInput, "expected the version of the document, a whole number from 1", where);
    if (version.get<std::int64_t>() > Scene::kVersion)
        throw Error(ErrorKind::BadInput,
                    "made by a newer version of Apeiron: document version " + version.dump() + ", this one reads " +
                        std::to_string(Scene::kVersion),
                    where, "update Apeiron");
}

Json toJson(const std::vector<Node>& nodes, bool all) {
    Json array = Json::array();
    for (const Node& node : nodes)
        array.push_back(node.toJson(all));
    return array;
}

} // namespace

Scene::Scene(std::shared_ptr<const Catalogue> catalogue)
    : camera(catalogue->type("camera", "")), subject(catalogue->type("subject", "")),
      renderer(catalogue->type("renderer", "")), lights{Node(catalogue->type("light", "sun"))},
      environment(catalogue->type("environment", "")), post(catalogue->type("post", "")),
      output(catalogue->type("output", "")), catalogue_(std::move(catalogue)) {}

Scene Scene::fromJson(std::shared_ptr<const Catalogue> catalogue, const JsonSource& source,
                      const std::filesystem::path& base) {
    Scene scene(std::move(catalogue));
    const Json& root = source.root();
    const ReadContext context{*scene.catalogue_, [&](const std::string& pointer) { return source.where(pointer); },
                              base};
    requireObject(context, root, "");
    requireVersion(root, source); // first: a newer document may well have keys that are unknown here
    requireKnownKeys(root, source);

    if (root.contains("title")) {
        if (!root["title"].is_string())
            throw Error(ErrorKind::BadInput, "expected a text, got " + root["title"].dump(), source.where("/title"));
        scene.title = root["title"].get<std::string>();
    }
    const auto read = [&](Node& node, const std::string& key, std::span<const std::string> otherKeys = {}) {
        if (root.contains(key)) node = readNode(context, key, root[key], "/" + key, otherKeys);
    };
    read(scene.camera, "camera");
    const std::vector<std::string> otherSubjectKeys{"slots"};
    read(scene.subject, "subject", otherSubjectKeys);
    read(scene.renderer, "renderer");
    read(scene.environment, "environment");
    read(scene.output, "output");
    const std::vector<std::string> otherPostKeys{"effects"};
    read(scene.post, "post", otherPostKeys);
    if (root.contains("subject") && root["subject"].contains("slots"))
        scene.slots = readNodes(context, "slot", root["subject"]["slots"], "/subject/slots", kMaxSlots);
    if (root.contains("lights")) scene.lights = readNodes(context, "light", root["lights"], "/lights", kMaxLights);
    if (root.contains("post") && root["post"].contains("effects"))
        scene.effects = readNodes(context, "effect", root["post"]["effects"], "/post/effects", kMaxEffects);
    return scene;
}

Scene Scene::parse(std::shared_ptr<const Catalogue> catalogue, const std::string& file, const std::string& text,
                   const std::filesystem::path& base) {
    return fromJson(std::move(catalogue), JsonSource::parse(file, text), base);
}

Json Scene::toJson(bool all) const {
    Json json = Json::object();
    json["apeiron"] = kVersion;
    if (all || !title.empty()) json["title"] = title;
    const auto write = [&](const char* key, Json part) {
        if (all || !part.empty()) json[key] = std::move(part);
    };
    write("camera", camera.toJson(all));
    Json shown = subject.toJson(all);
    if (all || !slots.empty()) shown["slots"] = scene::toJson(slots, all);
    write("subject", std::move(shown));
    write("renderer", renderer.toJson(all));
    json["lights"] = scene::toJson(lights, all); // also an empty list: left out, it would mean one sun
    write("environment", environment.toJson(all));
    Json chain = post.toJson(all);
    if (all || !effects.empty()) chain["effects"] = scene::toJson(effects, all);
    write("post", std::move(chain));
    write("output", output.toJson(all));
    return json;
}

bool Scene::operator==(const Scene& other) const {
    return title == other.title && camera == other.camera && subject == other.subject && slots == other.slots &&
           renderer == other.renderer && lights == other.lights && environment == other.environment &&
           post == other.post && effects == other.effects && output == other.output;
}

parameter::Invalidates difference(const Node& from, const Node& to) {
    if (from == to) return parameter::Invalidates::Nothing;
    if (from.type().name != to.type().name) return parameter::Invalidates::Program;
    parameter::Invalidates result = parameter::Invalidates::Nothing;
    // Of parameters that only one of them has, the module that brings them says enough.
    for (const parameter::Parameter& parameter : from.schema())
        if (to.schema().find(parameter.name) != nullptr && from.value(parameter.name) != to.value(parameter.name))
            result = strongest(result, parameter.invalidates);
    return result;
}

parameter::Invalidates difference(const std::vector<Node>& from, const std::vector<Node>& to,
                                  parameter::Invalidates structure) {
    parameter::Invalidates result = from.size() == to.size() ? parameter::Invalidates::Nothing : structure;
    for (std::size_t i = 0; i < std::min(from.size(), to.size()); ++i)
        result = strongest(result, difference(from[i], to[i]));
    return std::min(result, structure);
}

parameter::Invalidates difference(const Scene& from, const Scene& to) {
    using parameter::Invalidates;
    Invalidates result = difference(from.lights, to.lights, Invalidates::Samples);
    result = strongest(result, difference(from.effects, to.effects, Invalidates::Present));
    result = strongest(result, difference(from.slots, to.slots, Invalidates::Program));
    for (const auto part :
         {&Scene::camera, &Scene::subject, &Scene::renderer, &Scene::environment, &Scene::post, &Scene::output})
        result = strongest(result, difference(from.*part, to.*part));
    return result;
}

parameter::Invalidates strongest(parameter::Invalidates a, parameter::Invalidates b) {
    return std::max(a, b);
}

} // namespace apeiron::scene
