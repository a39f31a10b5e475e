#include "volume/bricked.hpp"
#include "volume/voxels.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace apeiron::volume {
namespace {

/// Noise with a few lonely peaks: what averaging hides and bounds must not.
std::shared_ptr<const Volume> noise(glm::ivec3 size) {
    auto volume = std::make_shared<Volume>(makeVolume(size, VoxelType::UInt8));
    std::mt19937 random(7);
    auto* voxels = mutableVoxels<std::uint8_t>(*volume);
    for (std::size_t i = 0; i < voxelsPerChannel(*volume); ++i)
        voxels[i] = static_cast<std::uint8_t>(random() % 97 == 0 ? 255 : 50 + random() % 20);
    return volume;
}

/// The mean of the voxels that one of a level covers, by the definition.
double meanAt(const Volume& volume, int level, glm::ivec3 voxel) {
    double sum = 0;
    int count = 0;
    const glm::ivec3 first = voxel * (1 << level);
    const glm::ivec3 end = glm::min((voxel + 1) * (1 << level), volume.size);
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x, ++count)
                sum += valueAt(volume, {x, y, z});
    return sum / count;
}

template <class Use> void forBricks(const BrickPyramid& pyramid, int level, const Use& use) {
    const glm::ivec3 bricks = pyramid.bricksOf(level);
    for (int z = 0; z < bricks.z; ++z)
        for (int y = 0; y < bricks.y; ++y)
            for (int x = 0; x < bricks.x; ++x)
                use(BrickKey{level, {x, y, z}});
}

TEST(BrickPyramidTest, levels_halve_until_one_brick_is_left) {
    const BrickPyramid pyramid({100, 70, 33}, boxReader(noise({100, 70, 33})));
    EXPECT_EQ(pyramid.levels(), 3);
    EXPECT_EQ(pyramid.sizeOf(1), glm::ivec3(50, 35, 17));
    EXPECT_EQ(pyramid.bricksOf(0), glm::ivec3(4, 3, 2));
    EXPECT_EQ(pyramid.bricksOf(2), glm::ivec3(1, 1, 1));
}

TEST(BrickPyramidTest, voxels_are_means_of_what_they_cover_and_borders_are_the_neighbours) {
    const auto volume = noise({100, 70, 33});
    const BrickPyramid pyramid(volume->size, boxReader(volume));
    for (int level = 0; level < pyramid.levels(); ++level)
        forBricks(pyramid, level, [&](const BrickKey& key) {
            const std::vector<float> values = pyramid.values(key);
            ASSERT_EQ(values.size() * sizeof(float), BrickPyramid::brickBytes());
            std::mt19937 random(3);
            for (int i = 0; i < 200; ++i) {
                const glm::ivec3 p(random() % 34, random() % 34, random() % 34);
                const glm::ivec3 voxel = glm::clamp(key.brick * 32 - 1 + p, glm::ivec3(0), pyramid.sizeOf(level) - 1);
                const float value = values[static_cast<std::size_t>((p.z * 34 + p.y) * 34 + p.x)];
                EXPECT_NEAR(static_cast<double>(value), meanAt(*volume, level, voxel), 1e-4); // single precision of 255
            }
        });
}

TEST(BrickPyramidTest, bounds_hold_for_all_values_of_this_and_finer_levels_with_their_borders) {
    const auto volume = noise({100, 70, 33});
    const BrickPyramid pyramid(volume->size, boxReader(volume));
    for (int level = 0; level < pyramid.levels(); ++level)
        forBricks(pyramid, level, [&](const BrickKey& key) {
            const ValueRange range = pyramid.range(key);
            for (const float value : pyramid.values(key)) {
                ASSERT_GE(value, range.low);
                ASSERT_LE(value, range.high);
            }
            // Finer bricks that it covers: their values, and their own bounds are within a border's width of it, so
            // values suffice.
            if (level == 0) return;
            forBricks(pyramid, level - 1, [&](const BrickKey& finer) {
                if (!(finer.parent() == key)) return;
                for (const float value : pyramid.values(finer)) {
                    ASSERT_GE(value, range.low);
                    ASSERT_LE(value, range.high);
                }
            });
        });
}

TEST(BrickPyramidTest, the_finest_level_that_fits_is_chosen) {
    const BrickPyramid pyramid({100, 70, 33}, boxReader(noise({100, 70, 33})));
    EXPECT_EQ(pyramid.levelThatFits(24 * BrickPyramid::brickBytes()), 0);
    EXPECT_EQ(pyramid.levelThatFits(24 * BrickPyramid::brickBytes() - 1), 1);
    EXPECT_EQ(pyramid.levelThatFits(1), 2);
}

TEST(BrickPyramidTest, rays_ask_for_every_brick_that_they_cross_in_order) {
    const BrickPyramid pyramid({128, 128, 128}, boxReader(noise({128, 128, 128})));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 origin = 64.0 + 200.0 * glm::normalize(glm::dvec3(any(random), any(random), any(random)));
        const glm::dvec3 target = 64.0 + 40.0 * glm::dvec3(any(random), any(random), any(random));
        const glm::dvec3 d = glm::normalize(target - origin);
        const std::vector<BrickKey> keys = pyramid.bricksAlong(origin, d, 0);
        const std::set<BrickKey> asked(keys.begin(), keys.end());
        EXPECT_EQ(asked.size(), keys.size()) << "a straight line comes to a brick once";
        for (double t = 0; t < 500; t += 0.05) {
            const glm::dvec3 p = origin + t * d;
            // Rays that graze a brick by less than the step may leave it out.
            const glm::dvec3 inside = glm::abs(glm::fract(p / 32.0) - 0.5);
            if (glm::any(glm::lessThan(p, glm::dvec3(0))) || glm::any(glm::greaterThanEqual(p, glm::dvec3(128))))
                continue;
            if (std::max({inside.x, inside.y, inside.z}) > 0.49) continue;
            EXPECT_EQ(asked.count({0, glm::ivec3(p / 32.0)}), 1U);
        }
    }
    const std::vector<BrickKey> far = pyramid.bricksAlong({-1000, 64, 64}, {1, 0, 0}, 0.004);
    EXPECT_EQ(far.front().level, 2); // a pixel is 4 voxels wide there
    EXPECT_TRUE(pyramid.bricksAlong({-10, -10, -10}, {-1, 0, 0}, 0).empty());
    EXPECT_EQ(pyramid.bricksAlong({64, 64, -5}, {0, 0, 1}, 0).size(), 4U);
}

TEST(BrickCacheTest, the_level_that_fits_comes_first_and_memory_is_never_exceeded) {
    const BrickPyramid pyramid({128, 128, 128}, boxReader(noise({128, 128, 128})));
    BrickCache cache(pyramid, 20 * BrickPyramid::brickBytes());
    EXPECT_EQ(cache.baseLevel(), 1); // 8 bricks of 20 / 2
    std::vector<BrickKey> all;
    forBricks(pyramid, 0, [&](const BrickKey& key) { all.push_back(key); });
    cache.request(all);
    EXPECT_EQ(cache.find(all.front()).values, nullptr);
    EXPECT_EQ(cache.load(8), 8);
    for (const BrickKey& key : all)
        EXPECT_EQ(cache.find(key).key, key.parent());
    EXPECT_EQ(cache.load(100), 12) << "what is most urgent fills the memory and is not thrown out for what is less";
    EXPECT_LE(cache.bytes(), cache.memory());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(cache.find(all[i]).key.level, i < 12 ? 0 : 1);
    EXPECT_EQ(cache.load(100), 0);
}

TEST(BrickCacheTest, what_was_not_used_for_the_longest_time_goes_first) {
    const BrickPyramid pyramid({128, 128, 128}, boxReader(noise({128, 128, 128})));
    BrickCache cache(pyramid, 18 * BrickPyramid::brickBytes());
    std::vector<BrickKey> all;
    forBricks(pyramid, 0, [&](const BrickKey& key) { all.push_back(key); });
    cache.request({all.begin(), all.begin() + 10});
    EXPECT_EQ(cache.load(100), 18);
    cache.find(all[0]);
    for (std::size_t i = 2; i < 10; ++i)
        cache.find(all[i]);
    cache.request({all[20]});
    EXPECT_EQ(cache.load(100), 1);
    EXPECT_EQ(cache.find(all[1]).key.level, 1) << "the one that nobody had looked at since";
    EXPECT_EQ(cache.find(all[0]).key.level, 0);
    EXPECT_EQ(cache.find(all[20]).key.level, 0);
    EXPECT_EQ(*cache.find(all[20]).values, pyramid.values(all[20]));
}

} // namespace
} // namespace apeiron::volume
