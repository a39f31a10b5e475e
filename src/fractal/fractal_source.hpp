#pragma once

#include "gpu/shader_source.hpp"
#include "scene/scene.hpp"

#include <optional>

// The GLSL of a fractal, put together from formulas, slots and the loop around them.
namespace apeiron::fractal {

/// The file of a slot's own parameters.
constexpr const char* kSlotFile = "fractal/slot.glsl";

/// A formula of the sequence.
struct Turn {
    const parameter::Node& node;
    std::string slot;    ///< the node's name among the kernel's bindings
    std::string prefix;  ///< of the slot's own names
    std::string formula; ///< of the names of its formula
};

/// The subject's own formula and those of its slots, in the order of their turns. The scene must outlive them.
std::vector<Turn> turnsOf(const scene::Scene& scene);

/// Adds all that makes the subject a surface. Says why the maps cannot be differentiated, where finite differences had
/// to take the place of dual numbers. @throws Error (BadInput) for a formula that lacks something, or that cannot be
/// differentiated where that was asked for.
std::optional<std::string> addFractal(gpu::ShaderSource& source, const scene::Scene& scene, bool specialise);

} // namespace apeiron::fractal
