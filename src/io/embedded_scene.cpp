#include "io/embedded_scene.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

namespace apeiron::io {
namespace {

/// Opens every comment of ours; the pieces follow each other in the file.
constexpr std::string_view kCommentPrefix = "apeiron:scene ";
constexpr std::size_t kMostSegment = 65533; // payload of a JPEG segment
constexpr unsigned char kComment = 0xFE;

/// One marker segment of a JPEG file: its place, and where its payload stands.
struct Segment {
    unsigned char marker = 0;
    std::size_t begin = 0;
    std::size_t payload = 0;
    std::size_t end = 0;
};

unsigned char byteAt(std::string_view bytes, std::size_t at) {
    return static_cast<unsigned char>(bytes[at]);
}

/// The segments before the picture itself (ITU-T T.81, annex B); stops at the first thing that is none.
std::vector<Segment> jpegSegments(std::string_view bytes) {
    std::vector<Segment> segments;
    std::size_t at = 2; // after the start-of-image marker
    while (at + 4 <= bytes.size() && byteAt(bytes, at) == 0xFF) {
        const unsigned char marker = byteAt(bytes, at + 1);
        constexpr unsigned char kStartOfScan = 0xDA;
        if (marker < 0xC0 || marker == kStartOfScan) break;
        const std::size_t length = std::size_t{byteAt(bytes, at + 2)} * 256 + byteAt(bytes, at + 3);
        if (length < 2 || at + 2 + length > bytes.size()) break;
        segments.push_back({marker, at, at + 4, at + 2 + length});
        at += 2 + length;
    }
    return segments;
}

std::string commentSegments(std::string_view text) {
    std::string result;
    const std::size_t most = kMostSegment - kCommentPrefix.size();
    for (std::size_t at = 0; at < text.size(); at += most) {
        const std::string_view piece = text.substr(at, most);
        const std::size_t length = 2 + kCommentPrefix.size() + piece.size();
        for (const std::size_t byte : {std::size_t{0xFF}, std::size_t{kComment}, length / 256, length % 256})
            result += static_cast<char>(byte);
        result += kCommentPrefix;
        result += piece;
    }
    return result;
}

} // namespace

std::string embeddedText(const Json& scene) {
    // Titles come from command lines and may be no valid UTF-8: replace, never refuse to save a finished picture.
    std::string text = scene.dump(-1, ' ', true, Json::error_handler_t::replace);
    constexpr std::size_t kMost = 4'000'000; // libpng reads texts of up to 8 MB
    if (text.size() > kMost) {
        throw Error(ErrorKind::BadInput,
                    fmt::format("the scene is too large to be saved with the picture: {} bytes", text.size()), {},
                    "shorten the GLSL source that it carries");
    }
    return text;
}

Header makeHeader(int width, int height, std::vector<std::string> channels, const Json& scene) {
    Header header{width, height, std::move(channels), {}};
    header.texts["Software"] = "Apeiron " APEIRON_VERSION;
    header.texts[kSceneKey] = embeddedText(scene);
    return header;
}

void insertJpegComment(std::string& bytes, const std::string& text) {
    std::size_t place = 2;
    // Behind the application segments: JFIF wants to be the first.
    for (const Segment& segment : jpegSegments(bytes))
        if (segment.marker >= 0xE0 && segment.marker <= 0xEF) place = segment.end;
    bytes.insert(place, commentSegments(text));
}

std::string jpegComment(std::string_view bytes) {
    std::string text;
    for (const Segment& segment : jpegSegments(bytes)) {
        const std::string_view payload = bytes.substr(segment.payload, segment.end - segment.payload);
        if (segment.marker == kComment && payload.starts_with(kCommentPrefix))
            text += payload.substr(kCommentPrefix.size());
    }
    return text;
}

} // namespace apeiron::io
