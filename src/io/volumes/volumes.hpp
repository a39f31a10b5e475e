#pragma once

#include "io/volume_kind.hpp"
#include "volume/source.hpp"

#include <cstddef>
#include <string>
#include <vector>

// The readers behind io::readVolume(), which run in the reader's process. Messages do not name the file: the caller
// does.
namespace apeiron::io::volumes {

/// Reads what the request names, a folder too. @param limit most bytes of voxels
/// @throws Error, and nothing else.
volume::Volume read(const volume::VolumeRequest& request, std::size_t limit);

/// NRRD, MetaImage, NIfTI.
volume::Volume readItk(const std::filesystem::path& file, VolumeKind kind, std::size_t limit);

/// The slices of one series, in any order; or one file of one or more frames. Tilted gantries give a sheared grid,
/// uneven distances are resampled, with a message each; slices that are not in one line are refused.
volume::Volume readDicom(const std::vector<std::filesystem::path>& files, std::size_t limit);

/// The pages of one file, or of several in order. OME-XML and ImageJ's description say what the pages are.
volume::Volume readTiff(const std::vector<std::filesystem::path>& files, std::size_t limit);

/// The named grid, or the first one. @param name may be empty
volume::Volume readVdb(const std::filesystem::path& file, const std::string& name, std::size_t limit);

/// What a library says of a file, for a message of one line.
std::string inOneLine(std::string text);

} // namespace apeiron::io::volumes
