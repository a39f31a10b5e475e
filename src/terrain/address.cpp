#include "terrain/address.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace apeiron::terrain {
namespace {

[[noreturn]] void refuseDepth() {
    throw Error(ErrorKind::BadInput, fmt::format("an address has at most {} digits", Address::kMaxLevels), {},
                "give a shorter one");
}

bool isSpace(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

} // namespace

Address Address::parse(std::string_view text) {
    Address address;
    address.words_.reserve(std::min<std::size_t>(text.size(), static_cast<std::size_t>(kMaxLevels)) / 32 + 1);
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (isSpace(c)) continue;
        if (c < '0' || c > '3')
            throw Error(ErrorKind::BadInput, fmt::format("an address has digits from 0 to 3, but character {} is {}",
                                                         i + 1, inQuotes(text.substr(i, 1))));
        address.push(c - '0');
    }
    return address;
}

std::string Address::toString() const {
    std::string text(static_cast<std::size_t>(levels_), '0');
    for (std::int64_t i = 0; i < levels_; ++i)
        text[static_cast<std::size_t>(i)] = static_cast<char>('0' + digit(i));
    return text;
}

void Address::setDigit(std::int64_t level, int digit) {
    const auto at = static_cast<std::uint64_t>(level);
    const std::uint64_t shift = 2 * (at % 32);
    std::uint64_t& word = words_[static_cast<std::size_t>(at / 32)];
    word = (word & ~(std::uint64_t{3} << shift)) | (static_cast<std::uint64_t>(digit) << shift);
}

void Address::push(int digit) {
    assert(digit >= 0 && digit < 4);
    if (levels_ == kMaxLevels) refuseDepth();
    if (levels_ % 32 == 0) words_.push_back(0);
    ++levels_;
    setDigit(levels_ - 1, digit);
}

int Address::pop() {
    assert(levels_ > 0);
    const int last = digit(levels_ - 1);
    setDigit(levels_ - 1, 0);
    --levels_;
    if (levels_ % 32 == 0) words_.pop_back();
    return last;
}

Address Address::prefix(std::int64_t levels) const {
    assert(levels >= 0 && levels <= levels_);
    Address part;
    part.levels_ = levels;
    part.words_.assign(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>((levels + 31) / 32));
    if (levels % 32 != 0) part.words_.back() &= (std::uint64_t{1} << (2 * static_cast<std::uint64_t>(levels % 32))) - 1;
    return part;
}

std::int64_t Address::move(std::int64_t dx, std::int64_t dy) {
    // What is still to be added at a level, in its cells, on the way up.
    std::int64_t first = levels_;
    std::vector<int> digits; // the new ones, the deepest first
    while (first > 0 && (dx != 0 || dy != 0)) {
        const int old = digit(first - 1);
        const std::int64_t x = (old & 1) + dx;
        const std::int64_t y = (old >> 1) + dy;
        digits.push_back(static_cast<int>((x & 1) | ((y & 1) << 1)));
        dx = x >> 1;
        dy = y >> 1;
        --first;
    }
    if (dx != 0 || dy != 0) return -1;
    for (std::size_t i = 0; i < digits.size(); ++i)
        setDigit(levels_ - 1 - static_cast<std::int64_t>(i), digits[i]);
    return first;
}

} // namespace apeiron::terrain
