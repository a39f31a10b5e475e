#pragma once

#include "terrain/cell_key.hpp"
#include "terrain/place.hpp"

#include <limits>
#include <memory>

namespace apeiron::terrain {

// World units: as the local frame of the Place, one unit is the edge of its current cell; heights are multiplied by
// `relief`.

/// What a picture asks of the selection of tiles.
struct SelectionView {
    /// Columns: the camera's right, up and backward in the world, orthonormal.
    glm::dmat3 camera{1.0};
    double tanHalfFov = 0.577; ///< of the vertical field of view
    double aspect = 1.0;       ///< width / height
    double relief = 1.0;       ///< vertical scale; > 0
    int tileLevels = 7;        ///< a tile has 2^tileLevels cells along a side
    /// A tile is split while it is nearer than `ratio` times its own edge: splitRatio(). At least kLeastRatio.
    double ratio = 1.6;
    int octaves = 14; ///< levels upwards from the place's to that of the coarsest tiles; at most Place::kLiveLevels - 8
    /// No tile's cell is of a deeper level. All that would be finer is drawn by ancestors of that one level, unmorphed:
    /// without cracks, too.
    std::int64_t deepest = std::numeric_limits<std::int64_t>::max();
    /// Cells that are split beyond this level are left out, and all ground in them: neither drawn nor hiding anything.
    std::int64_t finest = std::numeric_limits<std::int64_t>::max();
    /// Cells that something else shows: they are left out. May be none.
    const CellSet* behind = nullptr;
    bool cullFrustum = true;
    bool cullHorizon = true;
};

/// Neighbours then differ by one level at most, and there is room to morph.
inline constexpr double kLeastRatio = 1.1;

/// The ratio for which vertices are at most `pixels` apart in a picture of that height [pixels].
double splitRatio(double pictureHeight, double tanHalfFov, double pixels, int tileLevels);

/// A tile to draw. Positions are relative to an origin that is a lattice point of all tiles of the selection, so that
/// integers are subtracted before anything becomes a float: border vertices of neighbours get identical bits.
struct Tile {
    CellKey cell;           ///< the tile is the 2^tileLevels-fold subdivision of it; see Place::cellNamed()
    std::int64_t level = 0; ///< of its vertices: cell.level + tileLevels
    std::uint32_t x = 0;    ///< its first vertex on the lattice of `level`, modulo 2^32; with `level` a cache's key
    std::uint32_t y = 0;
    glm::ivec2 offset{0};          ///< its first vertex from the origin [vertex spacings]; below 2^24 where a
                                   ///< clearance of a cell or so allows no finer tiles: exact as floats
    std::int32_t originHeight = 0; ///< of the origin [units of `level`], modulo 2^32
    double spacing = 0.0;          ///< of vertices [world]
    double heightUnit = 0.0;       ///< one unit of height of `level` [world], relief included
    /// m = clamp(D * morphScale - morphOffset, 0, 1), see morphed().
    float morphScale = 0.0F;
    float morphOffset = 0.0F;
    double least = 0.0;    ///< no height is less [world, from the camera]
    double most = 0.0;     ///< nor greater
    double distance = 0.0; ///< D of its nearest point [world]
};

/// A vertex as drawn, relative to the selection's origin [world].
///
/// With D = max(|dx|, |dy|, clearance) the vertex, if odd, slides to its even neighbour (Strugar 2010, CDLOD) while its
/// height goes to the one that the mesh of twice the spacing has there. At m = 0 and m = 1 it is exact: borders of
/// tiles of different levels agree in every bit; borders of the same level do since both compute the same.
///
/// The GLSL of the drawing computes the same operations:
///     vec2 at = vec2(offset + vertex);
///     D = max(max(abs(at.x * spacing - camera.x), abs(at.y * spacing - camera.y)), clearance);
///     m = clamp(D * morphScale - morphOffset, 0.0, 1.0);
///     position.xy = (at - m * vec2(vertex & 1)) * spacing;
///     position.z = (1.0 - m) * (float(fine - originHeight) * heightUnit) + m * (float(coarse - originHeight) *
///     heightUnit);
glm::vec3 morphed(const Tile& tile, glm::ivec2 vertex, VertexHeights heights, const glm::vec3& camera, float clearance);

/// Chooses the tiles of a picture: a quadtree from nine cells, `octaves` above the place, downwards. Keeps the windows
/// of the cells that it has seen of late; at most some megabytes.
class Selection {
  public:
    Selection();
    ~Selection();
    Selection(Selection&&) noexcept;
    Selection& operator=(Selection&&) noexcept;

    /// The tiles to draw, the near ones first. Together they cover the nine cells of the coarsest level (but for what
    /// is culled) once. Neighbours differ by one level at most.
    const std::vector<Tile>& select(const Place& place, const SelectionView& view);

    /// The tiles of the last select() and its view.
    const std::vector<Tile>& tiles() const { return tiles_; }
    /// The camera from the origin of the last select() [world].
    const glm::dvec3& camera() const { return camera_; }
    /// clearance() of the last select().
    double lastClearance() const { return clearance_; }
    /// Vertices' level of the coarsest tiles, whose lattice the origin is on.
    std::int64_t originLevel() const { return originLevel_; }

    /// Tiles that will be needed when the point has moved by `travel` [world], and that the last select() of the same
    /// place does not have: the most urgent first, at most `most`.
    std::vector<Tile> prefetch(const Place& place, const SelectionView& view, const glm::dvec3& travel,
                               std::size_t most);

    /// A lower bound of the distance from the place's point to the ground [world]: the distance to boxes that hold it,
    /// refined until they are small beside their distance. 0 under ground. About 10 us.
    /// @param octaves as in SelectionView
    double clearance(const Place& place, double relief, int octaves = 14);

    /// Cells that are remembered.
    std::size_t cachedCells() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
    std::vector<Tile> tiles_;
    glm::dvec3 camera_{0.0};
    double clearance_ = 0.0;
    std::int64_t originLevel_ = 0;
};

} // namespace apeiron::terrain
