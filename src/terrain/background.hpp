#pragma once

#include "gpu/raster.hpp"
#include "terrain/frustum.hpp"
#include "terrain/tile_cache.hpp"
#include "terrain/tile_instance.hpp"

#include <array>
#include <memory>
#include <optional>
#include <unordered_map>

namespace apeiron::terrain {

/// Far ground as it was seen from a place a little way off: a cube of pictures around the camera, which is drawn some
/// tiles per frame while the camera moves, and shown as long as nothing in it has moved by more than half a pixel
/// (after the frozen cube maps of Tunković 2018). How far out "far" begins follows from the camera's speed: as near as
/// pays.
///
/// One cube is shown while the next is drawn. Faces are drawn as the view comes near them. Needs its context current.
class Background {
  public:
    explicit Background(const gpu::Context& context);

    /// Before the tiles of a picture of a moving camera are chosen: measures its speed, and decides whether the cube at
    /// hand will do and whether another one is begun. @param side of a face, so that its texels are the picture's
    /// pixels @param reversed how near hides far @param room of the tile cache [tiles]
    void look(const Place& place, const SelectionView& view, int side, bool reversed, int room);
    /// The next picture is one without it.
    void leave() {
        shown_ = false;
        staged_.clear();
    }
    /// Cells that it shows in this picture: nobody else needs to. None: it shows nothing.
    const CellSet* cells() const { return shown_ ? &front_.cells : nullptr; }

    /// After the tiles of a picture without a background were chosen: what could be saved.
    void learn(const std::vector<Tile>& tiles, std::int64_t level);

    /// Makes tiles ready for the next work(). @param most tiles that may be made for it
    void stage(TileCache& cache, std::int64_t most, TileCache::Maker maker, gpu::KernelCache& kernels,
               gpu::Stage stage);
    /// Draws what was made ready into the cube.
    void work(const TileCache& cache, const gpu::Buffer& vertices, const gpu::Buffer& indices, int indexCount,
              int stride);

    /// Where and how a picture sees it: uniforms of tile_projection.glsl.
    struct Eye {
        glm::mat3 basis{1.0F};
        glm::vec2 film{1.0F};
        glm::vec2 shift{0.0F};
        glm::vec3 lens{0.0F};
    };
    /// Draws the cube where nothing nearer is, behind everything. @pre cells()
    void show(const gpu::DepthTargets& targets, const Eye& eye);

    /// Tiles of the picture that the cube stands for.
    std::size_t tiles() const { return shown_ ? front_.cells.size() : 0; }
    /// Part of the cube in progress that is drawn, 0..1; 1: there is none in progress.
    double progress() const;
    std::int64_t drawn() const { return drawn_; } ///< tiles into cubes, since it was made

  private:
    struct Face {
        bool wanted = false;
        std::vector<Tile> tiles; ///< in the order in which they are drawn
        std::size_t done = 0;
        gpu::Texture seen; ///< distance, slopes, level; distance 0: nothing
        gpu::DepthTargets targets;

        bool complete() const { return wanted && done == tiles.size(); }
    };
    struct Cube {
        std::optional<Place> place; ///< none: there is no cube
        SelectionView view;
        int side = 0;
        bool reversed = true;
        glm::dvec3 eye{0.0}; ///< from the tiles' origin
        double clearance = 0.0;
        double reach = 0.0; ///< way after which something has moved by half a pixel [world of the place]
        std::unordered_map<std::int64_t, DepthRange> ranges; ///< by tiles' levels
        CellSet cells;
        std::array<Face, 6> faces;
    };
    /// Where the camera is, as a cube sees it.
    struct Standing {
        glm::dvec3 way{0.0}; ///< from the cube's place to the camera [world now]
        double scale = 1.0;  ///< world units now per unit of the cube's
        double left = 0.0;   ///< of its reach [world now]; < 0: used up
    };
    struct Plan {
        int up = 0;
        double gain = 0.0;  ///< tiles that need not be drawn in a picture, less what that costs
        int each = 0;       ///< tiles drawn in a picture
        double makes = 0.0; ///< pictures until it is complete
    };

    std::optional<Standing> standing(const Cube& cube, const Place& place, const SelectionView& view, int side) const;
    /// The cube that pays most at the present speed; gain <= 0: none does.
    Plan plan(const SelectionView& view, int side, double room) const;
    void begin(const Place& place, const SelectionView& view, int side, bool reversed, const Plan& plan);
    /// Marks the faces that the view is near to.
    static void want(Cube& cube, const SelectionView& view);
    static bool complete(const Cube& cube, const Frustum& seen);

    const gpu::Context& context_;
    gpu::Raster tileRaster_;
    gpu::Raster faceRaster_;
    gpu::Buffer faceVertices_;
    gpu::Buffer faceIndices_;
    gpu::Buffer instances_;
    Selection selection_; ///< all around
    Cube front_;
    Cube back_;
    bool shown_ = false;
    Standing standing_; ///< of the front
    std::optional<Place> last_;
    double relief_ = 0.0;      ///< of the last picture
    double speed_ = 0.0;       ///< [world per picture]
    std::vector<double> seen_; ///< tiles of a picture by how many levels above the place's they are
    double perTile_ = 3.0;     ///< tiles in a cube for each one that a picture has of them
    int each_ = 0;             ///< tiles drawn in a picture
    int wait_ = 0;             ///< pictures before another cube is begun ...
    int waited_ = 0;           ///< ... and those since

    struct Staged {
        Face* face;
        TileInstance instance;
        std::int64_t level;
    };
    std::vector<Staged> staged_;
    Cube* stagedFor_ = nullptr;
    std::int64_t drawn_ = 0;
};

} // namespace apeiron::terrain
