#pragma once

#include "../temporary_folder.hpp"
#include "core/file.hpp"
#include "volume/volume.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

// Files of every kind, byte by byte as their specifications say: readers are tested against these, not against writers
// of the same libraries.
namespace apeiron::test {

/// Numbers as they lie in a file.
template <class T> std::string bytesOf(const std::vector<T>& values, bool bigEndian = false) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    if (bigEndian)
        for (std::size_t i = 0; i < bytes.size(); i += sizeof(T))
            std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                         bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(T)));
    return bytes;
}

/// What a volume holds, as it lies in memory.
std::string bytesOf(const volume::Volume& volume);

/// A gzip file (RFC 1952) of stored blocks.
std::string gzip(std::string_view bytes);
/// A zlib stream (RFC 1950) of stored blocks.
std::string zlib(std::string_view bytes);

/// Whether one of the messages has this part.
bool says(const volume::Volume& volume, std::string_view part);

/// Where the centre of a voxel is in the world [mm].
glm::dvec3 placeOf(const volume::Volume& volume, glm::dvec3 voxel);

/// A NIfTI-1 file in one piece (.nii).
struct Nifti {
    std::vector<std::int16_t> dim;         ///< x, y, z, t, ...
    std::int16_t datatype = 2;             ///< 2 uint8, 4 int16, 8 int32, 16 float, 64 double, 256 int8, 512 uint16
    std::int16_t bits = 8;                 ///< of it
    std::vector<float> pixdim{1, 1, 1, 1}; ///< [mm], [s]
    float slope = 0;                       ///< 0: not told
    float intercept = 0;
    std::vector<float> sform;      ///< 12 numbers, rows; RAS+; empty: none
    std::vector<float> quaternion; ///< b, c, d, and the offsets of the qform; empty: none
    float qfac = 1;
    bool bigEndian = false;
};
std::string niftiFile(const Nifti& header, std::string_view voxels);

/// A DICOM file (explicit VR, little endian) of one slice.
struct DicomSlice {
    int columns = 4, rows = 3;
    int bits = 16;
    bool isSigned = true;
    std::string modality = "CT";
    std::string series = "1.2.3.4";
    int instance = 1;
    glm::dvec3 position{0}; ///< ImagePositionPatient [mm]
    glm::dvec3 row{1, 0, 0}, column{0, 1, 0};
    glm::dvec2 spacing{1}; ///< of columns, of rows [mm]
    double slope = 1, intercept = 0;
    std::string pixels; ///< little endian
};
std::string dicomFile(const DicomSlice& slice);

/// A baseline TIFF file of uncompressed pages, a strip each.
struct Tiff {
    int width = 4, height = 3;
    int bits = 8;
    int samples = 1;
    int format = 1; ///< 1 unsigned, 2 signed, 3 float
    bool bigEndian = false;
    std::string description;        ///< of the first page
    double resolution = 0;          ///< pixels per unit; 0: not told
    std::vector<std::string> pages; ///< pixels, in the file's byte order
};
std::string tiffFile(const Tiff& tiff);

} // namespace apeiron::test
