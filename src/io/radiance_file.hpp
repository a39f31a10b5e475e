#pragma once

#include "core/image.hpp"

#include <filesystem>

namespace apeiron::io {

/// A picture of light as linear RGB, rows from the top: EXR and HDR as they are, PNG and JPEG out of sRGB; grey becomes
/// RGB, alpha is left out. @throws Error (Io) for a missing, unreadable or damaged file, and one that is larger than
/// 16384 x 16384.
Image<float> readRadiance(const std::filesystem::path& path);

/// From now on render::loadPicture() reads files.
void registerPictureFiles();

} // namespace apeiron::io
