#pragma once

#include "core/json.hpp"
#include "io/codec.hpp"

#include <filesystem>
#include <string>
#include <string_view>

// How scenes travel inside image files, which all formats share.
namespace apeiron::io {

/// Name of the metadata text that holds the scene.
inline constexpr const char* kSceneKey = "apeiron:scene";

/// The scene as text that no image format mangles: ASCII only, as JSON allows for any text.
/// @throws Error (BadInput) when it is larger than readers of PNG accept.
std::string embeddedText(const Json& scene);

/// The metadata that every file of ours has.
Header makeHeader(int width, int height, std::vector<std::string> channels, const Json& scene);

/// Puts a text into a JPEG file's bytes as comments, in as many pieces as it takes: one holds 64 KiB only.
void insertJpegComment(std::string& bytes, const std::string& text);

/// The text that insertJpegComment() wrote; empty when there is none.
std::string jpegComment(std::string_view bytes);

/// A file's format. @throws Error (Io) when it cannot be opened or is none of ours.
ImageFormat requireImageFormat(const std::filesystem::path& path);

} // namespace apeiron::io
