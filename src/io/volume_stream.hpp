#pragma once

#include "core/error.hpp"
#include "volume/volume.hpp"

#include <cstdio>

// A volume, or why there is none, on its way from the reader's process to ours.
namespace apeiron::io {

/// @returns false when nobody listens any more.
bool sendVolume(std::FILE* to, const volume::Volume& volume);
bool sendError(std::FILE* to, const Error& error);

/// What was sent. @param limit no more bytes of voxels than this
/// @throws the Error that was sent; Error (Io) when the sender ended too early.
volume::Volume receiveVolume(std::FILE* from, std::size_t limit);

} // namespace apeiron::io
