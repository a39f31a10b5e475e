// The progressive loop's own parts: nothing here needs a GPU.

#include "core/error.hpp"
#include "render/accumulation.hpp"
#include "render/governor.hpp"
#include "render/interleave.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace apeiron::render {
namespace {

TEST(TileCursor, hands_out_every_texel_exactly_once) {
    std::mt19937 random(1);
    const auto upTo = [&](int most) { return std::uniform_int_distribution<int>(1, most)(random); };
    for (int round = 0; round < 200; ++round) {
        const glm::ivec2 size(upTo(90), upTo(60));
        const int most = round % 2 == 0 ? upTo(40) : upTo(4000);
        std::vector<int> times(static_cast<std::size_t>(size.x * size.y));
        TileCursor cursor(size);
        std::int64_t left = cursor.left();
        ASSERT_EQ(left, size.x * size.y);
        while (!cursor.done()) {
            const int texels = upTo(most);
            const gpu::Region region = cursor.take(texels);
            ASSERT_GT(region.size.x, 0);
            ASSERT_GT(region.size.y, 0);
            ASSERT_LE(region.size.x * region.size.y, texels);
            ASSERT_LE(region.origin.x + region.size.x, size.x);
            ASSERT_LE(region.origin.y + region.size.y, size.y);
            for (int y = 0; y < region.size.y; ++y) {
                for (int x = 0; x < region.size.x; ++x) {
                    ++times[static_cast<std::size_t>((region.origin.y + y) * size.x + region.origin.x + x)];
                }
            }
            left -= region.size.x * region.size.y;
            ASSERT_EQ(cursor.left(), left);
        }
        EXPECT_THAT(times, testing::Each(1)) << size.x << "x" << size.y;
    }
}

TEST(TileCursor, goes_band_by_band_and_column_by_column_within) {
    constexpr int kBand = TileCursor::kBand;
    TileCursor cursor({10, 3 * kBand + 1});
    EXPECT_EQ(cursor.take(3 * kBand + 1).size, glm::ivec2(3, kBand));
    EXPECT_EQ(cursor.take(3).size, glm::ivec2(1, 3)) << "part of a column";
    EXPECT_EQ(cursor.take(1000).size, glm::ivec2(1, kBand - 3)) << "the rest of a begun column";
    EXPECT_EQ(cursor.take(1000).size, glm::ivec2(6, kBand)) << "the rest of a begun band";
    EXPECT_EQ(cursor.take(10 * (2 * kBand - 1)).size, glm::ivec2(10, kBand)) << "whole bands";
    EXPECT_EQ(cursor.take(1000).size, glm::ivec2(10, kBand + 1)) << "all that is left, the low last band too";
    EXPECT_TRUE(cursor.done());
}

TEST(TileCursor, begins_anew_behind_the_bands_that_are_begun) {
    constexpr int kBand = TileCursor::kBand;
    TileCursor cursor({10, 3 * kBand});
    EXPECT_EQ(cursor.fresh(), 0);
    cursor.take(1);
    EXPECT_EQ(cursor.fresh(), kBand);
    cursor.take(1000);
    EXPECT_EQ(cursor.fresh(), kBand) << "the band that is just complete";
    cursor.take(20 * kBand - 1);
    EXPECT_EQ(TileCursor({10, 3 * kBand}, 2 * kBand + 3).fresh(), 2 * kBand) << "cyclically";
}

TEST(TileCursor, begins_at_any_row_and_still_hands_out_all) {
    for (const int first : {0, 3, 9}) {
        std::vector<int> times(70);
        TileCursor cursor({7, 10}, first);
        EXPECT_EQ(cursor.first(), first / TileCursor::kBand * TileCursor::kBand);
        std::int64_t taken = 0;
        while (!cursor.done()) {
            const gpu::Region region = cursor.take(17);
            taken += region.size.x * region.size.y;
            ASSERT_EQ(cursor.taken(), taken);
            for (int y = 0; y < region.size.y; ++y) {
                for (int x = 0; x < region.size.x; ++x)
                    ++times.at(static_cast<std::size_t>((region.origin.y + y) * 7 + region.origin.x + x));
            }
        }
        EXPECT_THAT(times, testing::Each(1)) << first;
    }
}

class EveryInterleave : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Factor, EveryInterleave, testing::Range(1, 9));

TEST_P(EveryInterleave, computes_each_offset_once_wherever_it_begins) {
    for (const int first : {0, 1, 5}) {
        const Interleave interleave(GetParam(), first);
        EXPECT_EQ(interleave.factor(), GetParam());
        std::vector<int> times(64);
        for (int i = 0; i < interleave.count(); ++i) {
            const glm::ivec2 offset = interleave.offset(i);
            ASSERT_LT(std::max(offset.x, offset.y), GetParam());
            ++times[static_cast<std::size_t>(offset.y * 8 + offset.x)];
        }
        EXPECT_EQ(std::count(times.begin(), times.end(), 1), interleave.count());
        EXPECT_EQ(interleave.offset(0), Interleave(GetParam()).offset(first % interleave.count()));
    }
}

TEST_P(EveryInterleave, covers_the_picture_evenly) {
    // Of n points, no pixel is farther from one than a lattice that wastes nothing would have it, by more than the
    // pixels' own grid: the circles of that radius around n points cover the torus about twice at most.
    const Interleave interleave(GetParam());
    const int k = GetParam();
    for (int done = 1; done <= interleave.count(); ++done) {
        const auto nearest = interleave.nearest(done);
        double farthest = 0.0;
        for (int y = 0; y < k; ++y) {
            for (int x = 0; x < k; ++x) {
                const int code = nearest[static_cast<std::size_t>(y * 8 + x)];
                const glm::ivec2 step(code % 16 - 8, code / 16 - 8);
                farthest = std::max(farthest, glm::length(glm::dvec2(step)));
                const glm::ivec2 there = (glm::ivec2(x, y) + step + k) % k;
                bool complete = false;
                for (int i = 0; i < done; ++i)
                    complete = complete || interleave.offset(i) == there;
                ASSERT_TRUE(complete) << done << " at " << x << ", " << y;
            }
        }
        EXPECT_LE(farthest, 1.45 * std::sqrt(static_cast<double>(k * k) / (3.14159 * done)) + 0.71) << done;
    }
}

TEST_P(EveryInterleave, of_a_power_of_two_visits_the_lattices_of_bayer) {
    if ((GetParam() & (GetParam() - 1)) != 0) GTEST_SKIP() << "no power of two";
    const Interleave interleave(GetParam());
    for (int done = 1, spacing = GetParam(); done <= interleave.count(); done *= 4, spacing /= 2) {
        for (int i = 0; i < done; ++i) {
            EXPECT_EQ(interleave.offset(i).x % spacing, 0) << i;
            EXPECT_EQ(interleave.offset(i).y % spacing, 0) << i;
        }
    }
}

TEST_P(EveryInterleave, blocks_hold_all_pixels_of_any_size) {
    const Interleave interleave(GetParam());
    for (int n = 1; n < 40; ++n) {
        const glm::ivec2 block = interleave.block({n, 40 - n});
        EXPECT_GE(block.x * GetParam(), n);
        EXPECT_LT((block.x - 1) * GetParam(), n);
        EXPECT_GE(block.y * GetParam(), 40 - n);
        EXPECT_LT((block.y - 1) * GetParam(), 40 - n);
    }
}

/// One sample of a 3 x 2 picture: radiance, alpha, normal, depth, albedo, hit.
using Sample = std::array<float, 12>;
constexpr int kPixels = 6;

std::vector<std::array<Sample, kPixels>> randomSamples(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0.0F, 2.0F);
    std::vector<std::array<Sample, kPixels>> samples(static_cast<std::size_t>(count));
    for (auto& picture : samples) {
        for (Sample& sample : picture)
            std::generate(sample.begin(), sample.end(), [&] { return value(random); });
    }
    return samples;
}

/// Means and sums of squared deviations by their definitions, in double.
Accumulation accumulated(const std::vector<std::array<Sample, kPixels>>& samples) {
    Accumulation result{Image<float>(3, 2, 4), Image<float>(3, 2, 4), Image<float>(3, 2, 4), Image<float>(3, 2, 4)};
    const auto n = static_cast<double>(samples.size());
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
        std::array<double, 12> mean{};
        std::array<double, 3> spread{};
        for (const auto& picture : samples) {
            for (std::size_t i = 0; i < 12; ++i)
                mean[i] += static_cast<double>(picture[pixel][i]) / n;
        }
        for (const auto& picture : samples) {
            for (std::size_t i = 0; i < 3; ++i) {
                spread[i] += std::pow(static_cast<double>(picture[pixel][i]) - mean[i], 2.0);
            }
        }
        for (std::size_t i = 0; i < 3; ++i) {
            result.mean.data()[pixel * 4 + i] = static_cast<float>(mean[i]);
            result.spread.data()[pixel * 4 + i] = static_cast<float>(spread[i]);
        }
        result.mean.data()[pixel * 4 + 3] = static_cast<float>(n);
        result.spread.data()[pixel * 4 + 3] = static_cast<float>(mean[3]);
        for (std::size_t i = 0; i < 4; ++i) {
            result.normal.data()[pixel * 4 + i] = static_cast<float>(mean[4 + i]);
            result.albedo.data()[pixel * 4 + i] = static_cast<float>(mean[8 + i]);
        }
    }
    return result;
}

/// Relative to 1, as all values are about that: some roundings of float.
void expectClose(const Accumulation& a, const Accumulation& b, double tolerance) {
    const auto compare = [&](const Image<float>& x, const Image<float>& y, const char* what) {
        for (std::size_t i = 0; i < x.data().size(); ++i) {
            const auto expected = static_cast<double>(y.data()[i]);
            ASSERT_NEAR(static_cast<double>(x.data()[i]), expected, tolerance * std::max(1.0, expected)) << what << i;
        }
    };
    compare(a.mean, b.mean, "mean ");
    compare(a.spread, b.spread, "spread ");
    compare(a.normal, b.normal, "normal ");
    compare(a.albedo, b.albedo, "albedo ");
}

TEST(Accumulation, merging_parts_gives_the_statistics_of_the_whole) {
    const auto all = randomSamples(100, 2);
    const auto part = [&](int from, int to) { return accumulated({all.begin() + from, all.begin() + to}); };
    for (const int cut : {1, 37, 50, 99}) {
        Accumulation merged = part(0, cut);
        merged.merge(part(cut, 100));
        // Each part was rounded to float once, and the result once: three half units in the last place.
        expectClose(merged, part(0, 100), 2e-7);
        Accumulation reversed = part(cut, 100);
        reversed.merge(part(0, cut));
        expectClose(reversed, merged, 2e-7);
        EXPECT_EQ(merged.samples(), 100);
    }
}

TEST(Accumulation, merging_is_associative) {
    const auto all = randomSamples(30, 3);
    const auto part = [&](int from, int to) { return accumulated({all.begin() + from, all.begin() + to}); };
    Accumulation left = part(0, 5);
    left.merge(part(5, 18));
    left.merge(part(18, 30));
    Accumulation tail = part(5, 18);
    tail.merge(part(18, 30));
    Accumulation right = part(0, 5);
    right.merge(tail);
    expectClose(left, right, 4e-7);
}

TEST(Accumulation, merging_with_nothing_changes_nothing) {
    const Accumulation some = accumulated(randomSamples(5, 4));
    const Accumulation nothing{Image<float>(3, 2, 4), Image<float>(3, 2, 4), Image<float>(3, 2, 4),
                               Image<float>(3, 2, 4)};
    Accumulation merged = some;
    merged.merge(nothing);
    expectClose(merged, some, 0.0);
    merged = nothing;
    merged.merge(some);
    expectClose(merged, some, 0.0);
}

TEST(Accumulation, refuses_to_merge_other_sizes) {
    Accumulation some = accumulated(randomSamples(5, 4));
    const Accumulation other{Image<float>(2, 3, 4), Image<float>(2, 3, 4), Image<float>(2, 3, 4),
                             Image<float>(2, 3, 4)};
    try {
        some.merge(other);
        FAIL() << "merged";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadInput);
        EXPECT_THAT(error.what(), testing::HasSubstr("3x2"));
        EXPECT_THAT(error.what(), testing::HasSubstr("2x3"));
    }
}

TEST(Accumulation, noise_is_the_relative_standard_error) {
    // Grey samples 1 - s, 1 + s: mean 1, variance of the mean s^2 / (n - 1) for n samples.
    for (const int n : {2, 10, 50}) {
        Accumulation a{Image<float>(3, 2, 4), Image<float>(3, 2, 4), Image<float>(3, 2, 4), Image<float>(3, 2, 4)};
        const double s = 0.25;
        for (std::size_t i = 0; i < kPixels; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                a.mean.data()[4 * i + c] = 1.0F;
                a.spread.data()[4 * i + c] = static_cast<float>(n * s * s);
            }
            a.mean.data()[4 * i + 3] = static_cast<float>(n);
        }
        EXPECT_NEAR(a.noise(), s / std::sqrt(n - 1.0), 1e-6);
    }
}

/// A device that takes so long for a submission; places of a picture differ by a factor of up to three.
struct Device {
    double overhead;
    double pixel;
    double time = 0.0;
    double longest = 0.0;

    double work(const gpu::Region& region, int height) {
        double seconds = overhead;
        for (int y = 0; y < region.size.y; ++y) {
            const double place = static_cast<double>(region.origin.y + y) / height;
            seconds += pixel * region.size.x * (0.5 + std::pow(std::sin(3.1416 * place), 2.0));
        }
        time += seconds;
        longest = std::max(longest, seconds);
        return seconds;
    }
};

/// Session::step()'s loop. @returns how long it took
double simulatedStep(Governor& governor, TileCursor& cursor, glm::ivec2 size, Device& device, double budget) {
    const double start = device.time;
    bool mustWork = true;
    for (;;) {
        const std::int64_t pixels = governor.next(budget - (device.time - start), mustWork);
        if (pixels <= 0) break;
        mustWork = false;
        if (cursor.done()) cursor = TileCursor(size);
        const gpu::Region region = cursor.take(pixels);
        const double seconds = device.work(region, size.y);
        governor.report(static_cast<std::int64_t>(region.size.x) * region.size.y, seconds);
        if (device.time - start >= budget) break;
    }
    return device.time - start;
}

constexpr glm::ivec2 kPicture{1920, 1080};

TEST(Governor, fills_steps_and_does_not_overrun_them_whatever_the_device) {
    for (const double pixel : {1e-9, 1e-8, 1e-7, 1e-6, 1e-5}) {
        for (const double overhead : {1e-5, 1e-4, 1e-3}) {
            for (const double budget : {0.01, 0.033, 0.1}) {
                SCOPED_TRACE(testing::Message()
                             << pixel << " s a pixel, " << overhead << " s a submission, budget " << budget);
                Governor governor;
                TileCursor cursor(kPicture);
                Device device{overhead, pixel};
                for (int warmUp = 0; warmUp < 60; ++warmUp) {
                    simulatedStep(governor, cursor, kPicture, device, budget);
                }
                device.longest = 0.0;
                double sum = 0.0;
                double worst = 0.0;
                constexpr int kSteps = 300;
                for (int i = 0; i < kSteps; ++i) {
                    const double seconds = simulatedStep(governor, cursor, kPicture, device, budget);
                    sum += seconds;
                    worst = std::max(worst, seconds);
                }
                EXPECT_GE(sum / kSteps, 0.6 * budget);
                // The dearest rows cost three times the cheapest, but neighbours hardly differ.
                EXPECT_LE(worst, 1.3 * budget + 2.0 * overhead);
                EXPECT_LE(device.longest, 1.5 * Governor::kMaxSubmission);
            }
        }
    }
}

TEST(Governor, fills_steps_with_many_samples_of_a_small_picture) {
    for (const glm::ivec2 size : {glm::ivec2(16, 16), glm::ivec2(48, 32), glm::ivec2(256, 256)}) {
        for (const double pixel : {1e-9, 1e-7}) {
            Governor governor;
            TileCursor cursor(size);
            Device device{1e-4, pixel};
            for (int i = 0; i < 20; ++i)
                simulatedStep(governor, cursor, size, device, 0.01);
            double sum = 0.0;
            for (int i = 0; i < 20; ++i)
                sum += simulatedStep(governor, cursor, size, device, 0.01);
            EXPECT_GE(sum, 0.6 * 20 * 0.01) << size.x << "x" << size.y << ", " << pixel << " s a pixel";
        }
    }
}

TEST(Governor, no_submission_comes_near_a_watchdog_when_a_step_has_all_the_time) {
    for (const double pixel : {1e-9, 1e-7, 1e-5, 1e-4}) {
        Governor governor;
        TileCursor cursor(kPicture);
        Device device{1e-4, pixel};
        for (int i = 0; i < 30; ++i)
            simulatedStep(governor, cursor, kPicture, device, 2.0);
        EXPECT_LE(device.longest, 0.5) << pixel;
    }
}

TEST(Governor, survives_work_that_is_suddenly_five_times_dearer) {
    Governor governor;
    TileCursor cursor(kPicture);
    Device device{1e-4, 1e-7};
    for (int i = 0; i < 30; ++i)
        simulatedStep(governor, cursor, kPicture, device, 1.0);
    device.pixel *= 5.0;
    for (int i = 0; i < 30; ++i)
        simulatedStep(governor, cursor, kPicture, device, 1.0);
    EXPECT_LE(device.longest, 2.0) << "the watchdog of common systems";
}

TEST(Governor, recovers_from_one_slow_submission) {
    for (const double budget : {0.01, 0.033}) {
        Governor governor;
        TileCursor cursor(kPicture);
        Device device{1e-4, 1e-7};
        for (int i = 0; i < 60; ++i)
            simulatedStep(governor, cursor, kPicture, device, budget);
        governor.report(Governor::kFirstPixels, 0.5); // another program had the processor
        for (int i = 0; i < 60; ++i)
            simulatedStep(governor, cursor, kPicture, device, budget);
        const double start = device.time;
        std::int64_t pixels = 0;
        for (int i = 0; i < 50; ++i) {
            const std::int64_t before = cursor.left();
            simulatedStep(governor, cursor, kPicture, device, budget);
            pixels +=
                before >= cursor.left() ? before - cursor.left() : before + kPicture.x * kPicture.y - cursor.left();
        }
        // As many pixels as the device can do in that time, up to the governor's reserve.
        EXPECT_GE(static_cast<double>(pixels) * device.pixel, 0.5 * (device.time - start)) << budget;
    }
}

TEST(Governor, works_when_it_must_and_stops_when_there_is_no_time) {
    Governor governor;
    EXPECT_EQ(governor.next(0.0, true), 1);
    EXPECT_EQ(governor.next(0.0, false), 0);
    EXPECT_EQ(governor.next(-1.0, false), 0);
    EXPECT_EQ(governor.next(1.0, true), Governor::kFirstPixels) << "nothing is known yet";
    governor.report(4096, 1.0);
    EXPECT_EQ(governor.next(1e-5, true), 1);
    EXPECT_EQ(governor.next(1e-5, false), 0);
    EXPECT_GT(governor.costPerPixel(), 0.0);
    governor.restart();
    EXPECT_EQ(governor.costPerPixel(), 0.0);
    EXPECT_EQ(governor.next(1.0, false), Governor::kFirstPixels);
}

} // namespace
} // namespace apeiron::render
