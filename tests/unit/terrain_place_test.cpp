#include "terrain/flight.hpp"
#include "terrain/place.hpp"
#include "terrain_support.hpp"

#include "support.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <unistd.h>

namespace apeiron::terrain {
namespace {

using test::messageOf;

TEST(TerrainAddress, text_of_any_length_comes_back) {
    std::mt19937 random(1);
    for (const int levels : {0, 1, 31, 32, 33, 3000, 100000}) {
        const std::string text = randomPath(random, levels);
        const Address address = Address::parse(text);
        EXPECT_EQ(address.levels(), levels);
        EXPECT_EQ(address.toString(), text);
    }
    EXPECT_EQ(Address::parse(" 01\n23 ").toString(), "0123");
}

TEST(TerrainAddress, wrong_characters_are_named_with_their_place) {
    EXPECT_EQ(messageOf([] { Address::parse("0124"); }), "an address has digits from 0 to 3, but character 4 is \"4\"");
    EXPECT_EQ(messageOf([] { Address::parse("x"); }), "an address has digits from 0 to 3, but character 1 is \"x\"");
}

TEST(TerrainAddress, a_million_digits_work_and_more_than_the_limit_are_refused) {
    EXPECT_EQ(Address::parse(std::string(1'000'000, '2')).levels(), 1'000'000);
    EXPECT_EQ(Address::parse(std::string(1U << 20U, '1')).levels(), Address::kMaxLevels);
    EXPECT_EQ(messageOf([] { Address::parse(std::string((1U << 20U) + 1, '1')); }),
              "an address has at most 1048576 digits; give a shorter one");
}

TEST(TerrainAddress, neighbours_are_found_by_carry) {
    Address address = Address::parse("01111");
    EXPECT_EQ(address.move(1, 0), 0);
    EXPECT_EQ(address.toString(), "10000");
    EXPECT_EQ(address.move(-1, 2), 0);
    EXPECT_EQ(address.toString(), "01131");
    EXPECT_EQ(address.move(0, 0), 5);
    // Out of the root cell, and nothing has changed.
    EXPECT_EQ(address.move(0, 1000), -1);
    EXPECT_EQ(address.toString(), "01131");
}

TEST(TerrainPlace, blocks_are_the_cells_that_paths_lead_to) {
    for (const Shape& shape : shapes()) {
        std::mt19937 random(8);
        const std::string path = randomPath(random, 700);
        const Place place(shape, Address::parse(path));
        for (const std::int64_t level : {0, 1, 63, 64, 65, 300, 690, 700}) {
            const Block block = place.ancestor(level);
            EXPECT_EQ(block.cell(), cellAt(shape, path.substr(0, static_cast<std::size_t>(level)))) << level;
            for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 1), std::pair(0, -1)}) {
                Address beside = Address::parse(path.substr(0, static_cast<std::size_t>(level)));
                if (beside.move(dx, dy) < 0) continue;
                EXPECT_EQ(block.cell(dx, dy), cellAt(shape, beside.toString())) << level;
            }
        }
    }
}

TEST(TerrainPlace, cells_near_are_the_cells_that_paths_lead_to) {
    const Shape shape{Kernel::BSpline, 6, 1000};
    std::mt19937 random(8);
    const std::string path = randomPath(random, 200);
    Place place(shape, Address::parse(path));
    place.setPosition({0.3, 0.8, 0.0});
    for (const std::int64_t level : {190, 199, 200, 205}) {
        for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(-37, 12), std::pair(300, -411)}) {
            Address address = Address::parse(path);
            while (address.levels() > level)
                address.pop();
            Place deeper = place;
            while (deeper.level() < level)
                deeper.descend();
            if (level > place.level()) address = deeper.address();
            ASSERT_GE(address.move(dx, dy), 0);
            const Cell cell = cellAt(shape, address.toString());
            EXPECT_EQ(place.cellNear(level, dx, dy), cell) << level << " " << dx;
            EXPECT_EQ(place.cellNamed({cell.level, cell.x, cell.y}), cell) << level << " " << dx;
        }
    }
}

TEST(TerrainPlace, going_down_and_up_again_changes_nothing) {
    for (const Shape& shape : shapes()) {
        std::mt19937 random(4);
        Place place(shape, Address::parse(randomPath(random, 100)));
        place.setPosition({0.123456789, 0.987654321, 1.5});
        const Place before = place;
        // Heights are known as far as 2^18 cells from the ground: no deeper, as high as this.
        for (int i = 0; i < 15; ++i)
            place.descend();
        for (int i = 0; i < 15; ++i)
            place.ascend();
        EXPECT_EQ(place, before);
        for (int i = 0; i < 2000; ++i)
            place.descend();
        EXPECT_EQ(place.level(), 2100);
        EXPECT_EQ(place.cell(), cellAt(shape, place.address().toString()));
        for (int i = 0; i < 2000; ++i)
            place.ascend();
        EXPECT_EQ(place.address(), before.address());
        EXPECT_EQ(place.block(), before.block());
        EXPECT_EQ(place.x(), before.x());
        EXPECT_EQ(place.y(), before.y());
    }
}

TEST(TerrainPlace, the_point_stays_where_it_is_when_the_cell_changes) {
    for (const Shape& shape : shapes()) {
        std::mt19937 random(4);
        Place place(shape, Address::parse(randomPath(random, 100)));
        place.setPosition({0.3, 0.9, 2.25});
        const Cell mark = place.cell();
        const glm::dvec3 before = place.toCell(mark);
        double vertical = 1.0;
        for (int i = 1; i <= 10; ++i) {
            place.descend();
            vertical = std::ldexp(1.0, static_cast<int>(heightExponent(shape, 100 + i) - heightExponent(shape, 100)));
            const glm::dvec3 now = place.toCell(mark);
            EXPECT_DOUBLE_EQ(now.x, std::ldexp(before.x, i));
            EXPECT_DOUBLE_EQ(now.z, before.z * vertical);
        }
    }
}

TEST(TerrainPlace, moves_lead_to_the_same_place_as_its_address) {
    const Shape shape{Kernel::BSpline, 2, 800};
    std::mt19937 random(14);
    std::uniform_real_distribution<double> offset(-3.0, 3.0);
    Place place(shape, Address::parse(randomPath(random, 500)));
    for (int i = 0; i < 200; ++i)
        ASSERT_TRUE(place.move({offset(random), offset(random), 0.0}));
    const Place again(shape, place.address());
    EXPECT_EQ(place.block(), again.block());
    EXPECT_EQ(place.ancestor(476), again.ancestor(476));
    EXPECT_EQ(place.ancestor(64), again.ancestor(64));
}

TEST(TerrainPlace, the_border_of_the_root_cell_is_not_crossed) {
    Place place({}, Address::parse("000"));
    place.setPosition({0.5, 0.5, 0.0});
    const Place before = place;
    EXPECT_FALSE(place.move({-1.0, 0.0, 0.0}));
    EXPECT_EQ(place, before);
}

TEST(TerrainPlace, flat_seeking_paths_stay_flat) {
    const Shape shape{Kernel::BSpline, 12, 1000};
    const Address address = flatSeekingAddress(shape, Address::parse("123"), 10'000);
    EXPECT_EQ(address.levels(), 10'000);
    EXPECT_EQ(address.prefix(3).toString(), "123");
    Cell cell = rootCell(shape);
    double steepest = 0.0;
    for (std::int64_t n = 0; n < address.levels(); ++n) {
        cell = childCell(shape, cell, address.digit(n));
        if (n > 100) steepest = std::max(steepest, slopeOf(cell));
    }
    // A random path has a root mean square of 0.465 sqrt(10,000) = 46 down there.
    EXPECT_LT(steepest, 2.5);
}

/// Resident memory of this process [bytes]; 0 where that says nothing: AddressSanitizer keeps what was freed in a
/// quarantine of hundreds of megabytes, so that memory grows whatever the program does.
std::size_t residentMemory() {
#ifdef __SANITIZE_ADDRESS__
    return 0;
#else
    std::ifstream file("/proc/self/statm");
    std::size_t total = 0;
    std::size_t resident = 0;
    file >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
#endif
}

class TerrainDive : public testing::TestWithParam<int> {};

TEST_P(TerrainDive, three_thousand_four_hundred_levels_down_and_home_again) {
    const Shape shape{Kernel::BSpline, 7, GetParam()};
    Place start(shape, flatSeekingAddress(shape, {}, 40));
    start.setPosition({0.5, 0.5, 3.0});
    Flight flight(start, glm::angleAxis(1.2, glm::dvec3(1, 0, 0)));
    const Place home = flight.place();
    constexpr std::int64_t kLevels = 3400;
    EXPECT_NEAR(scalePower(static_cast<double>(kLevels)), -1023.5, 0.1);
    std::size_t warm = 0;
    double slopes = 0.0;
    double slopesSquared = 0.0;
    std::int64_t steps = 0;
    std::int64_t contacts = 0;
    for (; flight.place().level() < 40 + kLevels && steps < 100'000; ++steps) {
        flight.dive(0.35, 1.0);
        contacts += flight.clearance() > 0.0 ? 0 : 1;
        const double slope = slopeOf(flight.place().cell()) * flight.relief();
        slopes += slope;
        slopesSquared += slope * slope;
        if (warm == 0 && flight.place().level() >= 340) warm = residentMemory();
    }
    EXPECT_EQ(contacts, 0);
    EXPECT_GE(flight.place().level(), 40 + kLevels);
    // Neither a plain nor a wall.
    const double meanSlope = slopes / static_cast<double>(steps);
    EXPECT_GT(meanSlope, 0.2);
    EXPECT_LT(meanSlope, 2.5);
    EXPECT_LT(std::sqrt(slopesSquared / static_cast<double>(steps)), 3.5);
    const std::size_t deep = residentMemory();
    if (warm != 0) {
        EXPECT_LT(static_cast<double>(deep), 1.05 * static_cast<double>(warm));
    }
    std::int64_t back = 0;
    while (!flight.flyHome(home, 0.35, 1.0) && back < 100'000) {
        contacts += flight.clearance() > 0.0 ? 0 : 1;
        ++back;
    }
    EXPECT_EQ(contacts, 0);
    EXPECT_EQ(flight.place(), home);
    RecordProperty("steps", static_cast<int>(steps));
}

INSTANTIATE_TEST_SUITE_P(plain_and_self_affine, TerrainDive, testing::Values(1000, 800));

TEST(TerrainFlight, aimed_straight_at_the_ground_it_comes_nearer_for_ever) {
    const Shape shape{Kernel::BSpline, 21, 1000};
    Place start(shape, flatSeekingAddress(shape, {}, 30));
    start.setPosition({0.4, 0.6, 2.0});
    Flight flight(start); // looks down
    for (int i = 0; i < 2000; ++i) {
        flight.fly({0, 0, -1}, 3.0, 1.0);
        ASSERT_GT(flight.clearance(), 0.0) << i;
    }
    EXPECT_GT(flight.place().level(), 400);
}

} // namespace
} // namespace apeiron::terrain
