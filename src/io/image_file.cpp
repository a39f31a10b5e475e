#include "io/image_file.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "io/embedded_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <system_error>

namespace apeiron::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = std::size_t{4} << 30; // [bytes]

/// IEC 61966-2-1.
float toLinear(float c) {
    return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

float toDisplay(float c) {
    return c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F;
}

/// Light adds up linearly: so does blending over black, between decoding and encoding again.
float overBlack(float encoded, float alpha) {
    return alpha >= 1.0F ? encoded : toDisplay(toLinear(encoded) * std::max(alpha, 0.0F));
}

/// The nearest of the values 0..most; NaN becomes 0.
template <class T> T quantised(float value, float most) {
    if (!(value > 0.0F)) return 0;
    return static_cast<T>(std::lround(std::min(value, 1.0F) * most));
}

bool isOpaque(const Image<float>& picture) {
    for (std::size_t i = 3; i < picture.data().size(); i += 4)
        if (picture.data()[i] < 1.0F) return false;
    return true;
}

/// @param channels 3 or 4
/// @param blend    blend over black (for 3 channels)
template <class T> std::vector<T> quantise(const Image<float>& picture, std::size_t channels, bool blend) {
    constexpr auto kMost = static_cast<float>(static_cast<T>(~T{0}));
    std::vector<T> values;
    values.reserve(picture.data().size() / 4 * channels);
    for (std::size_t i = 0; i < picture.data().size(); i += 4) {
        const float* pixel = picture.data().data() + i;
        for (std::size_t c = 0; c < channels; ++c)
            values.push_back(quantised<T>(blend ? overBlack(pixel[c], pixel[3]) : pixel[c], kMost));
    }
    return values;
}

std::string encodePicture(ImageFormat format, const Image<float>& picture, int bits, const Json& scene) {
    const bool jpeg = format == ImageFormat::Jpeg;
    const bool alpha = !jpeg && !isOpaque(picture);
    std::vector<std::string> channels{"R", "G", "B"};
    if (alpha) channels.emplace_back("A");
    Header header = makeHeader(picture.width(), picture.height(), channels, scene);
    const std::string text = header.texts[kSceneKey];
    if (jpeg) header.texts.erase(kSceneKey);
    if (bits == 16 && !jpeg) {
        const auto values = quantise<std::uint16_t>(picture, channels.size(), false);
        return encode(format, header, SampleType::UInt16, values.data());
    }
    const auto values = quantise<std::uint8_t>(picture, channels.size(), jpeg);
    std::string bytes = encode(format, header, SampleType::UInt8, values.data());
    if (jpeg) insertJpegComment(bytes, text);
    return bytes;
}

Header headerOf(const fs::path& path, ImageFormat format) {
    try {
        return decodeHeader(path, format);
    } catch (const Error& error) {
        throw error.at(path.string());
    }
}

} // namespace

ImageFormat imageFormat(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".png") return ImageFormat::Png;
    if (extension == ".jpg" || extension == ".jpeg") return ImageFormat::Jpeg;
    if (extension == ".exr") return ImageFormat::Exr;
    const std::string what = extension.empty() ? "the name has no extension that tells the format"
                                               : fmt::format("cannot write '{}'", path.extension().string());
    throw Error(ErrorKind::BadInput, what, path.string(), "known: .png .jpg .exr");
}

std::optional<ImageFormat> detectImageFormat(const fs::path& path) {
    std::error_code ignored;
    // A pipe's first bytes could not be put back.
    if (!fs::is_regular_file(path, ignored)) return std::nullopt;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return std::nullopt;
    char bytes[8] = {};
    const std::string_view begin(bytes, std::fread(bytes, 1, sizeof bytes, file));
    std::fclose(file);
    if (begin.starts_with("\x89PNG\r\n\x1a\n")) return ImageFormat::Png;
    if (begin.starts_with("\xFF\xD8\xFF")) return ImageFormat::Jpeg;
    if (begin.starts_with("\x76\x2F\x31\x01")) return ImageFormat::Exr;
    return std::nullopt;
}

ImageFormat requireImageFormat(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) throw Error(ErrorKind::Io, "there is no such file", path.string());
    if (fs::is_directory(status)) throw Error(ErrorKind::Io, "is a folder, not a file", path.string());
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr)
        throw Error(ErrorKind::Io, "cannot be read: " + std::generic_category().message(errno), path.string());
    std::fclose(file);
    const std::optional<ImageFormat> format = detectImageFormat(path);
    if (!format) throw Error(ErrorKind::Io, "is not a PNG, JPEG or EXR picture", path.string());
    return *format;
}

double stepSize(ImageFormat format, int bits) {
    if (format == ImageFormat::Exr) return 0.0;
    return format == ImageFormat::Png && bits == 16 ? 1.0 / 65535.0 : 1.0 / 255.0;
}

void writeImage(const fs::path& path, const Image<float>& picture, int bits, const Json& scene) {
    assert(picture.channels() == 4 && !picture.empty() && (bits == 8 || bits == 16));
    const ImageFormat format = imageFormat(path);
    if (format == ImageFormat::Exr)
        throw Error(ErrorKind::BadInput, "EXR files hold samples, not finished pictures", path.string());
    std::string bytes;
    try {
        bytes = encodePicture(format, picture, bits, scene);
    } catch (const Error& error) {
        throw error.at(path.string());
    }
    writeFile(path, bytes);
}

ImageInfo readImageInfo(const fs::path& path) {
    const ImageFormat format = requireImageFormat(path);
    const Header header = headerOf(path, format);
    return {format, header.width, header.height, static_cast<int>(header.channels.size())};
}

std::string readScene(const fs::path& path) {
    const ImageFormat format = requireImageFormat(path);
    std::string text;
    if (format == ImageFormat::Jpeg) {
        text = jpegComment(readFile(path, kLargestFile));
    } else {
        text = headerOf(path, format).texts[kSceneKey];
    }
    if (text.empty())
        throw Error(ErrorKind::Io, "holds no Apeiron scene", path.string(), "only pictures that Apeiron wrote do");
    return text;
}

} // namespace apeiron::io
