#pragma once

#include "volume/volume.hpp"

#include <string_view>

namespace apeiron::volume {

/// How a file of bare voxels is to be read.
struct RawForm {
    glm::ivec3 size{0};
    VoxelType type = VoxelType::UInt8;
    bool bigEndian = false;
    std::uint64_t offset = 0; ///< bytes before the first voxel
    int channels = 1;         ///< one after the other, not interleaved
    int timePoints = 1;
    glm::dvec3 spacing{1}; ///< [mm]
};

/// Reads `128x128x64:uint16`, after which `:big`, `:little` (the default), `:offset=512`, `:channels=3`, `:times=10`
/// and
/// `:spacing=0.5x0.5x1.2` [mm] may follow in any order. @throws Error (BadInput)
RawForm parseRawForm(std::string_view text);

/// Bytes of the voxels alone. @throws Error (BadInput) as volume::byteSize().
std::size_t byteSize(const RawForm& form, std::size_t limit);

/// Everything but the voxels, which the caller fills in, then calls toNativeOrder(). @throws Error (BadInput) before
/// allocating.
Volume makeVolume(const RawForm& form, std::size_t limit);

/// Turns bytes around where the form's order is not the machine's.
void toNativeOrder(Volume& volume, const RawForm& form);

/// A volume of bytes in memory. @throws Error (BadInput) when there are too few.
Volume fromRaw(const RawForm& form, std::string_view bytes);

} // namespace apeiron::volume
