#pragma once

#include "volume/source.hpp"

namespace apeiron::io {

/// Reads a volume: NRRD, MetaImage, NIfTI, DICOM (a folder is a series), TIFF and OME-TIFF (a folder is a stack),
/// OpenVDB, and bare voxels. The kind is seen from the content, not from the name.
///
/// Files are read by a process of its own, the program `apeiron-reader`: our program starts without those libraries,
/// and a file that makes one of them crash or ask for too much memory ends in an error here.
///
/// @throws Error (Io) for files that are missing, damaged, of no known kind or larger than the memory; BadInput for a
/// wrong raw form.
volume::Volume readVolume(const volume::VolumeRequest& request);

/// Whether a path looks like something for readVolume() rather than a scene or picture: a folder, or a file that begins
/// like a volume.
bool isVolume(const std::filesystem::path& path);

/// From now on volume::loadVolume() reads files.
void registerVolumeFiles();

/// Memory that the machine has to spare [bytes].
std::size_t availableMemory();

/// What a request's voxels may take: what it says, or a large part of what there is to spare [bytes].
std::size_t memoryFor(const volume::VolumeRequest& request);

} // namespace apeiron::io
