#include "terrain/selection.hpp"
#include "terrain_support.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

namespace apeiron::terrain {
namespace {

Place placeAt(const Shape& shape, int levels, unsigned seed, const glm::dvec3& position) {
    std::mt19937 random(seed);
    Place place(shape, flatSeekingAddress(shape, Address::parse(randomPath(random, 6)), levels));
    place.setPosition(position);
    return place;
}

SelectionView everything(int tileLevels, double ratio) {
    SelectionView view;
    view.tileLevels = tileLevels;
    view.ratio = ratio;
    view.cullFrustum = false;
    view.cullHorizon = false;
    return view;
}

/// A view over the ground: 20 degrees down, in direction `heading` [rad].
glm::dmat3 overTheGround(double heading) {
    return glm::mat3_cast(glm::angleAxis(heading, glm::dvec3(0, 0, 1)) * glm::angleAxis(1.22, glm::dvec3(1, 0, 0)));
}

TEST(TerrainSelection, covers_all_once_with_neighbours_of_one_level_apart) {
    for (const Shape& shape : shapes()) {
        for (const double height : {0.6, 2.0, 40.0}) {
            const Place place = placeAt(shape, 300, 5, {0.7, 0.2, height});
            for (const double ratio : {kLeastRatio, 1.6, 3.1}) {
                Selection selection;
                const std::vector<Tile>& tiles = selection.select(place, everything(5, ratio));
                // In cells of the finest level, from the origin.
                std::int64_t finest = 0;
                std::int64_t coarsest = place.level();
                for (const Tile& tile : tiles) {
                    finest = std::max(finest, tile.cell.level);
                    coarsest = std::min(coarsest, tile.cell.level);
                }
                double area = 0.0;
                struct Square {
                    std::int64_t x, y, edge, level;
                };
                std::vector<Square> squares;
                for (const Tile& tile : tiles) {
                    const std::int64_t scale = std::int64_t{1} << (finest - tile.cell.level);
                    squares.push_back({tile.offset.x * scale, tile.offset.y * scale, 32 * scale, tile.cell.level});
                    area += static_cast<double>(squares.back().edge) * static_cast<double>(squares.back().edge);
                }
                const double rootEdge = std::ldexp(32.0, static_cast<int>(finest - (place.level() - 14)));
                EXPECT_DOUBLE_EQ(area, 9.0 * rootEdge * rootEdge);
                int tooFar = 0;
                int overlaps = 0;
                for (std::size_t a = 0; a < squares.size(); ++a) {
                    for (std::size_t b = a + 1; b < squares.size(); ++b) {
                        const auto gap = [](std::int64_t p, std::int64_t pe, std::int64_t q, std::int64_t qe) {
                            return std::max(q - (p + pe), p - (q + qe));
                        };
                        const std::int64_t apart =
                            std::max(gap(squares[a].x, squares[a].edge, squares[b].x, squares[b].edge),
                                     gap(squares[a].y, squares[a].edge, squares[b].y, squares[b].edge));
                        overlaps += apart < 0 ? 1 : 0;
                        tooFar += apart == 0 && std::abs(squares[a].level - squares[b].level) > 1 ? 1 : 0;
                    }
                }
                EXPECT_EQ(overlaps, 0);
                EXPECT_EQ(tooFar, 0);
            }
        }
    }
}

TEST(TerrainSelection, border_vertices_of_morphed_tiles_have_identical_bits) {
    std::int64_t compared = 0;
    std::int64_t mismatches = 0;
    std::int64_t inBetween = 0;
    for (const Shape& shape : shapes()) {
        for (const double ratio : {1.15, 2.0}) {
            const Place place = placeAt(shape, 250, 9, {0.31, 0.83, 1.7});
            constexpr int kLevels = 4;
            constexpr int kCells = 1 << kLevels;
            Selection selection;
            SelectionView view = everything(kLevels, ratio);
            view.relief = 1.3;
            const std::vector<Tile>& tiles = selection.select(place, view);
            const glm::vec3 camera(selection.camera());
            const auto clearance = static_cast<float>(selection.lastClearance());
            std::int64_t finest = 0;
            for (const Tile& tile : tiles)
                finest = std::max(finest, tile.level);
            // By where a vertex is on the finest lattice: what each tile makes of it.
            std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::pair<std::int64_t, glm::vec3>>> borders;
            std::vector<VertexHeights> heights((kCells + 1) * (kCells + 1));
            for (const Tile& tile : tiles) {
                tileHeights(shape, place.cellNamed(tile.cell), kLevels, 0, heights);
                const std::int64_t scale = std::int64_t{1} << (finest - tile.level);
                for (int j = 0; j <= kCells; ++j) {
                    for (int i = 0; i <= kCells; ++i) {
                        if (i != 0 && j != 0 && i != kCells && j != kCells) continue;
                        const glm::vec3 at = morphed(
                            tile, {i, j}, heights[static_cast<std::size_t>(j * (kCells + 1) + i)], camera, clearance);
                        borders[{(tile.offset.x + i) * scale, (tile.offset.y + j) * scale}].emplace_back(tile.level,
                                                                                                         at);
                    }
                }
            }
            for (const auto& [place2, vertices] : borders) {
                for (std::size_t i = 1; i < vertices.size(); ++i) {
                    ++compared;
                    mismatches += std::memcmp(&vertices[0].second, &vertices[i].second, sizeof(glm::vec3)) != 0 ? 1 : 0;
                }
            }
            // Where a fine tile meets a coarse one its odd vertices have slid onto those of the coarse one.
            for (const auto& [place2, vertices] : borders) {
                if (vertices.size() != 1) continue;
                const auto& [level, at] = vertices.front();
                bool meets = false;
                const std::int64_t scale = std::int64_t{1} << (finest - level);
                for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(0, -1)}) {
                    const auto beside = borders.find({place2.first + dx * scale, place2.second + dy * scale});
                    if (beside == borders.end()) continue;
                    for (const auto& [otherLevel, other] : beside->second) {
                        if (otherLevel == level - 1 && std::memcmp(&other, &at, sizeof(at)) == 0) meets = true;
                    }
                }
                // Others are at the outer border of all tiles.
                inBetween += meets ? 1 : 0;
            }
        }
    }
    RecordProperty("compared", static_cast<int>(compared));
    EXPECT_EQ(mismatches, 0) << "of " << compared;
    EXPECT_GT(compared, 50'000);
    EXPECT_GT(inBetween, 3'000);
}

TEST(TerrainSelection, clearance_is_below_the_distance_to_every_vertex_and_not_far_below) {
    int above = 0;
    int below = 0;
    for (const Shape& shape : shapes()) {
        for (const double height : {-0.8, 0.7, 3.0}) {
            const Place place = placeAt(shape, 120, 3, {0.4, 0.6, height});
            Selection selection;
            const double clearance = selection.clearance(place, 1.0);
            const auto& tiles = selection.select(place, everything(6, 3.0));
            double nearest = 1e300;
            double aside = 1e300;
            bool underGround = false;
            std::vector<VertexHeights> heights(65 * 65);
            for (const Tile& tile : tiles) {
                if (tile.distance > 6.0) continue;
                tileHeights(shape, place.cellNamed(tile.cell), 6, 0, heights);
                for (int i = 0; i < 65 * 65; ++i) {
                    const double z =
                        heightDifference(heights[static_cast<std::size_t>(i)].x, tile.originHeight) * tile.heightUnit;
                    const glm::dvec3 at((tile.offset.x + i % 65) * tile.spacing,
                                        (tile.offset.y + i / 65) * tile.spacing, z);
                    const glm::dvec3 way = at - selection.camera();
                    nearest = std::min(nearest, glm::length(way));
                    if (std::hypot(way.x, way.y) < aside) {
                        aside = std::hypot(way.x, way.y);
                        underGround = way.z > 0.0;
                    }
                }
            }
            if (underGround) {
                EXPECT_EQ(clearance, 0.0);
                ++below;
                continue;
            }
            ++above;
            EXPECT_LE(clearance, nearest);
            // Boxes are a quarter of the distance in size, and as high as all octaves could make them.
            EXPECT_GT(clearance, 0.3 * nearest);
        }
    }
    EXPECT_GE(above, 4);
    EXPECT_GE(below, 4);
}

TEST(TerrainSelection, what_is_culled_is_not_in_the_picture) {
    const Shape shape{Kernel::BSpline, 15, 700};
    const Place place = placeAt(shape, 150, 4, {0.5, 0.5, 1.2});
    for (const double heading : {0.0, 1.0, 2.5, 4.0}) {
        Selection selection;
        SelectionView view = everything(4, 1.5);
        view.camera = overTheGround(heading);
        view.aspect = 1.6;
        const std::vector<Tile> all = selection.select(place, view);
        view.cullFrustum = true;
        const std::vector<Tile> inView = selection.select(place, view);
        view.cullHorizon = true;
        const std::vector<Tile> seen = selection.select(place, view);
        EXPECT_LT(inView.size(), all.size() / 2);
        EXPECT_LE(seen.size(), inView.size());
        const auto key = [](const Tile& tile) { return std::tuple(tile.level, tile.x, tile.y); };
        std::set<std::tuple<std::int64_t, std::uint32_t, std::uint32_t>> kept;
        for (const Tile& tile : inView)
            kept.insert(key(tile));
        // Every vertex of a tile that was left out is outside of the view.
        int lost = 0;
        std::vector<VertexHeights> heights(17 * 17);
        for (const Tile& tile : all) {
            if (kept.contains(key(tile))) continue;
            tileHeights(shape, place.cellNamed(tile.cell), 4, 0, heights);
            for (int i = 0; i < 17 * 17; ++i) {
                const glm::dvec3 at((tile.offset.x + i % 17) * tile.spacing, (tile.offset.y + i / 17) * tile.spacing,
                                    heightDifference(heights[static_cast<std::size_t>(i)].x, tile.originHeight) *
                                        tile.heightUnit);
                const glm::dvec3 local = glm::transpose(view.camera) * (at - selection.camera());
                lost += local.z < 0.0 && std::abs(local.y) < -local.z * view.tanHalfFov * 0.999 &&
                                std::abs(local.x) < -local.z * view.tanHalfFov * view.aspect * 0.999
                            ? 1
                            : 0;
            }
        }
        EXPECT_EQ(lost, 0);
    }
}

TEST(TerrainSelection, is_the_same_with_cells_remembered_and_without) {
    const Shape shape{Kernel::BSpline, 8, 1000};
    Place place = placeAt(shape, 60, 2, {0.5, 0.5, 2.5});
    Selection remembering;
    SelectionView view = everything(5, 1.5);
    for (int i = 0; i < 300; ++i) {
        place.move({0.05, 0.02, -0.004});
        // Down and up again: what were roots become cells below others, and the other way around.
        if (i % 25 == 24) place.descend();
        if (i % 40 == 39) place.ascend();
        const std::vector<Tile>& tiles = remembering.select(place, view);
        remembering.prefetch(place, view, {0.2, 0.1, 0.0}, 100);
        if (i % 20 != 0) continue;
        Selection fresh;
        const std::vector<Tile>& same = fresh.select(place, view);
        ASSERT_EQ(tiles.size(), same.size());
        for (std::size_t t = 0; t < tiles.size(); ++t) {
            ASSERT_EQ(tiles[t].cell, same[t].cell);
            ASSERT_EQ(tiles[t].offset, same[t].offset);
            ASSERT_EQ(tiles[t].least, same[t].least);
            ASSERT_EQ(tiles[t].most, same[t].most);
        }
    }
    EXPECT_LT(remembering.cachedCells(), 5000U);
}

TEST(TerrainSelection, tiles_name_cells_whose_ground_is_between_their_bounds) {
    for (const Shape& shape : shapes()) {
        for (const int levels : {0, 3, 90}) {
            const Place place = placeAt(shape, levels, 6, {0.3, 0.6, 1.5});
            Selection selection;
            std::vector<VertexHeights> heights(17 * 17);
            int outside = 0;
            for (const Tile& tile : selection.select(place, everything(4, 1.5))) {
                const Cell cell = place.cellNamed(tile.cell);
                ASSERT_EQ(cell.level, tile.cell.level);
                ASSERT_EQ(cell.x, tile.cell.x);
                ASSERT_EQ(cell.y, tile.cell.y);
                tileHeights(shape, cell, 4, 0, heights);
                for (const VertexHeights& height : heights) {
                    const double z =
                        heightDifference(height.x, tile.originHeight) * tile.heightUnit - selection.camera().z;
                    const double rounding = 1e-9 * (std::abs(tile.least) + std::abs(tile.most));
                    outside += z < tile.least - rounding || z > tile.most + rounding ? 1 : 0;
                }
            }
            EXPECT_EQ(outside, 0) << levels;
        }
    }
}

TEST(TerrainSelection, prefetch_lists_what_the_next_picture_needs) {
    const Shape shape{Kernel::BSpline, 8, 1000};
    Place place = placeAt(shape, 60, 2, {0.5, 0.5, 2.5});
    Selection selection;
    SelectionView view = everything(5, 1.5);
    selection.select(place, view);
    const double clearance = selection.lastClearance();
    std::set<std::tuple<std::int64_t, std::uint32_t, std::uint32_t>> known;
    const auto key = [](const Tile& tile) { return std::tuple(tile.level, tile.x, tile.y); };
    for (const Tile& tile : selection.tiles())
        known.insert(key(tile));
    const glm::dvec3 travel(0.1, 0.0, -0.5 * clearance);
    const std::vector<Tile> ahead = selection.prefetch(place, view, travel, 1000);
    EXPECT_GT(ahead.size(), 10U);
    EXPECT_LE(selection.prefetch(place, view, travel, 7).size(), 7U);
    for (const Tile& tile : ahead) {
        EXPECT_FALSE(known.contains(key(tile)));
        known.insert(key(tile));
    }
    place.move(travel);
    int missing = 0;
    for (const Tile& tile : selection.select(place, view))
        missing += known.contains(key(tile)) ? 0 : 1;
    EXPECT_EQ(missing, 0);
}

} // namespace
} // namespace apeiron::terrain
