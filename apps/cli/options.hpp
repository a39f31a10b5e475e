#pragma once

#include "commands.hpp"

#include "gpu/context.hpp"
#include "scene/scene.hpp"
#include "session/session.hpp"

#include <optional>
#include <string>
#include <vector>

// Options that several commands share.
namespace apeiron::cli {

/// Edits of the scene from the command line. Values are checked by the scene's own schema.
struct SceneOptions {
    std::optional<std::string> size, samples, time, noise, seed, firstSample, memory;
    std::vector<std::string> sets; ///< path=value

    void addTo(CLI::App& command);
    /// @throws Error (BadInput) that names the option.
    void apply(scene::Scene& scene) const;
};

/// Where to render.
struct DeviceOptions {
    std::string device = "auto";
    std::string stage = "auto";

    void addTo(CLI::App& command);
    /// @throws Error (BadInput) that names the option.
    gpu::ContextOptions context() const;
    std::optional<gpu::Stage> chosenStage() const;
};

/// A whole number in a range. @throws Error (BadInput) that names the option.
std::int64_t wholeNumber(const std::string& option, const std::string& text, std::int64_t least, std::int64_t most);

/// A number greater than 0. @throws Error (BadInput) that names the option.
double positiveNumber(const std::string& option, const std::string& text);

} // namespace apeiron::cli
