#include "terrain/place.hpp"

#include "terrain/height_detail.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace apeiron::terrain {
namespace {

/// x [1] in units of 2^-bits, rounded, modulo 2^64. @pre |x| < 2^(63 - bits)
std::uint64_t fixedPoint(double x, int bits) {
    return static_cast<std::uint64_t>(std::llround(std::ldexp(x, bits)));
}

/// Splits into whole cells and the rest in 2^-64 cells, without loss: `x` has at most 53 bits.
std::pair<std::int64_t, std::uint64_t> wholeAndFraction(double x) {
    const double whole = std::floor(x);
    const double high = std::floor(std::ldexp(x - whole, 32));
    const double low = std::floor(std::ldexp(std::ldexp(x - whole, 32) - high, 32));
    // x - whole may round up to 1.
    const std::uint64_t carry = high >= 4294967296.0 ? 1 : 0;
    const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32U) + static_cast<std::uint64_t>(low);
    return {static_cast<std::int64_t>(whole) + static_cast<std::int64_t>(carry), bits};
}

} // namespace

Cell Block::cell(int dx, int dy) const {
    assert(dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1);
    Cell cell{level, x + static_cast<std::uint32_t>(dx), y + static_cast<std::uint32_t>(dy), {}};
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i)
            cell.window[4 * j + i] =
                heights[6 * (j + static_cast<std::size_t>(dy + 1)) + i + static_cast<std::size_t>(dx + 1)];
    }
    return cell;
}

Block rootBlock(const Shape& shape) {
    Block block;
    detail::rootHeights(shape, 0U - 2U, 0U - 2U, 6, block.heights.data());
    return block;
}

Block childBlock(const Shape& shape, const Block& block, int digit) {
    const int bx = digit & 1;
    const int by = digit >> 1;
    const detail::Octave octave = detail::octave(shape, block.level + 1);
    std::array<std::uint32_t, 36> parents{};
    std::array<std::uint32_t, 36> children{};
    for (std::size_t i = 0; i < 36; ++i)
        parents[i] = static_cast<std::uint32_t>(block.heights[i]);
    detail::subdivide(octave, shape.kernel, parents.data(), 6, block.x - 2U, block.y - 2U, 2 + bx, 2 + by, 6,
                      children.data());
    Block child{block.level + 1,
                2U * block.x + static_cast<std::uint32_t>(bx),
                2U * block.y + static_cast<std::uint32_t>(by),
                {}};
    for (std::size_t i = 0; i < 36; ++i)
        child.heights[i] = static_cast<std::int32_t>(children[i]);
    return child;
}

Place::Place(const Shape& shape, Address address) : shape_(shape), address_(std::move(address)) {
    pushBlock(rootBlock(shape_));
    rebuild(0);
    height_ = detail::ringHeight(block().cell().window[5]);
}

void Place::pushBlock(const Block& block) {
    if (block.level % kCheckpoint == 0) {
        checkpoints_.resize(static_cast<std::size_t>(block.level / kCheckpoint));
        checkpoints_.push_back(block);
    }
    live_.push_back(block);
    // Twice the segment between checkpoints: re-rooting to and fro does not rebuild each time.
    while (static_cast<std::int64_t>(live_.size()) > 2 * kCheckpoint + kLiveLevels)
        live_.pop_front();
}

void Place::rebuild(std::int64_t level) {
    if (level < live_.front().level) {
        const Block block = ancestor(level);
        live_.clear();
        live_.push_back(block);
    }
    while (live_.back().level > level)
        live_.pop_back();
    checkpoints_.resize(static_cast<std::size_t>(level / kCheckpoint) + 1);
    for (std::int64_t n = level; n < address_.levels(); ++n)
        pushBlock(childBlock(shape_, live_.back(), address_.digit(n)));
    keepLive();
}

void Place::keepLive() {
    const std::int64_t first = live_.front().level;
    if (first == 0 || level() - first >= kLiveLevels) return;
    // The segment before: from the checkpoint above to the first live level.
    const std::int64_t from = (first - 1) / kCheckpoint * kCheckpoint;
    std::vector<Block> segment{checkpoints_[static_cast<std::size_t>(from / kCheckpoint)]};
    for (std::int64_t n = from; n + 1 < first; ++n)
        segment.push_back(childBlock(shape_, segment.back(), address_.digit(n)));
    live_.insert(live_.begin(), segment.begin(), segment.end());
    keepLive();
}

const Block& Place::block(std::int64_t level) const {
    assert(level >= live_.front().level && level <= live_.back().level);
    return live_[static_cast<std::size_t>(level - live_.front().level)];
}

Block Place::ancestor(std::int64_t level) const {
    assert(level >= 0 && level <= this->level());
    if (!live_.empty() && level >= live_.front().level && level <= live_.back().level) return block(level);
    Block block = checkpoints_[static_cast<std::size_t>(level / kCheckpoint)];
    while (block.level < level)
        block = childBlock(shape_, block, address_.digit(block.level));
    return block;
}

Cell Place::cellNear(std::int64_t level, std::int64_t dx, std::int64_t dy) const {
    // Coordinates modulo 2^32 as numbers: what is above them is the same on the whole way.
    const std::int64_t below = std::max<std::int64_t>(level - this->level(), 0);
    const auto here = [&](std::uint64_t fraction, std::uint32_t x) {
        const auto bits = static_cast<std::int64_t>(below == 0 ? 0 : fraction >> static_cast<unsigned>(64 - below));
        return (static_cast<std::int64_t>(x) << static_cast<unsigned>(below)) + bits;
    };
    const Block& start = block(std::min(level, this->level()));
    const std::int64_t hereX = here(x_, start.x);
    const std::int64_t hereY = here(y_, start.y);
    const std::int64_t x = hereX + dx;
    const std::int64_t y = hereY + dy;
    std::int64_t up = below;
    const auto beside = [&](std::int64_t a, std::int64_t b) {
        return (a >> static_cast<unsigned>(up)) - (b >> static_cast<unsigned>(up));
    };
    const auto isNear = [](std::int64_t offset) { return offset >= -1 && offset <= 1; };
    const std::int64_t most = level - live_.front().level;
    while (up < most && !(isNear(beside(x, hereX)) && isNear(beside(y, hereY))))
        ++up;
    const auto clamped = [](std::int64_t offset) {
        return static_cast<int>(std::min<std::int64_t>(std::max<std::int64_t>(offset, -1), 1));
    };
    Cell cell = block(level - up).cell(clamped(beside(x, hereX)), clamped(beside(y, hereY)));
    while (up > 0) {
        --up;
        cell = childCell(
            shape_, cell,
            static_cast<int>(((x >> static_cast<unsigned>(up)) & 1) | (((y >> static_cast<unsigned>(up)) & 1) << 1)));
    }
    return cell;
}

Cell Place::cellNamed(const CellKey& key) const {
    // Up to where it is at most a neighbour of the point's cell.
    auto up = static_cast<unsigned>(std::max<std::int64_t>(key.level - level(), 0));
    std::int32_t dx = 0;
    std::int32_t dy = 0;
    for (;; ++up) {
        const Block& here = block(key.level - static_cast<std::int64_t>(up));
        dx = static_cast<std::int32_t>(key.x - (here.x << up)) >> up;
        dy = static_cast<std::int32_t>(key.y - (here.y << up)) >> up;
        if (here.level == 0 || (std::abs(dx) <= 1 && std::abs(dy) <= 1)) break;
    }
    const Block& near = block(key.level - static_cast<std::int64_t>(up));
    Cell cell = std::abs(dx) <= 1 && std::abs(dy) <= 1
                    ? near.cell(dx, dy)
                    : rootCell(shape_, static_cast<std::uint32_t>(dx), static_cast<std::uint32_t>(dy));
    while (up > 0) {
        --up;
        cell = childCell(shape_, cell, static_cast<int>((key.x >> up & 1U) | ((key.y >> up & 1U) << 1U)));
    }
    return cell;
}

std::uint64_t Place::heightAt(std::int64_t level) const {
    std::uint64_t height = height_;
    for (std::int64_t n = this->level(); n < level; ++n)
        height <<= static_cast<unsigned>(heightStep(shape_, n + 1));
    for (std::int64_t n = this->level(); n > level; --n)
        height = detail::parentHeight(height, block(n - 1).heights[14], heightStep(shape_, n));
    return height;
}

glm::dvec3 Place::position() const {
    const auto above = static_cast<std::int64_t>(height_ - detail::ringHeight(block().heights[14]));
    return {std::ldexp(static_cast<double>(x_ >> 11U), -53), std::ldexp(static_cast<double>(y_ >> 11U), -53),
            std::ldexp(static_cast<double>(above), -32 - kFractionBits)};
}

void Place::setPosition(const glm::dvec3& position) {
    x_ = wholeAndFraction(position.x).second;
    y_ = wholeAndFraction(position.y).second;
    height_ = detail::ringHeight(block().heights[14]) + fixedPoint(position.z, 32 + kFractionBits);
}

bool Place::move(const glm::dvec3& offset) {
    auto [dx, fx] = wholeAndFraction(offset.x);
    auto [dy, fy] = wholeAndFraction(offset.y);
    const std::uint64_t x = x_ + fx;
    const std::uint64_t y = y_ + fy;
    dx += x < x_ ? 1 : 0;
    dy += y < y_ ? 1 : 0;
    if (dx != 0 || dy != 0) {
        const std::int64_t same = address_.move(dx, dy);
        if (same < 0) return false;
        rebuild(same);
    }
    x_ = x;
    y_ = y;
    height_ += fixedPoint(offset.z, 32 + kFractionBits);
    return true;
}

std::pair<std::uint32_t, double> Place::along(int axis, std::int64_t level) const {
    std::uint64_t fraction = axis == 0 ? x_ : y_;
    std::uint32_t cell = axis == 0 ? block().x : block().y;
    const std::int64_t down = level - this->level();
    if (down > 0) {
        cell = (cell << static_cast<unsigned>(std::min<std::int64_t>(down, 31)) << (down > 31 ? down - 31 : 0)) |
               static_cast<std::uint32_t>(fraction >> static_cast<unsigned>(64 - down));
        fraction <<= static_cast<unsigned>(down);
        return {cell, std::ldexp(static_cast<double>(fraction >> 11U), -53)};
    }
    const Block& ancestor = block(level);
    const std::uint32_t above = axis == 0 ? ancestor.x : ancestor.y;
    // Which part of the ancestor the cell is in: at most kLiveLevels bits.
    const auto inside = static_cast<double>(cell - (above << static_cast<unsigned>(-down)));
    return {above, std::ldexp(inside + std::ldexp(static_cast<double>(fraction >> 11U), -53), static_cast<int>(down))};
}

glm::dvec3 Place::toCell(const Cell& cell) const {
    const auto [x, fractionX] = along(0, cell.level);
    const auto [y, fractionY] = along(1, cell.level);
    const double edge = std::ldexp(1.0, static_cast<int>(level() - cell.level));
    const auto corner = [&](std::size_t i) { return heightDifference(cell.window[i], cell.window[5]); };
    const double mean = 0.25 * (static_cast<double>(corner(6)) + corner(9) + corner(10));
    const auto above = static_cast<std::int64_t>(detail::ringHeight(cell.window[5]) - heightAt(cell.level));
    const auto exponent = static_cast<int>(heightExponent(shape_, level()) - heightExponent(shape_, cell.level));
    return {(static_cast<double>(static_cast<std::int32_t>(cell.x - x)) + 0.5 - fractionX) * edge,
            (static_cast<double>(static_cast<std::int32_t>(cell.y - y)) + 0.5 - fractionY) * edge,
            std::ldexp(std::ldexp(static_cast<double>(above), -32) + mean, exponent - kFractionBits)};
}

glm::dvec3 Place::to(const Place& other) const {
    assert(other.level() == level());
    const auto difference = [](std::uint32_t cell, std::uint32_t otherCell, std::uint64_t at, std::uint64_t otherAt) {
        const auto cells = static_cast<double>(static_cast<std::int32_t>(otherCell - cell));
        return cells + (std::ldexp(static_cast<double>(otherAt), -64) - std::ldexp(static_cast<double>(at), -64));
    };
    return {difference(block().x, other.block().x, x_, other.x_), difference(block().y, other.block().y, y_, other.y_),
            std::ldexp(static_cast<double>(static_cast<std::int64_t>(other.height_ - height_)), -32 - kFractionBits)};
}

void Place::moveTo(const Place& other) {
    assert(other.level() == level());
    const std::int64_t same = address_.move(static_cast<std::int32_t>(other.block().x - block().x),
                                            static_cast<std::int32_t>(other.block().y - block().y));
    if (same >= 0 && same < level()) rebuild(same);
    x_ = other.x_;
    y_ = other.y_;
    height_ = other.height_;
}

void Place::descend() {
    const int digit = static_cast<int>((x_ >> 63U) | ((y_ >> 63U) << 1U));
    address_.push(digit);
    pushBlock(childBlock(shape_, live_.back(), digit));
    x_ <<= 1U;
    y_ <<= 1U;
    height_ <<= static_cast<unsigned>(heightStep(shape_, level()));
}

void Place::ascend() {
    assert(level() > 0);
    height_ = heightAt(level() - 1);
    const int digit = address_.pop();
    live_.pop_back();
    checkpoints_.resize(static_cast<std::size_t>(level() / kCheckpoint) + 1);
    x_ = (x_ >> 1U) | (static_cast<std::uint64_t>(digit & 1) << 63U);
    y_ = (y_ >> 1U) | (static_cast<std::uint64_t>(digit >> 1) << 63U);
    keepLive();
}

bool Place::operator==(const Place& other) const {
    return shape_ == other.shape_ && address_ == other.address_ && x_ == other.x_ && y_ == other.y_ &&
           height_ == other.height_ && block() == other.block() && checkpoints_ == other.checkpoints_;
}

double slopeOf(const Cell& cell) {
    const auto corner = [&](std::size_t i) {
        return static_cast<double>(heightDifference(cell.window[i], cell.window[5]));
    };
    const double gx = 0.5 * (corner(6) + corner(10) - corner(9));
    const double gy = 0.5 * (corner(9) + corner(10) - corner(6));
    return std::ldexp(std::hypot(gx, gy), -kFractionBits);
}

int flattestChild(const Shape& shape, const Cell& cell) {
    int best = 0;
    double least = 0.0;
    for (int digit = 0; digit < 4; ++digit) {
        const double slope = slopeOf(childCell(shape, cell, digit));
        if (digit != 0 && slope >= least) continue;
        best = digit;
        least = slope;
    }
    return best;
}

std::optional<glm::dvec3> offsetBetween(Place from, const Place& to) {
    constexpr std::int64_t kMostLevels = 8;
    if (from.shape() != to.shape() || std::abs(from.level() - to.level()) > kMostLevels) return std::nullopt;
    while (from.level() < to.level())
        from.descend();
    while (from.level() > to.level())
        from.ascend();
    return from.to(to);
}

Address flatSeekingAddress(const Shape& shape, Address start, std::int64_t levels) {
    Address address = std::move(start);
    Cell cell = rootCell(shape);
    for (std::int64_t n = 0; n < address.levels(); ++n)
        cell = childCell(shape, cell, address.digit(n));
    while (address.levels() < levels) {
        const int digit = flattestChild(shape, cell);
        address.push(digit);
        cell = childCell(shape, cell, digit);
    }
    return address;
}

double verticalScale(const Shape& shape, std::int64_t level, double zoom) {
    // Halvings so far, and what they should have been: level a - floor(level a) is exact in integers.
    const std::int64_t thousandths = level * (1000 - shape.hurst) % 1000;
    const double rest = (zoom - static_cast<double>(level)) * (1000 - shape.hurst);
    return std::exp2(-(static_cast<double>(thousandths) + rest) / 1000.0);
}

} // namespace apeiron::terrain
