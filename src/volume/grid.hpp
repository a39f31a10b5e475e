#pragma once

#include "gpu/texture3d.hpp"
#include "volume/volume.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace apeiron::volume {

/// Lowest and highest stored value in each brick of voxels, with all that is interpolated within it: one voxel around.
struct BrickRanges {
    int side = 8;       ///< of a brick [voxels]
    glm::ivec3 size{0}; ///< bricks along x, y, z
    int channels = 1;
    /// By channel, then x fastest, y, z.
    std::vector<glm::vec2> ranges;
};

/// Stored values of one slice as numbers; what is no finite number becomes the type's or, for floats, 0.
/// @param out size.x * size.y values, `stride` apart
void readSlice(const Volume& volume, int time, int channel, int z, std::span<float> out, std::size_t stride = 1);

/// @pre side >= 1
BrickRanges brickRanges(const Volume& volume, int time, int side);

/// Reads a slice of a channel as readSlice() does, one value after the other.
using SliceReader = std::function<void(int channel, int z, std::span<float> out)>;

/// Of data that are read once, slice by slice from the first to the last of each channel. @pre side >= 1
BrickRanges brickRanges(glm::ivec3 size, int channels, int side, const SliceReader& read);

/// How voxels are kept on the GPU: 8-bit data as normalised bytes, 16-bit data as half floats where all values are
/// such, else single floats.
struct TexelForm {
    gpu::GridFormat format = gpu::GridFormat::R8;
    double scale = 1; ///< stored value = scale * texel + offset
    double offset = 0;
};

/// @param ranges of all voxels
TexelForm texelForm(VoxelType type, const BrickRanges& ranges);

/// Texels of stored values, those of channels interleaved; what lies between whole numbers is rounded for bytes.
/// @param texels as many values in the form's own type
void encodeTexels(const TexelForm& form, std::span<const float> values, std::span<std::byte> texels);

/// A point of time of a volume on the GPU: exact copies of all its channels. Needs its context current.
/// @throws Error (BadInput) when it is larger than the device's textures, (Gpu) when memory runs out.
gpu::Texture3D uploadGrid(const gpu::Context& context, const Volume& volume, int time, const TexelForm& form);

/// The same values with all eight voxels of an interpolation in one texel (values_corners.glsl); nothing for volumes of
/// several channels, of single floats, and those for which it would take more than `limit` bytes.
/// @throws Error (Gpu) when memory runs out.
std::optional<gpu::Texture3D> uploadCorners(const gpu::Context& context, const Volume& volume, int time,
                                            const BrickRanges& ranges, std::size_t limit);

/// The largest opacity of each brick, for tables of opacities of each channel: channels add. Where it is 0, the number
/// of free bricks to every side, itself included, as a negative number (Chebyshev's distance).
/// @param tables `width` opacities for each channel, of which the first is for place 0 and the last for place 1
/// @param lookup for each channel: place in its table = x * stored value + y
std::vector<float> majorants(const BrickRanges& ranges, std::span<const float> tables, std::size_t width,
                             std::span<const glm::dvec2> lookup);

/// 1 for each brick in which some channel's values lie to both sides of a place, or on it; else as majorants().
/// @param lookup as for majorants()
std::vector<float> crossings(const BrickRanges& ranges, double place, std::span<const glm::dvec2> lookup);

} // namespace apeiron::volume
