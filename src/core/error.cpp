#include "core/error.hpp"

namespace apeiron {
namespace {

std::string compose(const std::string& what, const std::string& where, const std::string& hint) {
    std::string message = where.empty() ? what : where + ": " + what;
    if (!hint.empty()) message += "; " + hint;
    return message;
}

} // namespace

Error::Error(ErrorKind kind, const std::string& what, const std::string& where, const std::string& hint)
    : Error(kind, compose(what, where, hint), 0) {}

Error::Error(ErrorKind kind, const std::string& message, int /*tag: already composed*/)
    : std::runtime_error(message), kind_(kind) {}

Error Error::at(const std::string& where) const {
    return Error(kind_, compose(what(), where, {}), 0);
}

std::string inQuotes(std::string_view text) {
    constexpr std::size_t kLongest = 60;
    const bool isLong = text.size() > kLongest;
    if (isLong) {
        std::size_t end = kLongest - 3;
        // Never cut through a UTF-8 sequence: the message must stay printable.
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
            --end;
        text = text.substr(0, end);
    }
    std::string result = "\"";
    for (const char c : text)
        result += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
    return result + (isLong ? "...\"" : "\"");
}

} // namespace apeiron
