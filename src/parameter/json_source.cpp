#include "parameter/json_source.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

namespace apeiron::parameter {
namespace {

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

bool isWordCharacter(char c) {
    return isDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' || c == '+' ||
           c == '.';
}

/// A recursive-descent reader that notes the line of every value. nlohmann::json decodes single strings and
/// numbers only: it tells neither where values stand nor that a key is given twice.
class Reader {
  public:
    Reader(const std::string& file, std::string_view text, std::map<std::string, int>& lines)
        : file_(file), text_(text), lines_(lines) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (text_.starts_with(kByteOrderMark)) position_ = lineStart_ = kByteOrderMark.size();
    }

    Json read() {
        skipSpace();
        if (atEnd()) fail("the document is empty");
        Json root = readValue("", 0);
        skipSpace();
        if (!atEnd()) fail("unexpected " + found() + " after the end of the document");
        return root;
    }

  private:
    bool atEnd() const { return position_ >= text_.size(); }
    char peek() const { return atEnd() ? '\0' : text_[position_]; }

    [[noreturn]] void fail(const std::string& reason) const {
        int column = 1;
        for (std::size_t i = lineStart_; i < position_; ++i) // characters, not bytes
            if ((static_cast<unsigned char>(text_[i]) & 0xC0U) != 0x80U) ++column;
        throw Error(ErrorKind::BadInput, reason, fmt::format("{}:{}:{}", file_, line_, column));
    }

    /// What stands here, for messages.
    std::string found() const {
        if (atEnd()) return "end of file";
        std::size_t end = position_;
        while (end < text_.size() && isWordCharacter(text_[end]))
            ++end;
        if (end > position_) return inQuotes(text_.substr(position_, end - position_));
        const auto code = static_cast<unsigned char>(text_[position_]);
        if (code < 0x20 || code >= 0x7F) return fmt::format("character 0x{:02x}", code);
        return fmt::format("'{}'", text_[position_]);
    }

    void advance() {
        if (text_[position_++] != '\n') return;
        ++line_;
        lineStart_ = position_;
    }

    void skipSpace() {
        while (!atEnd()) {
            const std::string_view rest = text_.substr(position_);
            if (rest.front() == ' ' || rest.front() == '\t' || rest.front() == '\r' || rest.front() == '\n') {
                advance();
            } else if (rest.starts_with("//")) {
                while (!atEnd() && peek() != '\n')
                    advance();
            } else if (rest.starts_with("/*")) {
                const std::size_t end = text_.find("*/", position_ + 2);
                if (end == std::string_view::npos) fail("this comment has no end");
                while (position_ < end + 2)
                    advance();
            } else {
                return;
            }
        }
    }

    Json readValue(const std::string& pointer, int depth) {
        if (depth > JsonSource::kMaxDepth) fail(fmt::format("nested deeper than {} levels", JsonSource::kMaxDepth));
        lines_[pointer] = line_;
        switch (peek()) {
        case '{':
            return readObject(pointer, depth);
        case '[':
            return readArray(pointer, depth);
        case '"':
            return readString();
        default:
            return readWord();
        }
    }

    Json readObject(const std::string& pointer, int depth) {
        Json object = Json::object();
        advance();
        skipSpace();
        if (peek() == '}') return advance(), object;
        while (true) {
            if (peek() == '}') fail("a ',' too many before '}'");
            if (peek() != '"') fail("expected a key in double quotes, got " + found());
            const std::size_t keyPosition = position_;
            const std::string key = readString().get<std::string>();
            const std::string member = JsonSource::child(pointer, key);
            if (const auto first = lines_.find(member); first != lines_.end()) {
                position_ = keyPosition;
                fail(fmt::format("the key {} is given twice; first in line {}", inQuotes(key), first->second));
            }
            skipSpace();
            if (peek() != ':') fail("expected ':' after the key, got " + found());
            advance();
            skipSpace();
            object[key] = readValue(member, depth + 1);
            skipSpace();
            if (peek() == '}') return advance(), object;
            if (peek() != ',') fail("expected ',' or '}', got " + found());
            advance();
            skipSpace();
        }
    }

    Json readArray(const std::string& pointer, int depth) {
        Json array = Json::array();
        advance();
        skipSpace();
        if (peek() == ']') return advance(), array;
        while (true) {
            if (peek() == ']') fail("a ',' too many before ']'");
            array.push_back(readValue(JsonSource::child(pointer, std::to_string(array.size())), depth + 1));
            skipSpace();
            if (peek() == ']') return advance(), array;
            if (peek() != ',') fail("expected ',' or ']', got " + found());
            advance();
            skipSpace();
        }
    }

    Json readString() {
        const std::size_t begin = position_;
        for (std::size_t i = begin + 1; i < text_.size(); ++i) {
            const char c = text_[i];
            if (c == '\n') break;
            if (static_cast<unsigned char>(c) < 0x20) {
                position_ = i;
                fail("a control character in a string; write it as an escape such as \\t");
            }
            if (c == '\\') {
                ++i; // whatever is escaped, it does not end the string; an escaped line break is found broken below
            } else if (c == '"') {
                return decode(i + 1, "a string with a bad escape or bad UTF-8");
            }
        }
        fail("this string has no end");
    }

    Json readWord() {
        std::size_t end = position_;
        while (end < text_.size() && isWordCharacter(text_[end]))
            ++end;
        const std::string_view word = text_.substr(position_, end - position_);
        if (word == "true" || word == "false" || word == "null") return decode(end, "");
        if (word.empty() || (!isDigit(word.front()) && word.front() != '-'))
            fail("expected a value, got " + found() + (word.empty() ? "" : "; texts need double quotes"));
        Json number = decode(end, isNumber(word) ? "this number is too large" : "bad number " + found());
        return number;
    }

    /// -?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?
    static bool isNumber(std::string_view word) {
        std::size_t i = 0;
        const auto digits = [&] {
            const std::size_t begin = i;
            while (i < word.size() && isDigit(word[i]))
                ++i;
            return i - begin;
        };
        if (i < word.size() && word[i] == '-') ++i;
        const std::size_t first = i;
        const std::size_t count = digits();
        if (count == 0 || (count > 1 && word[first] == '0')) return false;
        if (i < word.size() && word[i] == '.') {
            ++i;
            if (digits() == 0) return false;
        }
        if (i < word.size() && (word[i] == 'e' || word[i] == 'E')) {
            ++i;
            if (i < word.size() && (word[i] == '+' || word[i] == '-')) ++i;
            if (digits() == 0) return false;
        }
        return i == word.size();
    }

    /// The string, number or literal between here and `end`.
    Json decode(std::size_t end, const std::string& whyNot) {
        const std::string_view token = text_.substr(position_, end - position_);
        Json value = Json::parse(token.begin(), token.end(), nullptr, false);
        if (value.is_discarded()) fail(whyNot);
        position_ = end; // no token has a line break in it
        return value;
    }

    const std::string& file_;
    std::string_view text_;
    std::map<std::string, int>& lines_;
    std::size_t position_ = 0;
    std::size_t lineStart_ = 0;
    int line_ = 1;
};

} // namespace

JsonSource JsonSource::parse(std::string file, const std::string& text) {
    JsonSource source;
    source.file_ = std::move(file);
    source.root_ = Reader(source.file_, text, source.lines_).read();
    return source;
}

std::string JsonSource::where(const std::string& pointer) const {
    std::string known = pointer;
    auto line = lines_.find(known);
    while (line == lines_.end() && !known.empty()) {
        known.erase(std::min(known.rfind('/'), known.size()));
        line = lines_.find(known);
    }
    const std::string place = fmt::format("{}:{}", file_, line == lines_.end() ? 1 : line->second);
    return known.empty() ? place : fmt::format("{} ({})", place, known);
}

std::string JsonSource::child(const std::string& pointer, const std::string& key) {
    std::string result = pointer + '/';
    for (const char c : key) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else
            result += c;
    }
    return result;
}

} // namespace apeiron::parameter
