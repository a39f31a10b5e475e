#pragma once

#include <filesystem>
#include <optional>

namespace apeiron::io {

/// Kinds of files that hold volumes.
enum class VolumeKind { Nrrd, MetaImage, Nifti, Dicom, Tiff, OpenVdb };

/// The kind by a file's first bytes (and for compressed NIfTI by its name, too). Nothing for any other, for folders,
/// and for files that cannot be read.
std::optional<VolumeKind> volumeKind(const std::filesystem::path& file);

} // namespace apeiron::io
