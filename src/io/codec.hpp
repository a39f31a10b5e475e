#pragma once

#include "io/image_file.hpp"

#include <map>
#include <string>
#include <vector>

// The seam between our files and the library that encodes them: what a file holds, without what it means.
namespace apeiron::io {

/// What stands before the pixels of an image file.
struct Header {
    int width = 0;                            ///< [px]
    int height = 0;                           ///< [px]
    std::vector<std::string> channels;        ///< names, in the order of the interleaved values
    std::map<std::string, std::string> texts; ///< metadata by name
};

/// How one value is stored.
enum class SampleType { UInt8, UInt16, Float };

/// The complete file, in memory: encoders that write to disk themselves keep quiet about full ones (PNG), or end the
/// program (JPEG). PNG: straight alpha, sRGB. JPEG: quality 95, 3 channels. EXR: zip, lossless.
/// @param pixels  width * height * channels values of that type, rows from the top
/// @throws Error (Io) with the library's own words.
std::string encode(ImageFormat format, const Header& header, SampleType type, const void* pixels);

/// Reads what stands before the pixels. @throws Error (Io) for files that are damaged or of absurd size.
Header decodeHeader(const std::filesystem::path& path, ImageFormat format);

/// Reads all values of a float file whose header was read before. @throws Error (Io).
std::vector<float> decodeFloats(const std::filesystem::path& path, ImageFormat format, const Header& header);

} // namespace apeiron::io
