#pragma once

#include "gpu/raster.hpp"
#include "terrain/selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace apeiron::terrain {

/// What tile_vertex.glsl is told of a tile.
struct TileInstance {
    glm::ivec4 place;
    glm::ivec4 height;
    glm::vec4 scale;
};

/// Inputs of tile_vertex.glsl.
inline std::vector<gpu::Raster::Attribute> tileAttributes() {
    return {{"grid", 2, true, false, 0},
            {"tile_place", 4, true, true, offsetof(TileInstance, place)},
            {"tile_height", 4, true, true, offsetof(TileInstance, height)},
            {"tile_scale", 4, false, true, offsetof(TileInstance, scale)}};
}

/// @param at first texel of the tile's square in the cache @param level of the place that the tile was selected for
inline TileInstance instanceOf(const Tile& tile, glm::ivec2 at, std::int64_t level) {
    return {{tile.offset, at},
            {tile.originHeight, static_cast<int>(tile.level - level), 0, 0},
            {static_cast<float>(tile.spacing), static_cast<float>(tile.heightUnit), tile.morphScale, tile.morphOffset}};
}

/// Distances between which all of a tile is, for a depth that is not reversed.
struct DepthRange {
    float nearest = 1e30F; ///< [world]
    float farthest = 0.0F;

    /// Widens it so that it holds the other.
    void include(const DepthRange& other) {
        nearest = std::min(nearest, other.nearest);
        farthest = std::max(farthest, other.farthest);
    }
    /// Of tile_projection.glsl.
    glm::vec3 projection() const {
        const float d = farthest - nearest;
        return {1.0F, (farthest + nearest) / d, -2.0F * farthest * nearest / d};
    }
};

/// @param edge of the tile's cell [world] @param eye from the selection's origin @param clearance of the selection
inline DepthRange depthRangeOf(const Tile& tile, double edge, const glm::dvec3& eye, double clearance) {
    const glm::dvec2 least = glm::dvec2(tile.offset) * tile.spacing - glm::dvec2(eye);
    const glm::dvec2 most = least + edge;
    const glm::dvec3 reach(std::max(std::abs(least.x), std::abs(most.x)), std::max(std::abs(least.y), std::abs(most.y)),
                           std::max(std::abs(tile.least), std::abs(tile.most)));
    return {static_cast<float>(std::max(0.3 * tile.distance, 1e-3 * clearance)),
            static_cast<float>(1.01 * glm::length(reach))};
}

/// What a reversed depth is 1 at [world].
inline float nearestDrawn(double clearance) {
    return static_cast<float>(std::max(1e-3 * clearance, 1e-9));
}

} // namespace apeiron::terrain
