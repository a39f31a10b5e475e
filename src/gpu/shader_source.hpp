#pragma once

#include "parameter/node.hpp"

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace apeiron::gpu {

/// A uniform that gets its value from a parameter of a node.
struct UniformBinding {
    std::string uniform;   ///< name in the shader, prefix included
    std::string parameter; ///< name in the node
    std::string slot;      ///< which node: "subject", "renderer", "effect", ...
};

/// GLSL put together from files: resolves includes, gives modules names of their own, turns Program parameters into
/// constants, and remembers which file each line came from. Knows no GL.
class ShaderSource {
  public:
    /// Adds an embedded file (path relative to src/) and, once each, the files it includes
    /// (`#include "gpu/glsl/x.glsl"`, relative to src/). @throws Error (BadInput) at file:line for a missing include.
    void addFile(std::string_view path);

    /// Adds text of the engine's own making.
    void addText(const std::string& name, const std::string& text);

    /// Which names of a module get its prefix.
    enum class Rename {
        All,        ///< everything it declares at global scope, except `kernel_main`: a chosen module
        Everything, ///< `kernel_main` as well: a module that a kernel calls
        Parameters, ///< its parameters only: a file that implements an interface by name
    };

    /// Adds a module, with `prefix` before its names, so that modules never collide. Its parameters of class Program,
    /// or all of them if `specialise`, become constants with `node`'s values; the others are bound to `slot`. A module
    /// that was added before with that prefix, or as a file, is not added again.
    void addModule(const parameter::GlslModule& module, const std::string& prefix, const parameter::Node& node,
                   const std::string& slot, bool specialise, Rename rename = Rename::All);

    const std::string& text() const { return text_; }
    /// file:line of a line of text(), from 1.
    std::string placeOf(int line) const;
    const std::vector<UniformBinding>& bindings() const { return bindings_; }
    /// The parameters behind a kernel's `kernel_main(ivec2 pixel, out TYPE NAME, ...)`: its outputs, in order.
    struct Output {
        std::string type;
        std::string name;
    };
    std::vector<Output> outputs() const;

    /// Rewrites a compiler's log, whose lines count from the first of text(), so that places read file:line. A user's
    /// file that is no place of an error itself but does not fit the engine's is named first.
    std::string mapLog(const std::string& log) const;
    /// Whether a user's file is the reason for the errors of the log: the engine's own have none without it.
    bool blamesUser(const std::string& log) const;

  private:
    struct File {
        std::string name;
        bool embedded;
    };
    /// Where a line of text_ came from.
    struct Place {
        std::size_t file;
        int line;
    };
    struct Mistake {
        Place place;
        std::string message;
    };
    std::vector<Mistake> parseLog(const std::string& log) const;
    void append(const std::string& name, bool embedded, const std::string& text);

    std::vector<File> files_;
    std::vector<Place> places_; ///< of each line of text_
    std::set<std::string, std::less<>> included_;
    std::vector<UniformBinding> bindings_;
    std::string text_;
};

/// `text` with comments blanked out; line breaks stay.
std::string withoutComments(std::string_view text);

/// Names that GLSL text declares at global scope: functions, uniforms, constants, structs, macros.
std::set<std::string> globalNames(std::string_view text);

/// `text` with each of `names` that is not a member (`.name`) renamed to prefix + name.
std::string withPrefix(std::string_view text, const std::set<std::string>& names, const std::string& prefix);

/// A value as a GLSL expression of its parameter's type.
std::string glslLiteral(const parameter::Parameter& parameter, const parameter::Value& value);

} // namespace apeiron::gpu
