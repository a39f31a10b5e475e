#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace apeiron::parameter {

/// One line of GLSL, with its comments told from its code.
struct GlslLine {
    std::string code;         ///< without comments, trimmed
    std::string_view comment; ///< what follows `//`; views the source
    bool hasComment = false;  ///< whether there is a `//`
    bool blank = false;       ///< nothing on the line at all, not even a comment
};

/// The lines of a source. Comments of `/* */`, over any number of lines, are dropped.
std::vector<GlslLine> splitGlslLines(std::string_view source);

} // namespace apeiron::parameter
