#pragma once

#include <optional>
#include <string_view>
#include <vector>

// Small pieces of text handling that the parsers of this folder share.
namespace apeiron::parameter {

/// Without the white space at both ends.
std::string_view trimmed(std::string_view text);

/// The trimmed pieces between commas; a text of white space only has none.
std::vector<std::string_view> splitAtCommas(std::string_view text);

/// Whether JSON can hold the text as it is.
bool isUtf8(std::string_view text);

/// A finite decimal number such as `-1`, `.5` or `1e-6` (no hexadecimal, no inf, whatever the C locale).
std::optional<double> parseNumber(std::string_view text);

} // namespace apeiron::parameter
