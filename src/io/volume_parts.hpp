#pragma once

#include "volume/source.hpp"

namespace apeiron::io {

/// A file of bare voxels, for reading in parts, where it has more bytes than the request's memory allows (0: than the
/// machine has to spare); nothing where it has not, and for other formats. @throws Error (Io) for files that are
/// missing or too short, (BadInput) for a wrong raw form.
std::optional<volume::LargeVolume> openVolume(const volume::VolumeRequest& request);

} // namespace apeiron::io
