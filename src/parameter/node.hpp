#pragma once

#include "parameter/glsl_module.hpp"
#include "parameter/schema.hpp"

#include <memory>

namespace apeiron::parameter {

/// What a node of the scene document can be: a role ("light"), a type within it ("sun"), its parameters.
struct NodeType {
    std::string role; ///< "camera", "subject", "light", ...
    std::string name; ///< the JSON key "type"; empty when the role has this one type only
    std::string doc;
    std::vector<Parameter> parameters; ///< host parameters; Module ones pull in their module's parameters
    std::vector<std::string> glsl;     ///< embedded files whose annotated uniforms belong to the type
};

/// A set of parameter values with their schema: the host parameters of its type, the annotated uniforms of the type's
/// GLSL files, and those of the modules chosen by its Module parameters. Copyable; cheap to copy.
class Node {
  public:
    /// All parameters at their defaults. @throws Error (BadInput) when a GLSL file or default module is missing or
    /// wrong.
    explicit Node(std::shared_ptr<const NodeType> type);

    const NodeType& type() const { return *type_; }
    const Schema& schema() const { return schema_; }

    /// The current value. @pre the parameter exists and has that type (asserted).
    template <class T> const T& get(std::string_view name) const { return std::get<T>(value(name)); }
    bool flag(std::string_view name) const { return get<bool>(name); }
    std::int64_t integer(std::string_view name) const { return get<std::int64_t>(name); }
    double number(std::string_view name) const { return get<double>(name); }
    const std::string& text(std::string_view name) const { return get<std::string>(name); }
    const glm::dvec3& vec3(std::string_view name) const { return get<glm::dvec3>(name); }
    /// The index of a Choice's current label.
    int choice(std::string_view name) const;
    const Value& value(std::string_view name) const;

    /// Sets one parameter and says what that makes stale (Nothing when the value is the same).
    /// Setting a Module loads it (relative to `base`), replaces the old module's parameters, and keeps the values of
    /// parameters that both have where they were changed and are still valid; untouched ones take the new module's
    /// defaults. A user's module is stored with its source, so that the node no longer depends on the file.
    /// Nothing changes when it throws. @throws Error (BadInput, Io); the caller adds the place.
    Invalidates set(std::string_view name, Value value, const std::filesystem::path& base = {});
    Invalidates setFromText(std::string_view name, std::string_view text, const std::filesystem::path& base = {});
    Invalidates setFromJson(std::string_view name, const Json& json, const std::filesystem::path& base = {});

    /// The module chosen by a Module parameter. @pre the parameter exists and is a Module.
    const GlslModule& module(std::string_view name) const;
    /// The type's own GLSL files, in order.
    const std::vector<std::shared_ptr<const GlslModule>>& files() const { return files_; }

    /// One of them, by its path. @pre the type has it (asserted).
    const GlslModule& file(std::string_view path) const;

    /// Values as a JSON object, in schema order, `type` first; parameters at their default only if `all`, except
    /// `type`, which is always there. Users' own modules are saved with their source.
    Json toJson(bool all = false) const;

    bool operator==(const Node& other) const;

  private:
    void rebuildSchema();

    std::shared_ptr<const NodeType> type_;
    std::vector<std::shared_ptr<const GlslModule>> files_;
    std::map<std::string, std::shared_ptr<const GlslModule>, std::less<>> modules_;
    Schema schema_;
    std::map<std::string, Value, std::less<>> values_;
};

} // namespace apeiron::parameter
