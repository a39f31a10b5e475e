#pragma once

#include <string>
#include <string_view>

namespace apeiron {

/// An exact decimal number of any length: for positions that must not lose digits at any zoom.
///
/// Kept in canonical text form (no exponent, no leading or trailing zeros, no "-0"), which is also how it is saved.
class Decimal {
  public:
    Decimal() = default;
    /// The shortest decimal that reads back as `value`. @pre value is finite.
    explicit Decimal(double value);

    /// Reads `-12.5`, `.5`, `1e-300`, `+3E4`. @throws Error (BadInput) for anything else, and for
    /// numbers of more than kMaxDigits digits once written out.
    static Decimal parse(std::string_view text);

    const std::string& toString() const { return text_; }
    /// The nearest double (0 or ±infinity outside its range).
    double toDouble() const;

    /// @throws Error (BadInput) when the exact sum has more than kMaxDigits digits; so does operator-.
    Decimal operator+(const Decimal& other) const;
    Decimal operator-(const Decimal& other) const;
    Decimal operator-() const;
    /// Rounded half away from zero to `places` digits after the point (negative: to tens, hundreds, ...).
    Decimal rounded(int places) const;
    bool operator==(const Decimal&) const = default;

    static constexpr int kMaxDigits = 100'000;

  private:
    std::string text_ = "0";
};

} // namespace apeiron
