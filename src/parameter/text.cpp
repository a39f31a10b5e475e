#include "parameter/text.hpp"

#include "core/decimal.hpp"
#include "core/error.hpp"
#include "core/json.hpp"

#include <cmath>

namespace apeiron::parameter {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n\f\v";
    const std::size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::vector<std::string_view> splitAtCommas(std::string_view text) {
    std::vector<std::string_view> pieces;
    if (trimmed(text).empty()) return pieces;
    while (true) {
        const std::size_t comma = text.find(',');
        pieces.push_back(trimmed(text.substr(0, comma)));
        if (comma == std::string_view::npos) return pieces;
        text.remove_prefix(comma + 1);
    }
}

bool isUtf8(std::string_view text) {
    try {
        Json(text).dump(); // the very judge who will refuse when the document is saved
        return true;
    } catch (const Json::type_error&) {
        return false;
    }
}

std::optional<double> parseNumber(std::string_view text) {
    try {
        const double value = Decimal::parse(text).toDouble();
        return std::isfinite(value) ? std::optional(value) : std::nullopt;
    } catch (const Error&) {
        return std::nullopt;
    }
}

} // namespace apeiron::parameter
