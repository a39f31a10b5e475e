#pragma once

#include "gpu/raster.hpp"
#include "render/subject.hpp"
#include "terrain/clipmap.hpp"
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

    /// Goes to the cell, up or down, for which the camera's clearance is 1 to 4 (see render::Subject::rebase()).
    std::optional<double> rebase(scene::Scene& scene);

    std::vector<std::pair<std::string, double>> counters() const;
    std::vector<std::string> notes() const;

  private:
    struct Instance {
        glm::ivec4 place;
        glm::ivec4 height;
        glm::vec4 scale;
    };
    struct Group {
        int first;
        int count;
        float nearest; ///< [world]
        float farthest;
    };
    const Site& site(const scene::Scene& scene);
    /// The scene's camera. @throws Error (BadInput) where it is outside the root cell or too far from its address.
    Place placeOf(const scene::Scene& scene);
    void makeMesh(int cells);

    const gpu::Context& context_;
    std::optional<parameter::Node> subject_; ///< that the site is of
    std::optional<Site> site_;
    std::optional<Place> corner_; ///< of the address's cell
    Selection selection_;
    SelectionView view_;
    std::optional<TileCache> cache_;
    Clipmap clipmap_;
    gpu::Texture position_;
    gpu::Texture slope_;
    gpu::DepthTargets targets_;
    std::optional<gpu::Raster> raster_;
    gpu::Buffer vertices_;
    gpu::Buffer indices_;
    gpu::Buffer instances_;
    int meshCells_ = 0;
    int indexCount_ = 0;
    int stride_ = 1;
    int debug_ = 0;
    bool reversed_ = true;
    std::vector<Instance> records_;
    std::vector<Group> groups_;
    std::int64_t triangles_ = 0;
    double coarser_ = 1.0; ///< by what vertices are farther apart than asked for, where memory is short
    bool orthographic_ = false;
    glm::mat3 basis_{1.0F};
    glm::vec2 film_{1.0F};
    float lens_ = 0.0F; ///< radius [world]
    float focus_ = 1.0F;
    double relief_ = 1.0;
    std::array<float, 24> layers_{}; ///< the camera's height in layers of 2^(i - 10) cells, 0..1
    double selectSeconds_ = 0.0;
    double makeSeconds_ = 0.0;
    double clipSeconds_ = 0.0;
};

} // namespace apeiron::terrain
