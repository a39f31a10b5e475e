#pragma once

#include "core/image.hpp"
#include "core/json.hpp"

#include <filesystem>
#include <optional>
#include <string>

// Pictures as files. Every file holds the scene that it shows, so that it can be rendered again from itself.
namespace apeiron::io {

/// The kinds of image file that are written and read.
enum class ImageFormat {
    Png,  ///< 8 or 16 bits per channel, straight alpha
    Jpeg, ///< 8 bits per channel, opaque
    Exr,  ///< float layers: see layers_file.hpp
};

/// The format that a file name asks for. @throws Error (BadInput) for an unknown extension, with the known ones.
ImageFormat imageFormat(const std::filesystem::path& path);

/// What an existing file is, by its first bytes; nothing for files of another kind and for unreadable ones.
std::optional<ImageFormat> detectImageFormat(const std::filesystem::path& path);

/// One step of the values that a file can hold, for dithering: 1/255 or 1/65535; 0 for float files.
/// @param bits 8 or 16: what is asked for; JPEG always has 8
double stepSize(ImageFormat format, int bits);

/// Writes a finished picture as PNG or JPEG.
///
/// PNG keeps alpha where any pixel is not opaque. JPEG has none: the picture is blended over black.
/// @param picture  display-encoded (sRGB) RGBA in [0, 1], alpha not premultiplied
/// @param bits     8 or 16 per channel (JPEG: 8 always)
/// @param scene    the document that readScene() gives back
/// @throws Error (BadInput) for another format, (Io) when the file cannot be written; an old file is then untouched.
void writeImage(const std::filesystem::path& path, const Image<float>& picture, int bits, const Json& scene);

/// What an image file says about itself.
struct ImageInfo {
    ImageFormat format = ImageFormat::Png;
    int width = 0;    ///< [px]
    int height = 0;   ///< [px]
    int channels = 0; ///< stored values per pixel
};

/// @throws Error (Io) for a missing, unreadable or damaged file and one of another kind.
ImageInfo readImageInfo(const std::filesystem::path& path);

/// The JSON text of the scene that a PNG, JPEG or EXR file of ours shows.
/// @throws Error (Io) as readImageInfo(), and for a picture that holds no scene.
std::string readScene(const std::filesystem::path& path);

} // namespace apeiron::io
