#pragma once

#include "gpu/raster.hpp"
#include "render/subject.hpp"
#include "terrain/background.hpp"
#include "terrain/clipmap.hpp"
#include "terrain/flight.hpp"
#include "terrain/tile_cache.hpp"

#include <memory>
#include <optional>

namespace apeiron::terrain {

/// What a scene's subject says of the terrain. @throws Error (BadInput) for a wrong address.
struct Site {
    explicit Site(const scene::Scene& scene);

    Shape shape;
    Address address;
    double relief = 1.0;
};

/// Everything drawn of a terrain: tiles and the clipmap, brought up to date with a scene, and drawn into two textures
/// of the picture's size. Needs its context current.
class Scenery {
  public:
    explicit Scenery(const gpu::Context& context);

    /// Brings tiles, clipmap and buffers to the scene. @throws Error (BadInput)
    void prepare(gpu::KernelCache& kernels, gpu::Stage stage, const scene::Scene& scene, glm::ivec2 size);

    /// Draws the tiles (see render::Subject::draw()).
    void draw(glm::vec2 shift, glm::vec2 lens);

    /// Sets the uniforms of terrain.glsl.
    void bind(gpu::Kernel& kernel, const scene::Scene& scene) const;

    /// What is around the camera, by lower bounds of the distance. @param way [world]
    render::Surroundings lookAround(const scene::Scene& scene, const glm::dvec3& way);

    /// The tiles of a picture are made some at a time, coarse ones first, and a moving camera sees far ground as it was
    /// a little way off: true when the next prepare() comes nearer to the exact picture.
    /// (Once after each prepare() it says no, so that its picture is seen.)
    bool due();
    bool busy() const { return missing_ > 0 || view_.behind != nullptr; }

    /// Lets the camera fly by itself (see render::Subject::autopilot()). @throws Error (BadInput)
    render::Flown autopilot(scene::Scene& scene, render::Autopilot way, double speed, double seconds);

    /// Goes to the cell, up or down, for which the camera's clearance is 1 to 4 (see render::Subject::rebase()).
    std::optional<double> rebase(scene::Scene& scene);

    /// Power of ten of the distance to the ground, in cells of level 0, of the last picture.
    double scale() const { return scalePower(zoom_); }

    std::vector<std::pair<std::string, double>> counters() const;
    std::vector<std::string> notes() const;

  private:
    struct Group {
        int first;
        int count;
        DepthRange range;
    };
    /// A box of lines over the tiles.
    struct Mark {
        glm::vec4 least; ///< from the camera [world]; level
        glm::vec4 most;  ///< from the camera [world]; kind, see tile_fragment.glsl
    };
    /// Looks for what debug views show over a tile.
    void mark(const Tile& tile, const Place& place);
    /// Draws records (and marks over them) of one depth range.
    void drawRange(int first, int count, glm::vec3 depth, gpu::Raster::Depth kind);
    void makeRasters();
    const Site& site(const scene::Scene& scene);
    /// The scene's camera; above the ground where the scene has it below. @throws Error (BadInput) where it is outside
    /// the root cell or too far from its address.
    Place placeOf(const scene::Scene& scene);
    /// Puts a camera that was flown somewhere into the scene. @param scale new units per old one
    static void put(scene::Scene& scene, const Place& place, double relief, double scale);
    /// Decides what the background shows.
    void lookBehind(const Place& place, glm::ivec2 size, double pixels, const parameter::Node& subject);
    /// Chooses and makes the tiles of a picture, and what is drawn of them.
    void choose(const Place& place, glm::ivec2 size, double pixels, gpu::KernelCache& kernels, gpu::Stage stage);
    /// Chooses the tiles, and no finer ones than can be made at once.
    void select(const Place& place, glm::ivec2 size, double pixels);
    /// Makes tiles that the way of the camera leads to. @param most of them
    void prefetch(const Place& place, std::int64_t most, gpu::KernelCache& kernels, gpu::Stage stage);
    void makeMesh(int cells);

    const gpu::Context& context_;
    std::optional<parameter::Node> subject_; ///< that the site is of
    std::optional<Site> site_;
    std::optional<Place> corner_; ///< of the address's cell
    Selection selection_;
    SelectionView view_;
    std::optional<TileCache> cache_;
    std::optional<Background> background_;
    Clipmap clipmap_;
    gpu::Texture position_;
    gpu::Texture slope_;
    gpu::DepthTargets targets_;
    std::optional<gpu::Raster> raster_;
    std::optional<gpu::Raster> lines_;
    gpu::Buffer boxVertices_;
    gpu::Buffer boxIndices_;
    gpu::Buffer boxInstances_;
    std::vector<Mark> marks_;     ///< as many for each of the records, in their order
    std::optional<Place> chosen_; ///< where the camera was when tiles were chosen
    glm::vec3 moved_{0.0F};       ///< the camera since then [world]
    bool apart_ = false;          ///< the camera is not where tiles were chosen for
    gpu::Buffer vertices_;
    gpu::Buffer indices_;
    gpu::Buffer instances_;
    int meshCells_ = 0;
    int indexCount_ = 0;
    int stride_ = 1;
    int debug_ = 0;
    TileCache::Maker maker_ = TileCache::Maker::Cpu;
    double relief_ = 1.0;
    double zoom_ = 0.0;        ///< depth that relief_ is for [levels]
    std::vector<Tile> later_;  ///< the full selection, where that could not be drawn at once
    std::int64_t held_ = 0;    ///< levels that are not drawn for want of these tiles
    std::int64_t missing_ = 0; ///< of it, tiles that were not there
    std::int64_t made_ = 0;    ///< tiles, for the last picture
    bool prepared_ = false;    ///< since the last due()
    bool atRest_ = false;      ///< the next prepare() is for the exact picture
    bool lifted_ = false;      ///< the scene's camera is under the ground
    std::int64_t prefetched_ = 0;
    std::optional<Flight> flight_;               ///< of the autopilot ...
    std::optional<parameter::Node> flownCamera_; ///< ... which left the camera there
    std::optional<parameter::Node> flownSubject_;
    bool reversed_ = true;
    std::vector<TileInstance> records_;
    std::vector<Group> groups_;
    std::int64_t triangles_ = 0;
    double coarser_ = 1.0; ///< by what vertices are farther apart than asked for, where memory is short
    bool orthographic_ = false;
    glm::mat3 basis_{1.0F};
    glm::vec2 film_{1.0F};
    float lens_ = 0.0F; ///< radius [world]
    float focus_ = 1.0F;
    std::array<float, 24> layers_{}; ///< the camera's height in layers of 2^(i - 10) cells, 0..1
    double selectSeconds_ = 0.0;
    double makeSeconds_ = 0.0;
    double backgroundSeconds_ = 0.0;
    double clipSeconds_ = 0.0;
};

} // namespace apeiron::terrain
