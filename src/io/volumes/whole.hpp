#pragma once

#include <cstddef>
#include <filesystem>

// Libraries fill up with zeros what a file lacks, or never come back from a header that is damaged: what has to be
// looked at before they are asked.
namespace apeiron::io::volumes {

/// Looks through a MetaImage's header. MetaIO loops or reads beyond its arrays where a number in it is wrong.
/// @throws Error (Io) for what makes no sense.
void requireMetaHeader(const std::filesystem::path& file);

/// @param elements numbers of all voxels and channels @param width bytes of each
/// @throws Error (Io) when a MetaImage's voxels are not all there. @pre requireMetaHeader() was content
void requireMetaVoxels(const std::filesystem::path& file, std::size_t elements, std::size_t width);

/// Looks through a NIfTI header: ITK never comes back from axes that are not finite.
/// @throws Error (Io) for what makes no sense.
void requireNiftiHeader(const std::filesystem::path& file);

/// @param voxels of all points of time @param components of each
/// @throws Error (Io) when a NIfTI file in one piece (.nii, .nii.gz) ends too early.
void requireNiftiVoxels(const std::filesystem::path& file, std::size_t voxels, std::size_t components);

/// @param bytes of pixels, as the header has them
/// @throws Error (Io) when a DICOM file of pixels that are not compressed ends before the last one.
void requireDicomPixels(const std::filesystem::path& file, std::size_t bytes);

/// Pages of a TIFF or BigTIFF file. @throws Error (Io) where one is said to be that is not in the file.
std::size_t tiffPageCount(const std::filesystem::path& file);

} // namespace apeiron::io::volumes
