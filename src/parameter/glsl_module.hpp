#pragma once

#include "parameter/parameter.hpp"

#include <filesystem>
#include <map>

namespace apeiron::parameter {

/// A GLSL source file that declares its own parameters: a formula, renderer, environment, effect, tone mapper.
///
/// The file documents itself: the leading `///` lines are its doc, annotated uniforms its parameters,
/// and `#pragma apeiron KEY VALUE...` lines its tags (`provides surface`, `needs surface`, ...).
struct GlslModule {
    std::string name;                        ///< "mandelbulb"; what the scene document says
    std::string file;                        ///< for messages: "fractal/formulas/mandelbulb.glsl" or the user's path
    std::string source;                      ///< the whole text
    std::string doc;                         ///< the leading `///` block without the slashes, lines joined by '\n'
    std::vector<Parameter> parameters;       ///< of the annotated uniforms, in order
    std::map<std::string, std::string> tags; ///< of the `#pragma apeiron` lines
    bool embedded = true;                    ///< false for a user's own file or source
};

/// Parses a module's text. Annotation grammar (one uniform on a line, the rest in any order):
///
///     uniform TYPE NAME; //! DEFAULT [MIN, MAX] {LABEL, ...} step S unit U log color
///                            invalidates nothing|present|samples|program | DOC
///
/// DEFAULT is a number, true/false, (x, y, z) or a label; {LABEL, ...} makes an int a Choice. A uniform without an
/// annotation is the engine's own and is no parameter. Lines below with nothing but a `//!` comment continue the
/// annotation. Where it says nothing of `invalidates`, `#pragma apeiron invalidates X` decides for the whole
/// file, else it is samples. `#pragma apeiron picture NAME` declares a Text NAME with the file of the module's
/// `uniform sampler2D picture` (environments only). Repeated tags are joined by spaces.
/// @throws Error (BadInput) at file:line.
GlslModule parseModule(std::string name, std::string file, std::string source);

/// Finds `reference` among the embedded `<folder>/` modules, or reads it as a file when it looks like a path
/// (has a '/' or ends in .glsl; relative to `base`), or takes the source it carries.
/// @throws Error (BadInput or Io), with the nearest name as a hint.
GlslModule loadModule(std::string_view folder, const ModuleReference& reference,
                      const std::filesystem::path& base = {});

/// Names of the embedded modules of a folder, sorted.
std::vector<std::string> moduleNames(std::string_view folder);

} // namespace apeiron::parameter
