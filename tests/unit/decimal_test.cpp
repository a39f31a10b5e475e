#include "core/decimal.hpp"
#include "support.hpp"

#include <cmath>
#include <limits>
#include <random>

namespace apeiron {
namespace {

using test::messageOf;

std::string canonical(std::string_view text) {
    return Decimal::parse(text).toString();
}
Decimal d(std::string_view text) {
    return Decimal::parse(text);
}

TEST(DecimalTest, text_becomes_canonical) {
    EXPECT_EQ(Decimal().toString(), "0");
    EXPECT_EQ(canonical("-12.50"), "-12.5");
    EXPECT_EQ(canonical(".5"), "0.5");
    EXPECT_EQ(canonical("5."), "5");
    EXPECT_EQ(canonical("007"), "7");
    EXPECT_EQ(canonical("+3E4"), "30000");
    EXPECT_EQ(canonical("1e-5"), "0.00001");
    EXPECT_EQ(canonical("1200e-2"), "12");
    EXPECT_EQ(canonical("-0.000"), "0");
    EXPECT_EQ(canonical("0e999999999999999999999"), "0");
}

TEST(DecimalTest, other_text_is_refused) {
    for (const char* text :
         {"", "-", ".", "e5", "1e", "1e+", "1.2.3", "0x10", "inf", "nan", " 1", "1 ", "1,5", "--1", "1e5.0", "1-2"})
        EXPECT_THROW(d(text), Error) << text;
    EXPECT_EQ(messageOf([] { d("abc"); }), "expected a number, got \"abc\"");
}

TEST(DecimalTest, absurd_lengths_are_refused_before_they_are_written_out) {
    EXPECT_THROW(d("1e999999999999"), Error);
    EXPECT_THROW(d("1e-999999999999"), Error);
    EXPECT_THROW(d("1e100000"), Error);
    EXPECT_NO_THROW(d("1e99999"));
    EXPECT_NO_THROW(d("1e-100000"));
    EXPECT_THROW(d("1e99999") + d("1e-99999"), Error) << "the sum would not read back";
}

TEST(DecimalTest, doubles_survive_the_round_trip) {
    EXPECT_EQ(Decimal(0.1).toString(), "0.1");
    EXPECT_EQ(Decimal(-2.0).toString(), "-2");
    EXPECT_EQ(Decimal(1e22).toString(), "10000000000000000000000");
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::uniform_int_distribution<int> exponent(-1070, 1020);
    for (int i = 0; i < 2000; ++i) {
        const double value = std::ldexp(mantissa(random), exponent(random));
        EXPECT_EQ(Decimal(value).toDouble(), value);
    }
    EXPECT_EQ(Decimal(std::numeric_limits<double>::denorm_min()).toDouble(), std::numeric_limits<double>::denorm_min());
}

TEST(DecimalTest, outside_the_range_of_doubles_is_zero_or_infinity) {
    EXPECT_EQ(d("1e400").toDouble(), std::numeric_limits<double>::infinity());
    EXPECT_EQ(d("-1e400").toDouble(), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(d("1e-400").toDouble(), 0);
}

TEST(DecimalTest, sums_and_differences_are_exact) {
    EXPECT_EQ(d("0.1") + d("0.2"), d("0.3"));
    EXPECT_EQ(d("999.9") + d("0.1"), d("1000"));
    EXPECT_EQ(d("1") - d("1e-30"), d("0.999999999999999999999999999999"));
    EXPECT_EQ(d("5") - d("7.5"), d("-2.5"));
    EXPECT_EQ(d("-5") + d("5"), d("0"));
    EXPECT_EQ((d("-5") + d("5")).toString(), "0");
    EXPECT_EQ(-d("0"), d("0"));
    EXPECT_EQ(-d("-1.5"), d("1.5"));
    EXPECT_EQ(d("-1.5") - d("-1.5"), Decimal());
}

TEST(DecimalTest, arithmetic_agrees_with_integers) {
    std::mt19937_64 random(2);
    std::uniform_int_distribution<std::int64_t> number(-4'000'000'000'000, 4'000'000'000'000);
    const auto text = [](std::int64_t n) { return std::to_string(n) + "e-6"; };
    for (int i = 0; i < 2000; ++i) {
        const std::int64_t a = number(random);
        const std::int64_t b = number(random);
        EXPECT_EQ(d(text(a)) + d(text(b)), d(text(a + b)));
        EXPECT_EQ(d(text(a)) - d(text(b)), d(text(a - b)));
    }
}

TEST(DecimalTest, ten_thousand_digits_are_kept) {
    const std::string digits = "0." + std::string(9999, '7') + "3";
    const Decimal moved = d(digits) + d("1");
    EXPECT_EQ(moved - d("1"), d(digits));
    EXPECT_NEAR(moved.toDouble(), 1.7777777777777777, 1e-15);
}

TEST(DecimalTest, rounding_is_half_away_from_zero) {
    EXPECT_EQ(d("1.25").rounded(1), d("1.3"));
    EXPECT_EQ(d("-1.25").rounded(1), d("-1.3"));
    EXPECT_EQ(d("1.2499").rounded(1), d("1.2"));
    EXPECT_EQ(d("0.5").rounded(0), d("1"));
    EXPECT_EQ(d("9.99").rounded(1), d("10"));
    EXPECT_EQ(d("149").rounded(-2), d("100"));
    EXPECT_EQ(d("150").rounded(-2), d("200"));
    EXPECT_EQ(d("50").rounded(-2), d("100"));
    EXPECT_EQ(d("49").rounded(-2), d("0"));
    EXPECT_EQ(d("4").rounded(-2), d("0"));
    EXPECT_EQ(d("1.5").rounded(100), d("1.5"));
    EXPECT_EQ(d("1.5").rounded(std::numeric_limits<int>::min()), d("0"));
    EXPECT_EQ(d("-0.04").rounded(1).toString(), "0");
}

} // namespace
} // namespace apeiron
