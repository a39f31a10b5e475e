#pragma once

#include "io/volumes/elements.hpp"

#include <itkImageIOBase.h>

namespace apeiron::io::volumes {

/// What ITK calls an element. @throws Error (Io) for what is no number.
Element elementOf(const itk::ImageIOBase& io);

/// Reads all of a file whose information has been read, as it is stored (channels side by side).
std::vector<std::byte> readElements(itk::ImageIOBase& io, std::size_t bytes);

} // namespace apeiron::io::volumes
