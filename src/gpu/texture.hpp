#pragma once

#include "core/image.hpp"
#include "core/math.hpp"
#include "gpu/context.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace apeiron::gpu {

/// Texel formats that every supported API can render to and sample.
enum class PixelFormat { R32F, RG32F, RGBA32F, RGBA16F, RGBA8, R32I, RG32I };

/// Bytes of one texel.
int bytesPerTexel(PixelFormat format);

/// A 2D texture without mipmaps, nearest filtering, clamped. Needs its context to be current, always.
class Texture {
  public:
    Texture() = default;
    /// Allocates; contents are zero. @pre size within capabilities().maxTextureSize
    /// @throws Error (Gpu) when memory runs out.
    Texture(const Context& context, PixelFormat format, glm::ivec2 size, const std::string& label);
    ~Texture();
    Texture(Texture&& other) noexcept;
    Texture& operator=(Texture&& other) noexcept;

    explicit operator bool() const { return name_ != 0; }
    glm::ivec2 size() const { return size_; }
    PixelFormat format() const { return format_; }
    unsigned name() const { return name_; } ///< the GL name, for gpu/ only

    /// Sets all texels of a float format: size().x * size().y * channels values, first row first.
    void upload(std::span<const float> texels);

    /// Sets a rectangle of texels of a float or integer format, first row first. @pre inside
    void upload(glm::ivec2 origin, glm::ivec2 size, std::span<const float> texels);
    void upload(glm::ivec2 origin, glm::ivec2 size, std::span<const std::int32_t> texels);

    /// Takes over the first size() texels of another texture of the same float format. @pre it is no smaller
    void copy(const Texture& from);

    /// Reads a float or RGBA8 texture back as RGBA floats (RGBA8 as 0..1); texel row 0 becomes image row 0.
    Image<float> download() const;
    /// As download(), of `rows` rows from `first` on. @pre inside
    Image<float> download(int first, int rows) const;
    /// Reads a rectangle of an integer texture: four ints a texel. @pre inside
    std::vector<std::int32_t> downloadIntegers(glm::ivec2 origin, glm::ivec2 size) const;
    /// Reads one texel of a float texture. @pre inside
    glm::vec4 texel(glm::ivec2 position) const;

  private:
    unsigned name_ = 0;
    PixelFormat format_ = PixelFormat::RGBA32F;
    glm::ivec2 size_{0};
};

/// Textures that kernels write together: 1 to 4, of the same size. References them; does not own them.
class Targets {
  public:
    Targets() = default;
    Targets(const Context& context, std::vector<const Texture*> textures);
    ~Targets();
    Targets(Targets&& other) noexcept;
    Targets& operator=(Targets&& other) noexcept;

    /// The default framebuffer of a window or canvas, of that size in pixels.
    static Targets screen(glm::ivec2 size);

    glm::ivec2 size() const { return size_; }
    const std::vector<const Texture*>& textures() const { return textures_; }
    unsigned framebuffer() const { return framebuffer_; } ///< the GL name, for gpu/ only

  private:
    std::vector<const Texture*> textures_;
    unsigned framebuffer_ = 0;
    glm::ivec2 size_{0};
};

} // namespace apeiron::gpu
