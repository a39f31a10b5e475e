#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace apeiron::terrain {

/// The path from root cell (0, 0) of level 0 to a cell: one digit from 0 to 3 a level, as childCell() takes them. Two
/// bits a level. Bit n of x and y, together, say which child of level n's cell it is.
class Address {
  public:
    /// Most levels of an address: 2^20, a scale of 10^-315,652. Half a megabyte; what is deeper than that is refused.
    static constexpr std::int64_t kMaxLevels = std::int64_t{1} << 20U;

    /// The root cell.
    Address() = default;

    /// Reads digits 0 to 3; white space between them is ignored. @throws Error (BadInput) that names the first wrong
    /// character and its position, and for more than kMaxLevels levels.
    static Address parse(std::string_view text);

    /// All digits, one a level.
    std::string toString() const;

    std::int64_t levels() const { return levels_; }
    /// The child that the path takes at a level. @pre 0 <= level < levels()
    int digit(std::int64_t level) const {
        const auto at = static_cast<std::uint64_t>(level);
        return static_cast<int>((words_[static_cast<std::size_t>(at / 32)] >> (2 * (at % 32))) & 3U);
    }
    /// Goes to a child. @throws Error (BadInput) at kMaxLevels.
    void push(int digit);
    /// Goes to the parent. @returns the digit that led here. @pre levels() > 0
    int pop();
    /// The path's first `levels` levels. @pre 0 <= levels <= levels()
    Address prefix(std::int64_t levels) const;

    /// Goes to the cell that lies (dx, dy) cells of the same level away, by carry from digit to digit.
    /// @returns the level down to which the path is as before, levels() when nothing changed; -1, and nothing changes,
    /// when the way leads out of the root cell. @pre |dx|, |dy| < 2^62
    std::int64_t move(std::int64_t dx, std::int64_t dy);

    bool operator==(const Address&) const = default;

  private:
    void setDigit(std::int64_t level, int digit);

    std::vector<std::uint64_t> words_; ///< 32 digits each, the first in the lowest bits; unused bits are 0
    std::int64_t levels_ = 0;
};

} // namespace apeiron::terrain
