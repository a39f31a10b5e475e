#pragma once

#include "gpu/kernel_cache.hpp"
#include "scene/scene.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace apeiron::render {

/// How kernels are put together.
struct BuildOptions {
    gpu::Stage stage = gpu::Stage::Fragment;
    /// Parameters become constants: faster kernels, but every edit compiles anew. Off while someone turns knobs.
    bool specialise = true;
};

/// A sphere around everything [world units].
struct Bounds {
    glm::dvec3 center{0.0};
    double radius = 0.0;
    glm::dvec3 front{0.0}; ///< direction from which it is best seen at first; 0: from anywhere
    /// Corners of what is seen, from the centre; empty: the sphere is all that is known.
    std::vector<glm::dvec3> corners;
};

/// What is around the camera.
struct Surroundings {
    double distance = std::numeric_limits<double>::infinity(); ///< to the nearest surface [world units]
    double freePart = 1.0;                                     ///< of the way, before the surface comes near, 0..1
};

/// Where a camera goes that flies by itself.
enum class Autopilot {
    Dive, ///< nearer to the surface, for ever: over ground that is worth seeing
    Rise, ///< backwards and up
};

/// What a flight did to the camera.
struct Flown {
    double scale = 1.0;             ///< new world units per old one
    std::optional<glm::dvec3> back; ///< from the new place to the old one [new units]; none: far away
};

/// What a scene shows: it gives GLSL for one or more interfaces (`surface`, `medium`, `field`, `raster`) and the
/// data behind it. Needs its context to be current.
class Subject {
  public:
    virtual ~Subject() = default;

    /// Whether the next update() does all there is to do, however long it takes: for pictures that nobody watches.
    virtual void setPatient(bool /*patient*/) {}

    /// Makes ready what a scene names (data, tables), before the functions below are called for it. Nothing changes
    /// when it throws. @throws Error
    virtual void prepare(const gpu::Context& /*context*/, const scene::Scene& /*scene*/) {}

    /// Where all of it is, for subjects with a size of their own: cameras that a scene says nothing of show that.
    virtual std::optional<Bounds> bounds() const { return {}; }

    /// The interfaces that it implements.
    virtual std::set<std::string> provides() const = 0;

    /// Adds GLSL that implements an interface. @throws Error (BadInput) for a user's file that lacks what is needed.
    virtual void addSource(gpu::ShaderSource& source, const scene::Scene& scene, const BuildOptions& options) const = 0;

    /// What that source depends on beside the scene's parameters: when this changes, kernels are made anew.
    virtual std::string variant() const { return {}; }

    /// Sets the uniforms and textures behind that source. Positions in the shader are relative to the camera.
    virtual void bind(gpu::Kernel& kernel, const scene::Scene& scene) const = 0;

    /// Whether what the camera sees is drawn, with one place in the pixel (and on the lens) for all pixels of a sample:
    /// prepare() once after each edit, draw() before each sample.
    virtual bool draws() const { return false; }
    /// Makes ready what will be drawn and what bind() hands over. @throws Error (BadInput) for what cannot be drawn.
    virtual void prepare(const gpu::Context& /*context*/, gpu::KernelCache& /*kernels*/, gpu::Stage /*stage*/,
                         const scene::Scene& /*scene*/, glm::ivec2 /*size*/) const {}
    /// Draws, into textures of its own. @param shift within the pixel [px, y down] @param lens a point of the lens of
    /// radius 1
    virtual void draw(glm::vec2 /*shift*/, glm::vec2 /*lens*/) const {}

    /// After a move of the camera: changes the scene's units where others fit the place better, in subjects without a
    /// limit in depth. The picture stays the same. @returns new units per old one, where it changed them
    virtual std::optional<double> rebase(scene::Scene& /*scene*/) const { return std::nullopt; }

    /// Moves the scene's camera, and changes its units like rebase(), by itself: never through a surface.
    /// @param speed [distances to the surface per second] @param seconds [s]; long times are flown in many small steps
    /// @returns what it did; nothing in subjects without an autopilot. @throws Error (BadInput) as prepare()
    virtual std::optional<Flown> autopilot(scene::Scene& /*scene*/, Autopilot /*way*/, double /*speed*/,
                                           double /*seconds*/) const {
        return std::nullopt;
    }

    /// How large what is around the camera is, as a power of ten of what an address begins with: in subjects without a
    /// limit in depth, whose units change (see rebase()).
    virtual std::optional<double> scalePower() const { return std::nullopt; }

    /// What it counts, for statistics: names and values of now.
    virtual std::vector<std::pair<std::string, double>> counters() const { return {}; }

    /// What is around the camera, where the subject knows that itself (see Renderer::lookAround()).
    virtual std::optional<Surroundings> lookAround(const scene::Scene& /*scene*/, glm::vec3 /*way*/) const {
        return std::nullopt;
    }

    /// What someone should know about how a scene is shown, one sentence each: a choice that has no effect, a fallback.
    virtual std::vector<std::string> notes(const scene::Scene& /*scene*/) const { return {}; }

    /// Background work (streaming, rebuilding), at most `budget` seconds. True when the picture is stale because of it.
    virtual bool update(const scene::Scene& /*scene*/, double /*budget*/) { return false; }
    /// Whether update() has more to do before the picture is what the scene says.
    virtual bool busy() const { return false; }
};

/// A kind of subject: what the catalogue learns of it, and how to make one.
struct SubjectType {
    parameter::NodeType node;
    std::vector<parameter::NodeType> parts; ///< nodes of other roles that only it has a use for
    std::unique_ptr<Subject> (*create)();
};

} // namespace apeiron::render
