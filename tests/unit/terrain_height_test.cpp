#include "terrain/height.hpp"
#include "terrain/place.hpp"
#include "terrain_support.hpp"

#include "core/file.hpp"
#include "core/json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

namespace apeiron::terrain {
namespace {

std::filesystem::path root() {
    return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
}

/// Compares all vectors of a file with what is computed; returns how many there were.
std::size_t compareVectors(const std::filesystem::path& file) {
    const Json vectors = Json::parse(readFile(file.string())).at("vectors");
    for (const Json& vector : vectors) {
        const auto path = vector.at("path").get<std::string>();
        const auto seed = vector.at("seed").get<std::uint32_t>();
        const Cell smooth = cellAt({Kernel::BSpline, seed, 1000}, path);
        EXPECT_EQ(smooth.level, static_cast<std::int64_t>(path.size()));
        EXPECT_EQ(smooth.x, vector.at("x").get<std::uint32_t>()) << path;
        EXPECT_EQ(smooth.y, vector.at("y").get<std::uint32_t>()) << path;
        EXPECT_EQ(Json(smooth.window), vector.at("bspline_window")) << path;
        const Cell linear = cellAt({Kernel::Bilinear, seed, 1000}, path);
        EXPECT_EQ(Json({linear.window[5], linear.window[6], linear.window[9], linear.window[10]}),
                  vector.at("bilinear"))
            << path;
    }
    return vectors.size();
}

TEST(TerrainHeight, reference_vectors_are_met) {
    EXPECT_GE(compareVectors(root() / "tests/data/terrain_vectors.json"), 14U);
}

TEST(TerrainHeight, shared_reference_vectors_are_met) {
    const std::filesystem::path file = root() / "../shared/design/terrain_vectors.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
    EXPECT_GE(compareVectors(file), 14U);
}

/// The recurrence written out on true heights, with no wrap-around: corners of a cell with the number that was taken
/// away from all of them, so that they stay small.
struct TrueCell {
    std::array<std::int64_t, 16> window{};
    std::uint32_t removed = 0; ///< modulo 2^32
};

TEST(TerrainHeight, residues_are_those_of_a_chain_of_true_heights_that_is_rebased) {
    for (const Kernel kernel : {Kernel::BSpline, Kernel::Bilinear}) {
        for (const int hurst : {1000, 800, 350}) {
            const Shape shape{kernel, 99, hurst};
            std::mt19937 random(5);
            Cell cell = rootCell(shape);
            TrueCell exact;
            for (std::size_t i = 0; i < 16; ++i)
                exact.window[i] = cell.window[i];
            std::int64_t mismatches = 0;
            for (int level = 0; level < 3000; ++level) {
                const int digit = static_cast<int>(random() % 4);
                cell = childCell(shape, cell, digit);
                const int step = heightStep(shape, cell.level);
                const auto a = static_cast<std::int64_t>(amplitude(shape, cell.level));
                TrueCell next;
                for (int j = 0; j < 4; ++j) {
                    for (int i = 0; i < 4; ++i) {
                        // Parents' weights along an axis, of lattice point p counted from twice the window's first.
                        const auto weight = [&](int p, int parent) -> std::int64_t {
                            const int m = p / 2;
                            if (p % 2 != 0) return parent == m || parent == m + 1 ? 4 : 0;
                            if (kernel == Kernel::Bilinear) return parent == m ? 8 : 0;
                            return parent == m ? 6 : std::abs(parent - m) == 1 ? 1 : 0;
                        };
                        const int px = i + 1 + (digit & 1);
                        const int py = j + 1 + (digit >> 1);
                        std::int64_t sum = 0;
                        for (int y = 0; y < 4; ++y) {
                            for (int x = 0; x < 4; ++x)
                                sum +=
                                    weight(px, x) * weight(py, y) * exact.window[static_cast<std::size_t>(4 * y + x)];
                        }
                        const std::uint32_t noise =
                            noiseOf(shape.seed, cell.level, cell.x - 1U + static_cast<std::uint32_t>(i),
                                    cell.y - 1U + static_cast<std::uint32_t>(j));
                        const std::int64_t u = ((static_cast<std::int64_t>(noise >> 16U) * a) >> 15) - a;
                        // 64 h down to h, or to 2 h: one floor.
                        next.window[static_cast<std::size_t>(4 * j + i)] = (sum >> (6 - step)) + u;
                    }
                }
                next.removed = exact.removed << static_cast<unsigned>(step);
                const std::int64_t base = next.window[5];
                for (std::int64_t& height : next.window)
                    height -= base;
                next.removed += static_cast<std::uint32_t>(static_cast<std::uint64_t>(base));
                exact = next;
                for (std::size_t i = 0; i < 16; ++i)
                    mismatches +=
                        static_cast<std::uint32_t>(cell.window[i]) !=
                                static_cast<std::uint32_t>(static_cast<std::uint64_t>(exact.window[i])) + exact.removed
                            ? 1
                            : 0;
            }
            EXPECT_EQ(mismatches, 0) << hurst;
        }
    }
}

TEST(TerrainHeight, cells_that_share_lattice_points_agree_however_far_their_paths_part) {
    std::int64_t compared = 0;
    std::int64_t mismatches = 0;
    for (const Shape& shape : shapes()) {
        std::mt19937 random(11);
        for (int trial = 0; trial < 60; ++trial) {
            // Neighbours along x whose common ancestor is `apart` levels up: 0111... and 1000... from there.
            const int depth = static_cast<int>(random() % 600);
            const int apart = 1 + static_cast<int>(random() % 30);
            std::string start = randomPath(random, depth);
            std::string left = start + "0";
            std::string right = start + "1";
            for (int i = 1; i < apart; ++i) {
                const int by = static_cast<int>(random() % 2);
                left += static_cast<char>('0' + 2 * by + 1);
                right += static_cast<char>('0' + 2 * by);
            }
            const Cell a = cellAt(shape, left);
            const Cell b = cellAt(shape, right);
            ASSERT_EQ(a.x + 1U, b.x);
            ASSERT_EQ(a.y, b.y);
            for (std::size_t j = 0; j < 4; ++j) {
                for (std::size_t i = 0; i < 3; ++i) {
                    ++compared;
                    mismatches += a.window[4 * j + i + 1] != b.window[4 * j + i] ? 1 : 0;
                }
            }
        }
    }
    RecordProperty("compared", static_cast<int>(compared));
    EXPECT_EQ(mismatches, 0) << "of " << compared;
    EXPECT_GT(compared, 2000);
}

TEST(TerrainHeight, tiles_agree_with_descent_and_with_the_tiles_beside_them) {
    for (const Shape& shape : shapes()) {
        std::mt19937 random(3);
        const std::string path = randomPath(random, 137) + "0";
        const Cell left = cellAt(shape, path);
        const Cell right = cellAt(shape, path.substr(0, 137) + "1");
        constexpr int kLevels = 5;
        constexpr int kCells = 1 << kLevels;
        constexpr int kSide = kCells + 3;
        std::vector<VertexHeights> a(kSide * kSide);
        std::vector<VertexHeights> b(kSide * kSide);
        tileHeights(shape, left, kLevels, 1, a);
        tileHeights(shape, right, kLevels, 1, b);
        const auto at = [&](const std::vector<VertexHeights>& tile, int x, int y) {
            return tile[static_cast<std::size_t>((y + 1) * kSide + x + 1)];
        };
        int mismatches = 0;
        for (int y = -1; y <= kCells + 1; ++y) {
            for (int x = -1; x <= 1; ++x)
                mismatches += at(a, kCells + x, y) != at(b, x, y) ? 1 : 0;
        }
        for (int trial = 0; trial < 50; ++trial) {
            const int x = static_cast<int>(random() % kCells);
            const int y = static_cast<int>(random() % kCells);
            Cell cell = left;
            for (int m = kLevels - 1; m >= 0; --m) {
                if (m == 0) {
                    // The mesh of twice the spacing, where this vertex slides to, in this level's units.
                    const std::uint32_t corner = static_cast<std::uint32_t>(cell.window[5])
                                                 << static_cast<unsigned>(heightStep(shape, cell.level + 1));
                    mismatches += at(a, x, y).y != static_cast<std::int32_t>(corner) ? 1 : 0;
                }
                cell = childCell(shape, cell, ((x >> m) & 1) + 2 * ((y >> m) & 1));
            }
            mismatches += at(a, x, y).x != cell.window[5] ? 1 : 0;
            mismatches += at(a, x + 1, y - 1).x != cell.window[2] ? 1 : 0;
        }
        EXPECT_EQ(mismatches, 0);
    }
}

TEST(TerrainHeight, no_height_of_any_octave_is_outside_of_the_bounds) {
    for (const Shape& shape : shapes()) {
        std::mt19937 random(17);
        double used = 0.0;
        for (int trial = 0; trial < 40; ++trial) {
            const Cell cell = cellAt(shape, randomPath(random, static_cast<int>(random() % 300)));
            const Bounds bounds = heightBounds(shape, cell);
            std::int64_t least = 0;
            std::int64_t most = 0;
            // All vertices six levels down, and single ones 20 levels down.
            constexpr int kLevels = 6;
            std::vector<VertexHeights> tile(65 * 65);
            tileHeights(shape, cell, kLevels, 0, tile);
            const auto exponent = heightExponent(shape, cell.level + kLevels) - heightExponent(shape, cell.level);
            const std::int32_t corner = static_cast<std::int32_t>(static_cast<std::uint32_t>(cell.window[5])
                                                                  << static_cast<unsigned>(exponent));
            for (const VertexHeights& vertex : tile) {
                const std::int64_t above = heightDifference(vertex.x, corner);
                least = std::min(least, above);
                most = std::max(most, above);
            }
            const double unit = std::ldexp(1.0, -static_cast<int>(exponent));
            EXPECT_GE(static_cast<double>(least) * unit, bounds.least);
            EXPECT_LE(static_cast<double>(most) * unit, bounds.most);
            used = std::max(used, static_cast<double>(most - least) * unit / (bounds.most - bounds.least));
        }
        // Conservative, but not by orders of magnitude.
        EXPECT_GT(used, 0.3);
    }
}

TEST(TerrainHeight, slope_stays_in_range_where_the_terrain_is_self_affine_and_wanders_where_it_is_not) {
    const auto meanSlope = [](int hurst, int from, int to) {
        double sum = 0.0;
        int count = 0;
        for (std::uint32_t seed = 0; seed < 24; ++seed) {
            const Shape shape{Kernel::BSpline, seed, hurst};
            std::mt19937 random(seed);
            Cell cell = rootCell(shape);
            for (int level = 1; level <= to; ++level) {
                cell = childCell(shape, cell, static_cast<int>(random() % 4));
                if (level < from) continue;
                const double slope = slopeOf(cell) * verticalScale(shape, level, level);
                sum += slope * slope;
                ++count;
            }
        }
        return std::sqrt(sum / count);
    };
    const double shallow = meanSlope(800, 16, 100);
    const double deep = meanSlope(800, 1900, 2000);
    // 24 paths of about 20 independent octaves: 10 % of statistical error.
    EXPECT_NEAR(deep / shallow, 1.0, 0.25);
    // A random walk of that many steps: sqrt(1950 / 58) is 5.8.
    EXPECT_GT(meanSlope(1000, 1900, 2000) / meanSlope(1000, 16, 100), 3.0);
}

TEST(TerrainHeight, amplitudes_of_self_affine_levels_are_powers_of_two_to_the_missing_exponent) {
    for (const int hurst : {1000, 999, 800, 500, 123, 1}) {
        const Shape shape{Kernel::BSpline, 0, hurst};
        for (std::int64_t level = 0; level < 2500; level += 7) {
            const double growth = static_cast<double>(level) * (1000 - hurst) / 1000.0;
            const double expected = 4096.0 * std::exp2(growth - std::floor(growth + 1e-9));
            EXPECT_NEAR(static_cast<double>(amplitude(shape, level)), expected, 0.51) << hurst << " " << level;
            EXPECT_EQ(heightExponent(shape, level), level - static_cast<std::int64_t>(std::floor(growth + 1e-9)));
        }
    }
}

} // namespace
} // namespace apeiron::terrain
