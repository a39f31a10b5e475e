#pragma once

#include "parameter/json_source.hpp"
#include "scene/catalogue.hpp"

namespace apeiron::scene {

/// The scene document: everything that decides a picture, and nothing of the GPU.
///
///     { "apeiron": 1, "title": "...", "camera": {...}, "subject": {"type": "fractal", ..., "slots": [...]},
///       "renderer": {...}, "lights": [{"type": "sun", ...}], "environment": {...},
///       "post": {..., "effects": [{"type": "vignette", ...}]}, "output": {...} }
///
/// Every key may be left out and then has its default (a mandelbulb under one sun).
class Scene {
  public:
    static constexpr int kVersion = 1;

    /// The default scene.
    explicit Scene(std::shared_ptr<const Catalogue> catalogue);

    /// @param base the folder that paths in the document are relative to
    /// @throws Error (BadInput) at file:line (pointer): unknown keys, bad values, a newer version.
    static Scene fromJson(std::shared_ptr<const Catalogue> catalogue, const parameter::JsonSource& source,
                          const std::filesystem::path& base = {});
    /// Parses text; `file` is its name in messages. @throws as above.
    static Scene parse(std::shared_ptr<const Catalogue> catalogue, const std::string& file, const std::string& text,
                       const std::filesystem::path& base = {});

    /// Complete document: reads back as an equal scene. Parameters at their default are left out unless `all`.
    Json toJson(bool all = false) const;

    /// Sets one value by path: `subject.power`, `lights.0.intensity` (or `lights[0].intensity`), `title`,
    /// `post.effects.0.strength`, `subject.type` and other `type`s. An index equal to the list's length with `.type`
    /// appends a node (`lights.1.type=point`); where nodes have no type, the key that chooses their module does
    /// (`subject.slots.0.formula=mandelbox`). Values are command-line text (see parameter::valueFromText) or JSON.
    /// Parts of a structure have paths too (`subject.transfer.window.width`; null removes one).
    /// Whole parts are set by JSON as in a document (`lights`, `lights.0`, `camera`, `post.effects`); null removes a
    /// node from a list (`lights.0=null`).
    /// Returns what that makes stale. Nothing changes when it throws.
    /// @throws Error (BadInput) "path: ..." with the nearest name.
    parameter::Invalidates set(std::string_view path, std::string_view text, const std::filesystem::path& base = {});
    parameter::Invalidates set(std::string_view path, const Json& value, const std::filesystem::path& base = {});
    // Text of these types is text, although it could become JSON as well.
    parameter::Invalidates set(std::string_view path, const std::string& text, const std::filesystem::path& base = {}) {
        return set(path, std::string_view(text), base);
    }
    parameter::Invalidates set(std::string_view path, const char* text, const std::filesystem::path& base = {}) {
        return set(path, std::string_view(text), base);
    }

    std::string title;
    parameter::Node camera;
    parameter::Node subject;
    std::vector<parameter::Node> slots; ///< what follows the subject's own formula in a hybrid
    parameter::Node renderer;
    std::vector<parameter::Node> lights;
    parameter::Node environment;
    parameter::Node post;
    std::vector<parameter::Node> effects;
    parameter::Node output;

    const Catalogue& catalogue() const { return *catalogue_; }
    std::shared_ptr<const Catalogue> sharedCatalogue() const { return catalogue_; }
    bool operator==(const Scene& other) const;

    static constexpr std::size_t kMaxLights = 8; ///< the length of the shaders' light arrays
    static constexpr std::size_t kMaxEffects = 32;
    static constexpr std::size_t kMaxSlots = 8;

  private:
    std::shared_ptr<const Catalogue> catalogue_;
};

/// What going from one scene to another makes stale: the most far-reaching of all that differs.
parameter::Invalidates difference(const Scene& from, const Scene& to);

/// What going from one node to another makes stale.
parameter::Invalidates difference(const parameter::Node& from, const parameter::Node& to);

/// What going from one list of nodes to another makes stale.
/// @param structure what another number or other types of nodes make stale, and the most that any edit of the list
/// does:
///                  lights are arrays of uniforms, and the post chain's kernels never touch samples
parameter::Invalidates difference(const std::vector<parameter::Node>& from, const std::vector<parameter::Node>& to,
                                  parameter::Invalidates structure);

/// The more far-reaching of two (Program > Samples > Present > Nothing).
parameter::Invalidates strongest(parameter::Invalidates a, parameter::Invalidates b);

} // namespace apeiron::scene
