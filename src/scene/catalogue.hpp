#pragma once

#include "parameter/node.hpp"

namespace apeiron::scene {

/// Which node types exist. The scene's own (camera, lights, environment, renderer, post, output) are always there;
/// subjects are added from above, so that the document knows none of them.
class Catalogue {
  public:
    Catalogue();

    void add(parameter::NodeType type);

    /// Whether a scene holds a list of nodes of that role (slots, lights, effects).
    static bool isList(std::string_view role);

    /// The types of a role ("light"), in the order they were added; empty for an unknown role.
    const std::vector<std::shared_ptr<const parameter::NodeType>>& types(std::string_view role) const;
    /// An empty name means the first type. @throws Error (BadInput) for an unknown type name, with the nearest as a
    /// hint.
    std::shared_ptr<const parameter::NodeType> type(std::string_view role, std::string_view name) const;

    /// Every role, type, module and parameter as JSON: what `apeiron schema --json`, the panels and the docs read.
    ///
    /// { "version": 1, "roles": { ROLE: { "list": bool, "types": { TYPE: { "doc", "parameters": [...] } } } },
    ///   "modules": { FOLDER: { NAME: { "doc", "tags", "parameters": [...] } } } }
    ///
    /// TYPE is "" where the role has one type only: such nodes have no key "type", unless it is a Module parameter.
    /// A type's parameters are without those of its modules, which depend on the choice.
    Json toJson() const;

  private:
    std::map<std::string, std::vector<std::shared_ptr<const parameter::NodeType>>, std::less<>> types_;
};

} // namespace apeiron::scene
