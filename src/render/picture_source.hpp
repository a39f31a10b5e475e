#pragma once

#include "core/image.hpp"

#include <filesystem>
#include <functional>

namespace apeiron::render {

/// Reads a picture as linear RGB radiance, rows from the top. @throws Error (Io, BadInput)
using PictureLoader = std::function<Image<float>(const std::filesystem::path&)>;

/// The engine itself knows no files: a front end says once how pictures are read (natively io::readRadiance).
/// Process-wide, not thread-safe.
void setPictureLoader(PictureLoader loader);

/// The picture of a file. What is no finite number or negative becomes 0, and pictures wider than `limit` are halved
/// until they are not (the mean of 2 x 2 pixels, which keeps their light).
/// @throws Error: what the loader throws; BadInput without a loader, and for a picture that is not RGB
Image<float> loadPicture(const std::filesystem::path& file, int limit = 4096);

} // namespace apeiron::render
