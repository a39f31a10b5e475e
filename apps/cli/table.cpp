#include "table.hpp"

#include <algorithm>

namespace apeiron::cli {
namespace {

/// Columns that UTF-8 text takes, one per character.
std::size_t columnsOf(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

} // namespace

std::string alignedTable(const std::vector<Row>& rows, std::size_t numbers) {
    std::vector<std::size_t> widths;
    for (const Row& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], columnsOf(row[i]));
    }
    std::string text;
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string space(widths[i] - columnsOf(row[i]), ' ');
            const bool last = i + 1 == row.size();
            text += i >= numbers ? space + row[i] : row[i] + (last ? "" : space);
            if (!last) text += "  ";
        }
        text += '\n';
    }
    return text;
}

std::string firstLine(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

} // namespace apeiron::cli
