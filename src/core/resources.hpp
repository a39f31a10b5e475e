#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace apeiron {

/// A text file of src/ or scenes/ that the build put into the program: GLSL and example scenes.
struct Resource {
    std::string_view path; ///< relative to src/ ("fractal/formulas/mandelbulb.glsl") or "scenes/x.json"
    std::string_view text; ///< its content; lives as long as the program
};

/// All embedded files, sorted by path.
const std::vector<Resource>& resources();

/// The embedded file of that path, if there is one.
std::optional<Resource> findResource(std::string_view path);

/// The embedded `<anything>/<folder>/<name><extension>` files, sorted by name: how formulas, renderers, effects,
/// tone mappers and environments are found without any list of them.
std::vector<Resource> resourcesInFolder(std::string_view folder, std::string_view extension = ".glsl");

} // namespace apeiron
