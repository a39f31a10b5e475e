#pragma once

#include "core/math.hpp"
#include "gpu/context.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace apeiron::gpu {

/// Texel formats of 3D textures. All can be sampled everywhere, WebGL 2 included; see filterable() for the rest. Those
/// of integers are for usampler3D.
enum class GridFormat { R8, RG8, RGBA8, R16F, RG16F, RGBA16F, R32F, RG32F, RGBA32F, RG32UI, RGBA32UI };

/// Channels of a texel: 1, 2 or 4.
int channelsOf(GridFormat format);
/// Bytes of one texel.
int bytesPerTexel(GridFormat format);
/// Whether the device interpolates that format: 32-bit floats need OES_texture_float_linear in ES and WebGL,
/// integers never are.
bool filterable(const Context& context, GridFormat format);

/// A 3D texture without mipmaps, clamped. Read only for kernels. Needs its context to be current, always.
class Texture3D {
  public:
    Texture3D() = default;
    /// Allocates; contents are undefined until upload(). Nearest filtering.
    /// @throws Error (BadInput) when it is larger than the device's 3D textures, (Gpu) when memory runs out.
    Texture3D(const Context& context, GridFormat format, glm::ivec3 size, const std::string& label);
    ~Texture3D();
    Texture3D(Texture3D&& other) noexcept;
    Texture3D& operator=(Texture3D&& other) noexcept;

    explicit operator bool() const { return name_ != 0; }
    glm::ivec3 size() const { return size_; }
    GridFormat format() const { return format_; }
    unsigned name() const { return name_; } ///< the GL name, for gpu/ only

    /// Interpolates between texels, or takes the nearest one. @pre filterable() for true
    void setLinear(bool linear);

    /// Sets `slices` slices from `first` on: x fastest, channels interleaved, in the format's own type (bytes, half or
    /// single floats, 32-bit integers).
    void upload(std::span<const std::byte> texels, int first, int slices);

    /// Sets a box of texels, likewise. @pre it is inside
    void upload(std::span<const std::byte> texels, glm::ivec3 first, glm::ivec3 size);

  private:
    unsigned name_ = 0;
    GridFormat format_ = GridFormat::R8;
    glm::ivec3 size_{0};
};

} // namespace apeiron::gpu
