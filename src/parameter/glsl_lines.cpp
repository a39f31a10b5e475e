#include "parameter/glsl_lines.hpp"

#include "parameter/text.hpp"

namespace apeiron::parameter {
namespace {

/// @param inBlock whether a block comment is open, before and after the line
GlslLine readLine(std::string_view text, bool& inBlock) {
    GlslLine line;
    line.blank = trimmed(text).empty() && !inBlock;
    for (std::size_t i = 0; i < text.size();) {
        const std::string_view rest = text.substr(i);
        if (inBlock) {
            const std::size_t end = rest.find("*/");
            if (end == std::string_view::npos) break;
            inBlock = false;
            line.code += ' '; // a comment separates words
            i += end + 2;
        } else if (rest.starts_with("//")) {
            line.hasComment = true;
            line.comment = rest.substr(2);
            break;
        } else if (rest.starts_with("/*")) {
            inBlock = true;
            i += 2;
        } else {
            line.code += text[i++];
        }
    }
    line.code = trimmed(line.code);
    return line;
}

} // namespace

std::vector<GlslLine> splitGlslLines(std::string_view source) {
    std::vector<GlslLine> lines;
    bool inBlock = false;
    while (!source.empty()) {
        const std::size_t end = source.find('\n');
        std::string_view text = source.substr(0, end);
        if (text.ends_with('\r')) text.remove_suffix(1);
        lines.push_back(readLine(text, inBlock));
        source.remove_prefix(end == std::string_view::npos ? source.size() : end + 1);
    }
    return lines;
}

} // namespace apeiron::parameter
