#include "io/codec.hpp"

#include "core/error.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <system_error>

namespace apeiron::io {
namespace {

// The only file that knows OpenImageIO. Readers and writers are asked for by format and never found by trial: that
// would offer every broken file to dozens of decoders.

constexpr int kMaxSide = 32768;
constexpr std::size_t kMaxChannels = 64;

const char* pluginName(ImageFormat format) {
    switch (format) {
    case ImageFormat::Png:
        return "png";
    case ImageFormat::Jpeg:
        return "jpeg";
    case ImageFormat::Exr:
        return "openexr";
    }
    return "";
}

/// The library's words as a phrase: in one line, without the file's name, which the caller puts in front.
std::string phrase(std::string words, const std::string& file) {
    for (const std::string& name : {"\"" + file + "\"", "'" + file + "'", file}) {
        if (file.empty()) break;
        for (std::size_t at = words.find(name); at != std::string::npos; at = words.find(name, at))
            words.replace(at, name.size(), "the file");
    }
    for (char& c : words)
        if (c == '\n' || c == '\r' || c == '\t') c = ' ';
    while (!words.empty() && (words.back() == ' ' || words.back() == '.'))
        words.pop_back();
    return words.empty() ? "no reason given" : words;
}

/// Asks for the pending error also where it is not shown: the library prints those that nobody fetched.
template <class Plugin> [[noreturn]] void fail(Plugin& plugin, const std::filesystem::path& path, const char* doing) {
    const std::string words = plugin ? plugin->geterror() : OIIO::geterror();
    throw Error(ErrorKind::Io, fmt::format("{}: {}", doing, phrase(words, path.string())));
}

OIIO::TypeDesc typeDesc(SampleType type) {
    switch (type) {
    case SampleType::UInt8:
        return OIIO::TypeDesc::UINT8;
    case SampleType::UInt16:
        return OIIO::TypeDesc::UINT16;
    case SampleType::Float:
        return OIIO::TypeDesc::FLOAT;
    }
    return OIIO::TypeDesc::UNKNOWN;
}

void requirePlausible(const OIIO::ImageSpec& spec, const std::filesystem::path& path) {
    if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide || spec.depth > 1 ||
        spec.nchannels < 1 || static_cast<std::size_t>(spec.nchannels) > kMaxChannels) {
        throw Error(ErrorKind::Io, fmt::format("is damaged: a picture of {} x {} with {} channels cannot be",
                                               spec.width, spec.height, spec.nchannels));
    }
    // Deflate compresses by 1032 at the very most: a header that promises more than that is wrong, and must not decide
    // how much memory is asked for.
    constexpr double kMostCompression = 1040.0;
    std::error_code error;
    const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
    if (!error && static_cast<double>(spec.image_bytes(true)) > kMostCompression * bytes)
        throw Error(ErrorKind::Io, "is damaged: it is much too short for its size in pixels");
}

std::unique_ptr<OIIO::ImageInput> open(const std::filesystem::path& path, ImageFormat format) {
    // Never a search for plugins in other folders.
    auto input = OIIO::ImageInput::create(pluginName(format), false, nullptr, nullptr, "");
    OIIO::ImageSpec spec;
    if (!input || !input->open(path.string(), spec)) fail(input, path, "cannot be read");
    requirePlausible(spec, path);
    return input;
}

} // namespace

std::string encode(ImageFormat format, const Header& header, SampleType type, const void* pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    auto output = OIIO::ImageOutput::create(pluginName(format), &memory);
    if (!output) fail(output, {}, "cannot be encoded");
    OIIO::ImageSpec spec(header.width, header.height, static_cast<int>(header.channels.size()), typeDesc(type));
    spec.channelnames = header.channels;
    switch (format) {
    case ImageFormat::Png:
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("oiio:UnassociatedAlpha", 1);
        break;
    case ImageFormat::Jpeg:
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("CompressionQuality", 95);
        // Coloured edges stay sharp: at this quality halved colour resolution is what one would see.
        spec.attribute("jpeg:subsampling", "4:4:4");
        break;
    case ImageFormat::Exr:
        spec.attribute("oiio:ColorSpace", "Linear");
        spec.attribute("compression", "zip");
        break;
    }
    for (const auto& [name, text] : header.texts)
        spec.attribute(name, text);
    if (!output->open(pluginName(format), spec) || !output->write_image(typeDesc(type), pixels) || !output->close())
        fail(output, {}, "cannot be encoded");
    return {bytes.begin(), bytes.end()};
}

Header decodeHeader(const std::filesystem::path& path, ImageFormat format) {
    const auto input = open(path, format);
    const OIIO::ImageSpec& spec = input->spec();
    Header header{spec.width, spec.height, spec.channelnames, {}};
    for (const OIIO::ParamValue& attribute : spec.extra_attribs)
        if (attribute.type() == OIIO::TypeString) header.texts[attribute.name().string()] = attribute.get_string();
    input->close();
    return header;
}

std::vector<float> decodeFloats(const std::filesystem::path& path, ImageFormat format, const Header& header) {
    const auto input = open(path, format);
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width != header.width || spec.height != header.height || spec.channelnames != header.channels)
        throw Error(ErrorKind::Io, "was changed while it was read");
    std::vector<float> values(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                              static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, values.data()) || !input->close())
        fail(input, path, "cannot be read");
    return values;
}

} // namespace apeiron::io
