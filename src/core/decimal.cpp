#include "core/decimal.hpp"

#include "core/error.hpp"

#include <algorithm>
#include <cassert>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace apeiron {
namespace {

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

/// ±digits · 10^-places; the digits may have zeros in front.
struct Number {
    bool negative = false;
    std::string digits;
    std::size_t places = 0;
};

Number split(const std::string& canonical) {
    Number number;
    number.negative = canonical.front() == '-';
    number.digits = canonical.substr(number.negative ? 1 : 0);
    if (const std::size_t point = number.digits.find('.'); point != std::string::npos) {
        number.places = number.digits.size() - point - 1;
        number.digits.erase(point, 1);
    }
    return number;
}

std::string join(Number number) {
    std::string& digits = number.digits;
    if (digits.size() <= number.places) digits.insert(0, number.places + 1 - digits.size(), '0');
    std::string fraction = digits.substr(digits.size() - number.places);
    digits.erase(digits.size() - number.places);
    fraction.erase(fraction.find_last_not_of('0') + 1); // npos + 1 is 0: all of it
    digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));

    const std::size_t count = fraction.size() + (digits == "0" ? 0 : digits.size());
    if (count > static_cast<std::size_t>(Decimal::kMaxDigits))
        throw Error(ErrorKind::BadInput, fmt::format("a number of more than {} digits", Decimal::kMaxDigits));
    if (!fraction.empty()) digits += '.' + fraction;
    return number.negative && digits != "0" ? "-" + digits : digits;
}

/// Writes both with the same number of digits before and after the point.
void align(Number& a, Number& b) {
    const std::size_t places = std::max(a.places, b.places);
    for (Number* number : {&a, &b}) {
        number->digits.append(places - number->places, '0');
        number->places = places;
    }
    const std::size_t size = std::max(a.digits.size(), b.digits.size());
    for (Number* number : {&a, &b})
        number->digits.insert(0, size - number->digits.size(), '0');
}

std::string add(const std::string& a, const std::string& b) {
    std::string sum(a.size() + 1, '0');
    int carry = 0;
    for (std::size_t i = a.size(); i-- > 0;) {
        const int digit = (a[i] - '0') + (b[i] - '0') + carry;
        sum[i + 1] = static_cast<char>('0' + digit % 10);
        carry = digit / 10;
    }
    sum[0] = static_cast<char>('0' + carry);
    return sum;
}

/// @pre a >= b
std::string subtract(const std::string& a, const std::string& b) {
    std::string difference(a.size(), '0');
    int borrow = 0;
    for (std::size_t i = a.size(); i-- > 0;) {
        int digit = (a[i] - '0') - (b[i] - '0') - borrow;
        borrow = digit < 0 ? 1 : 0;
        digit += 10 * borrow;
        difference[i] = static_cast<char>('0' + digit);
    }
    return difference;
}

[[noreturn]] void failParse(std::string_view text) {
    throw Error(ErrorKind::BadInput, "expected a number, got " + inQuotes(text));
}

/// The exponent after 'e', held back to ±10^9, far outside what is accepted.
long long parseExponent(std::string_view text, std::string_view whole) {
    const bool negative = !text.empty() && text.front() == '-';
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
    if (text.empty() || !std::all_of(text.begin(), text.end(), isDigit)) failParse(whole);
    long long value = 0;
    for (const char c : text)
        value = std::min(value * 10 + (c - '0'), 1'000'000'000LL);
    return negative ? -value : value;
}

} // namespace

Decimal::Decimal(double value) {
    assert(std::isfinite(value));
    text_ = parse(fmt::format("{}", value)).text_; // fmt writes the shortest text that reads back as the same double
}

Decimal Decimal::parse(std::string_view text) {
    std::string_view rest = text;
    Number number;
    if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) {
        number.negative = rest.front() == '-';
        rest.remove_prefix(1);
    }
    const std::size_t e = rest.find_first_of("eE");
    std::string_view mantissa = rest.substr(0, e);
    long long exponent = e == std::string_view::npos ? 0 : parseExponent(rest.substr(e + 1), text);

    const std::size_t point = mantissa.find('.');
    number.digits = mantissa.substr(0, point);
    if (point != std::string_view::npos) {
        number.digits += mantissa.substr(point + 1);
        exponent -= static_cast<long long>(mantissa.size() - point - 1);
    }
    std::string& digits = number.digits;
    if (digits.empty() || !std::all_of(digits.begin(), digits.end(), isDigit)) failParse(text);

    // Zeros at both ends say nothing; without them the length can be judged before anything is written out.
    const std::size_t significant = digits.find_last_not_of('0') + 1;
    exponent += static_cast<long long>(digits.size() - significant);
    digits.erase(significant);
    digits.erase(0, digits.find_first_not_of('0'));
    if (digits.empty()) return {};
    const auto size = static_cast<long long>(digits.size());
    if (std::max({size, size + exponent, -exponent}) > kMaxDigits)
        throw Error(ErrorKind::BadInput, fmt::format("{} has more than {} digits", inQuotes(text), kMaxDigits));

    if (exponent > 0) digits.append(static_cast<std::size_t>(exponent), '0');
    if (exponent < 0) number.places = static_cast<std::size_t>(-exponent);
    Decimal result;
    result.text_ = join(std::move(number));
    return result;
}

double Decimal::toDouble() const {
    // strtod() reads the decimal point of the current C locale, which a toolkit may have changed.
    const char point = *std::localeconv()->decimal_point;
    if (point == '.') return std::strtod(text_.c_str(), nullptr);
    std::string localized = text_;
    std::replace(localized.begin(), localized.end(), '.', point);
    return std::strtod(localized.c_str(), nullptr);
}

Decimal Decimal::operator+(const Decimal& other) const {
    Number a = split(text_);
    Number b = split(other.text_);
    align(a, b);
    Number sum;
    sum.places = a.places;
    if (a.negative == b.negative) {
        sum.negative = a.negative;
        sum.digits = add(a.digits, b.digits);
    } else {
        const bool aIsLarger = a.digits >= b.digits; // of the same length: lexical order is numeric order
        sum.negative = aIsLarger ? a.negative : b.negative;
        sum.digits = aIsLarger ? subtract(a.digits, b.digits) : subtract(b.digits, a.digits);
    }
    Decimal result;
    result.text_ = join(std::move(sum));
    return result;
}

Decimal Decimal::operator-(const Decimal& other) const {
    return *this + -other;
}

Decimal Decimal::operator-() const {
    Decimal result = *this;
    if (text_.front() == '-')
        result.text_.erase(0, 1);
    else if (text_ != "0")
        result.text_.insert(0, 1, '-');
    return result;
}

Decimal Decimal::rounded(int places) const {
    Number number = split(text_);
    const long long cut = static_cast<long long>(number.places) - places;
    if (cut <= 0) return *this;
    if (cut > static_cast<long long>(number.digits.size())) return {};

    const std::size_t kept = number.digits.size() - static_cast<std::size_t>(cut);
    const bool up = number.digits[kept] >= '5';
    number.digits.erase(kept);
    if (up) {
        const std::string zeros(kept, '0');
        number.digits = kept == 0 ? "1" : add(number.digits, zeros.substr(1) + "1");
    }
    if (places < 0) number.digits.append(static_cast<std::size_t>(-static_cast<long long>(places)), '0');
    number.places = places < 0 ? 0 : static_cast<std::size_t>(places);
    Decimal result;
    result.text_ = join(std::move(number));
    return result;
}

} // namespace apeiron
