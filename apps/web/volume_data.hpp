#pragma once

#include "volume/volume.hpp"

#include <emscripten/val.h>

#include <string>

namespace apeiron::web {

/// A volume of what JavaScript read.
/// @param voxels a Uint8Array of them, in the order of volume::Volume and this machine's byte order
/// @param form JSON, as src/volumes/volume_file.ts describes it: what the voxels are
/// @throws Error (BadInput) for forms that cannot be, and where there are too few or too many bytes
volume::Volume volumeOf(const std::string& name, const emscripten::val& voxels, const std::string& form);

} // namespace apeiron::web
