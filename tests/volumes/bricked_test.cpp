// Large volumes: levels, bricks, ranges, which bricks are wanted, and who gets which place.

#include "volume/brick_choice.hpp"
#include "volume/brick_slots.hpp"
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
std::shared_ptr<const Volume> noise(glm::ivec3 size, int channels = 1) {
    auto volume = std::make_shared<Volume>(makeVolume(size, VoxelType::UInt8, channels));
    std::mt19937 random(7);
    auto* voxels = mutableVoxels<std::uint8_t>(*volume);
    for (std::size_t i = 0; i < volume->voxels.size(); ++i)
        voxels[i] = static_cast<std::uint8_t>(random() % 97 == 0 ? 255 : 50 + random() % 20);
    return volume;
}

/// The mean of the voxels that one of a level covers, by the definition.
double meanAt(const Volume& volume, int channel, int level, glm::ivec3 voxel) {
    double sum = 0;
    int count = 0;
    const glm::ivec3 first = voxel * (1 << level);
    const glm::ivec3 end = glm::min((voxel + 1) * (1 << level), volume.size);
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x, ++count)
                sum += valueAt(volume, {x, y, z}, channel);
    return sum / count;
}

template <class Use> void forEach(glm::ivec3 end, const Use& use) {
    for (int z = 0; z < end.z; ++z)
        for (int y = 0; y < end.y; ++y)
            for (int x = 0; x < end.x; ++x)
                use(glm::ivec3(x, y, z));
}

/// Seen from +z in parallel projection, a voxel as large as `pixels`.
BrickView viewFromAbove(glm::ivec3 size, double pixels) {
    BrickView view;
    view.toCamera[3] = glm::dvec4(-0.5 * glm::dvec3(size), 1.0);
    view.toCamera[3].z -= 2.0 * size.z;
    view.orthographic = true;
    view.extent = size.y;
    view.height = static_cast<int>(pixels * size.y);
    view.aspect = static_cast<double>(size.x) / size.y;
    return view;
}

TEST(BrickPyramid, halves_until_one_brick_is_left) {
    const BrickPyramid pyramid({100, 70, 33});
    EXPECT_EQ(pyramid.levels(), 3);
    EXPECT_EQ(pyramid.sizeOf(1), glm::ivec3(50, 35, 17));
    EXPECT_EQ(pyramid.bricksOf(0), glm::ivec3(4, 3, 2));
    EXPECT_EQ(pyramid.bricksOf(2), glm::ivec3(1, 1, 1));
    EXPECT_EQ(pyramid.brickCount(0), 24U);
}

TEST(BrickValues, are_means_of_what_they_cover_with_their_neighbours_as_border) {
    const auto volume = noise({100, 70, 33}, 2);
    const BrickPyramid pyramid(volume->size);
    const LargeVolume large = inParts(volume);
    for (int level = 0; level < pyramid.levels(); ++level)
        forEach(pyramid.bricksOf(level), [&](glm::ivec3 brick) {
            const std::vector<float> values = brickValues(large, {level, brick}, 1, 0);
            ASSERT_EQ(values.size(), BrickPyramid::kStoredVoxels);
            std::mt19937 random(3);
            for (int i = 0; i < 200; ++i) {
                const glm::ivec3 p(random() % 34, random() % 34, random() % 34);
                const glm::ivec3 voxel = glm::clamp(brick * 32 - 1 + p, glm::ivec3(0), pyramid.sizeOf(level) - 1);
                const float value = values[static_cast<std::size_t>((p.z * 34 + p.y) * 34 + p.x)];
                ASSERT_NEAR(value, meanAt(*volume, 1, level, voxel), 1e-4); // single precision of 255
            }
        });
}

TEST(Survey, overview_is_a_coarser_volume_at_the_same_place_and_ranges_are_those_of_all_voxels) {
    auto made = std::make_shared<Volume>(*noise({53, 40, 37}, 2));
    made->slope = 2.0;
    made->intercept = -7.0;
    centre(*made, {1.0, 2.0, 3.0});
    const Survey seen = survey(inParts(made), 0, 2, 8);
    EXPECT_EQ(seen.overview.size, glm::ivec3(14, 10, 10));
    EXPECT_EQ(seen.ranges.ranges, brickRanges(*made, 0, 8).ranges);
    for (int channel = 0; channel < 2; ++channel)
        forEach(seen.overview.size, [&](glm::ivec3 p) {
            // Bytes are rounded; the slope doubles that.
            ASSERT_NEAR(valueAt(seen.overview, p, channel), meanAt(*made, channel, 2, p), 2.0 * 0.501);
        });
    // Coarse voxel (1, 1, 1) has its centre between those of voxels 5 and 6.
    const glm::dvec4 coarse = seen.overview.indexToWorld * glm::dvec4(1.0, 1.0, 1.0, 1.0);
    const glm::dvec4 fine = made->indexToWorld * glm::dvec4(5.5, 5.5, 5.5, 1.0);
    EXPECT_LT(glm::length(coarse - fine), 1e-12);
}

TEST(CoarserRanges, hold_for_all_that_is_interpolated_at_that_level_and_finer_ones) {
    const auto volume = noise({80, 70, 50});
    const LargeVolume large = inParts(volume);
    const BrickRanges ranges = brickRanges(*volume, 0, 8);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    BrickRanges finer = ranges;
    for (int level = 0; level < 3; ++level) {
        const BrickRanges coarser = coarserRanges(ranges, level);
        // One brick holds the level as far as 32 of its voxels.
        const std::vector<float> values = brickValues(large, {level, {0, 0, 0}}, 0, 0);
        const glm::dvec3 most = glm::min(glm::dvec3(volume->size), glm::dvec3(32 << level));
        for (int i = 0; i < 20'000; ++i) {
            const glm::dvec3 place = most * glm::dvec3(any(random), any(random), any(random));
            const glm::dvec3 p = place / static_cast<double>(1 << level) + 0.5; // the border's voxel is at 0.5
            const glm::ivec3 cell(glm::floor(p));
            const glm::dvec3 part = p - glm::dvec3(cell);
            double value = 0.0;
            for (int corner = 0; corner < 8; ++corner) {
                const glm::ivec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
                const glm::ivec3 at = cell + side;
                const glm::dvec3 weight = glm::mix(1.0 - part, part, glm::dvec3(side));
                value += weight.x * weight.y * weight.z *
                         static_cast<double>(values[static_cast<std::size_t>((at.z * 34 + at.y) * 34 + at.x)]);
            }
            const glm::ivec3 brick = glm::min(glm::ivec3(place) / 8, ranges.size - 1);
            const std::size_t index =
                static_cast<std::size_t>((brick.z * ranges.size.y + brick.y) * ranges.size.x + brick.x);
            ASSERT_GE(value, static_cast<double>(coarser.ranges[index].x) - 1e-3) << level;
            ASSERT_LE(value, static_cast<double>(coarser.ranges[index].y) + 1e-3) << level;
        }
        for (std::size_t i = 0; i < ranges.ranges.size(); ++i) {
            ASSERT_LE(coarser.ranges[i].x, finer.ranges[i].x);
            ASSERT_GE(coarser.ranges[i].y, finer.ranges[i].y);
        }
        finer = coarser;
    }
}

TEST(NeededBricks, are_those_with_something_within_a_brick_of_ranges) {
    const glm::ivec3 size(128, 96, 64);
    const BrickPyramid pyramid(size);
    BrickRanges ranges;
    ranges.side = 8;
    ranges.size = size / 8;
    std::vector<float> seen(16 * 12 * 8, -1.0F);
    const auto mark = [&](glm::ivec3 p) { seen[static_cast<std::size_t>((p.z * 12 + p.y) * 16 + p.x)] = 0.5F; };
    mark({5, 5, 1});  // within brick (1, 1, 0)
    mark({12, 0, 4}); // on the border of (3, 0, 1): its neighbours need what is beside it
    const std::vector<std::uint8_t> needed = neededBricks(pyramid, ranges, seen);
    std::set<std::size_t> which;
    for (std::size_t i = 0; i < needed.size(); ++i)
        if (needed[i] != 0) which.insert(i);
    const auto index = [](int x, int y, int z) { return static_cast<std::size_t>((z * 3 + y) * 4 + x); };
    EXPECT_EQ(which,
              (std::set<std::size_t>{index(1, 1, 0), index(3, 0, 1), index(2, 0, 1), index(3, 0, 0), index(2, 0, 0)}));
}

TEST(BrickChoice, takes_the_finest_of_all_that_is_needed_where_that_fits) {
    const BrickPyramid pyramid({128, 128, 128});
    std::vector<std::uint8_t> needed(64, 0);
    for (const std::size_t i : {0U, 21U, 42U, 63U})
        needed[i] = 1;
    // However small it looks.
    const BrickView view = viewFromAbove(pyramid.size(), 0.01);
    const std::vector<BrickKey> some = chooseBricks(pyramid, 2, needed, view, 10);
    ASSERT_EQ(some.size(), 4U);
    EXPECT_EQ(some.front(), (BrickKey{0, {3, 3, 3}})) << "the nearest first";
    EXPECT_EQ(some.back(), (BrickKey{0, {0, 0, 0}}));
    const std::vector<BrickKey> all = chooseBricks(pyramid, 2, needed, view, 64);
    EXPECT_EQ(std::set<BrickKey>(all.begin(), all.end()).size(), 64U);
    EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin())) << "what is needed comes first";
}

TEST(BrickChoice, has_voxels_of_about_a_pixel_and_never_two_bricks_of_one_place_nor_more_than_there_is_room_for) {
    const BrickPyramid pyramid({512, 512, 512});
    const std::vector<std::uint8_t> needed(pyramid.brickCount(0), 1);
    const auto check = [&](const BrickView& view, std::size_t capacity) {
        const std::vector<BrickKey> chosen = chooseBricks(pyramid, 3, needed, view, capacity);
        EXPECT_LE(chosen.size(), capacity);
        std::set<int> levels;
        std::vector<int> covered(pyramid.brickCount(0), 0);
        for (const BrickKey& key : chosen) {
            EXPECT_LT(key.level, 3);
            levels.insert(key.level);
            forEach(glm::ivec3(1 << key.level), [&](glm::ivec3 p) {
                const glm::ivec3 at = (key.brick << key.level) + p;
                if (glm::all(glm::lessThan(at, glm::ivec3(16))))
                    ++covered[static_cast<std::size_t>((at.z * 16 + at.y) * 16 + at.x)];
            });
        }
        EXPECT_EQ(*std::max_element(covered.begin(), covered.end()), 1);
        EXPECT_EQ(chooseBricks(pyramid, 3, needed, view, capacity), chosen);
        return levels;
    };
    EXPECT_EQ(check(viewFromAbove(pyramid.size(), 0.5), 600), std::set<int>{1});
    EXPECT_EQ(check(viewFromAbove(pyramid.size(), 0.25), 600), std::set<int>{2});
    EXPECT_EQ(check(viewFromAbove(pyramid.size(), 1.0), 600), (std::set<int>{0, 1})) << "as fine as there is room for";

    // From a corner in perspective: fine near the camera, coarse far away.
    BrickView near = viewFromAbove(pyramid.size(), 1.0);
    near.orthographic = false;
    near.extent = 1.0;
    near.height = 256;
    near.toCamera[3] = glm::dvec4(-256.0, -256.0, -530.0, 1.0);
    EXPECT_EQ(check(near, 2000), (std::set<int>{0, 1}));
    const std::vector<BrickKey> chosen = chooseBricks(pyramid, 3, needed, near, 600);
    EXPECT_EQ(chosen.front().brick.z, 15) << "nearest first";
}

TEST(BrickChoice, prefers_what_the_picture_shows) {
    const BrickPyramid pyramid({256, 256, 256});
    const std::vector<std::uint8_t> needed(pyramid.brickCount(0), 1);
    BrickView view = viewFromAbove(pyramid.size(), 2.0);
    view.extent = 96.0; // the middle only
    view.height = 192;
    view.aspect = 1.0;
    int inside = 0;
    int outside = 0;
    for (const BrickKey& key : chooseBricks(pyramid, 2, needed, view, 200)) {
        const bool seen = sightOf(view, key).inPicture;
        if (key.level == 0) {
            EXPECT_TRUE(sightOf(view, key.ancestor(1)).inPicture) << key.brick.x << " " << key.brick.y;
        }
        (seen ? inside : outside) += 1;
    }
    EXPECT_GT(inside, 100);
    EXPECT_GT(outside, 10);
}

TEST(BrickSlots, wanted_bricks_stay_and_those_not_wanted_for_the_longest_time_go_first) {
    BrickSlots slots(6);
    const auto key = [](int i) { return BrickKey{0, {i, 0, 0}}; };
    slots.pin({3, {0, 0, 0}});
    const auto loadAll = [&] {
        std::vector<BrickKey> order;
        while (const auto next = slots.next()) {
            order.push_back(next->key);
            slots.arrived();
            EXPECT_EQ(slots.find(next->key), next->slot);
        }
        return order;
    };
    slots.want({key(2), key(1), key(0)});
    EXPECT_EQ(slots.missing(), 3U);
    EXPECT_EQ(loadAll(), (std::vector<BrickKey>{key(2), key(1), key(0)}));
    slots.want({key(3), key(1)});
    EXPECT_EQ(loadAll(), std::vector<BrickKey>{key(3)});
    slots.want({key(4)});
    EXPECT_EQ(loadAll(), std::vector<BrickKey>{key(4)}) << "there was a free place";
    EXPECT_EQ(slots.used(), 6U);
    slots.want({key(5), key(3)});
    EXPECT_FALSE(slots.find(key(0)) && slots.find(key(2))) << "one of the two that were wanted at first only";
    EXPECT_TRUE(slots.find(key(1)) && slots.find(key(3)) && slots.find(key(4)));
    loadAll();
    slots.want({key(10), key(11), key(12), key(13), key(14)});
    loadAll();
    EXPECT_TRUE(slots.find({3, {0, 0, 0}})) << "pinned";
    for (int i = 10; i < 15; ++i)
        EXPECT_TRUE(slots.find(key(i)));
    EXPECT_EQ(slots.used(), 6U);
}

TEST(BrickSlots, wishes_that_change_before_they_are_fulfilled_are_forgotten) {
    BrickSlots slots(3);
    const auto key = [](int i) { return BrickKey{0, {i, 0, 0}}; };
    slots.want({key(0), key(1), key(2)});
    slots.arrived();
    slots.want({key(5), key(0)});
    EXPECT_EQ(slots.missing(), 1U);
    slots.arrived();
    EXPECT_TRUE(slots.find(key(0)) && slots.find(key(5)));
    EXPECT_FALSE(slots.find(key(1)));
    EXPECT_FALSE(slots.next());
}

} // namespace
} // namespace apeiron::volume
