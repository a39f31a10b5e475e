#pragma once

#include <string>
#include <vector>

namespace apeiron::cli {

using Row = std::vector<std::string>;

/// Rows as aligned columns, two spaces apart; the last column is as long as it is.
/// @param numbers  columns from this one on are aligned to the right
std::string alignedTable(const std::vector<Row>& rows, std::size_t numbers = static_cast<std::size_t>(-1));

/// The text up to the end of its first line.
std::string firstLine(const std::string& text);

} // namespace apeiron::cli
