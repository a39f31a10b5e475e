// What renderers know beforehand of a volume's bricks, against every voxel and every texel.

#include "volume/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace apeiron::test {
namespace {

using volume::BrickRanges;
using volume::Volume;

Volume randomVolume(glm::ivec3 size, int channels, unsigned seed) {
    Volume made = volume::makeVolume(size, volume::VoxelType::Int16, channels);
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < made.voxels.size(); i += 2) {
        // Smooth enough that bricks differ: a place's own level, and noise on it.
        const auto level = static_cast<int>((i / 2) % static_cast<std::size_t>(size.x)) * 40;
        const auto value = static_cast<std::int16_t>(level + static_cast<int>(random() % 200U) - 100);
        std::memcpy(&made.voxels[i], &value, sizeof value);
    }
    return made;
}

float voxel(const Volume& made, int channel, glm::ivec3 at) {
    at = glm::clamp(at, glm::ivec3(0), made.size - 1);
    std::vector<float> slice(static_cast<std::size_t>(made.size.x) * static_cast<std::size_t>(made.size.y));
    readSlice(made, 0, channel, at.z, slice);
    return slice[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(made.size.x) +
                 static_cast<std::size_t>(at.x)];
}

TEST(BrickRanges, hold_exactly_what_is_interpolated_within_each_brick) {
    const Volume made = randomVolume({19, 9, 21}, 2, 3);
    for (const int side : {4, 8}) {
        const BrickRanges ranges = brickRanges(made, 0, side);
        ASSERT_EQ(ranges.size, (made.size + side - 1) / side);
        std::size_t i = 0;
        for (int channel = 0; channel < 2; ++channel) {
            for (int z = 0; z < ranges.size.z; ++z) {
                for (int y = 0; y < ranges.size.y; ++y) {
                    for (int x = 0; x < ranges.size.x; ++x, ++i) {
                        glm::vec2 truth(1e9F, -1e9F);
                        const glm::ivec3 first = glm::ivec3(x, y, z) * side;
                        for (int c = -1; c <= side; ++c) {
                            for (int b = -1; b <= side; ++b) {
                                for (int a = -1; a <= side; ++a) {
                                    const glm::ivec3 at = first + glm::ivec3(a, b, c);
                                    if (glm::any(glm::greaterThanEqual(at, made.size))) continue;
                                    const float value = voxel(made, channel, at);
                                    truth = {std::min(truth.x, value), std::max(truth.y, value)};
                                }
                            }
                        }
                        ASSERT_EQ(ranges.ranges[i], truth) << x << " " << y << " " << z << " channel " << channel;
                    }
                }
            }
        }
    }
}

TEST(Majorants, are_never_below_the_opacity_of_a_value_in_the_brick) {
    const Volume made = randomVolume({33, 17, 20}, 1, 7);
    const BrickRanges ranges = brickRanges(made, 0, 8);
    std::mt19937 random(11);
    constexpr std::size_t kWidth = 1024;
    std::vector<float> table(kWidth, 0.0F);
    for (int spike = 0; spike < 5; ++spike)
        table[random() % kWidth] = 0.1F + 0.1F * static_cast<float>(spike);
    const glm::dvec2 lookup(1.0 / 1600.0, 0.1);
    const std::vector<float> most = majorants(ranges, table, kWidth, std::vector{lookup});
    for (std::size_t i = 0; i < most.size(); ++i) {
        const glm::vec2 range = ranges.ranges[i];
        float truth = 0.0F;
        for (int k = 0; k <= 20000; ++k) {
            const double value = glm::mix(static_cast<double>(range.x), static_cast<double>(range.y), k / 20000.0);
            const double place = std::clamp(lookup.x * value + lookup.y, 0.0, 1.0);
            truth = std::max(truth, table[static_cast<std::size_t>(place * (kWidth - 1) + 0.5)]);
        }
        EXPECT_GE(std::max(most[i], 0.0F), truth) << "brick " << i;
        if (most[i] < 0.0F) {
            EXPECT_EQ(truth, 0.0F);
        }
    }
}

TEST(Majorants, say_how_many_bricks_around_are_free) {
    const Volume made = randomVolume({80, 64, 72}, 1, 5);
    const BrickRanges ranges = brickRanges(made, 0, 8);
    std::vector<float> table(64, 0.0F);
    table[20] = 1.0F; // some bricks only
    const std::vector<float> most = majorants(ranges, table, 64, std::vector{glm::dvec2(1.0 / 3300.0, 0.1)});
    const auto at = [&](glm::ivec3 p) {
        return most[static_cast<std::size_t>((p.z * ranges.size.y + p.y) * ranges.size.x + p.x)];
    };
    int free = 0;
    for (int z = 0; z < ranges.size.z; ++z) {
        for (int y = 0; y < ranges.size.y; ++y) {
            for (int x = 0; x < ranges.size.x; ++x) {
                int nearest = std::max({ranges.size.x, ranges.size.y, ranges.size.z});
                for (int c = 0; c < ranges.size.z; ++c) {
                    for (int b = 0; b < ranges.size.y; ++b) {
                        for (int a = 0; a < ranges.size.x; ++a) {
                            if (at({a, b, c}) > 0.0F)
                                nearest =
                                    std::min(nearest, std::max({std::abs(a - x), std::abs(b - y), std::abs(c - z)}));
                        }
                    }
                }
                if (nearest == 0) {
                    EXPECT_EQ(at({x, y, z}), 1.0F);
                } else {
                    EXPECT_EQ(at({x, y, z}), static_cast<float>(-nearest));
                    ++free;
                }
            }
        }
    }
    EXPECT_GT(free, 100); // both kinds were there
    EXPECT_LT(free, static_cast<int>(most.size()));
}

TEST(Majorants, of_channels_add) {
    const Volume made = randomVolume({16, 16, 16}, 2, 9);
    const BrickRanges ranges = brickRanges(made, 0, 8);
    std::vector<float> tables(128, 0.25F);
    std::fill(tables.begin() + 64, tables.end(), 0.5F);
    const std::vector<glm::dvec2> lookup(2, glm::dvec2(1e-3, 0.0));
    for (const float value : majorants(ranges, tables, 64, lookup))
        EXPECT_EQ(value, 0.75F);
}

} // namespace
} // namespace apeiron::test
