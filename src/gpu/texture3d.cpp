#include "gpu/texture3d.hpp"

#include "gpu/texel_layout.hpp"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <utility>

namespace apeiron::gpu {
namespace {

TexelLayout info(GridFormat format) {
    static const std::array<TexelLayout, 11> kFormats{{
        {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1},
        {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2, 2},
        {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4},
        {GL_R16F, GL_RED, GL_HALF_FLOAT, 1, 2},
        {GL_RG16F, GL_RG, GL_HALF_FLOAT, 2, 4},
        {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 4, 8},
        {GL_R32F, GL_RED, GL_FLOAT, 1, 4},
        {GL_RG32F, GL_RG, GL_FLOAT, 2, 8},
        {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 16},
        {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 2, 8},
        {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4, 16},
    }};
    return kFormats[static_cast<std::size_t>(format)];
}

} // namespace

int channelsOf(GridFormat format) {
    return info(format).channels;
}

int bytesPerTexel(GridFormat format) {
    return info(format).bytes;
}

bool filterable(const Context& context, GridFormat format) {
    if (info(format).type == GL_UNSIGNED_INT) return false;
    return info(format).type != GL_FLOAT || context.capabilities().floatFiltering;
}

Texture3D::Texture3D(const Context& context, GridFormat format, glm::ivec3 size, const std::string& label)
    : format_(format), size_(size) {
    assert(size.x > 0 && size.y > 0 && size.z > 0);
    const int most = context.capabilities().maxTextureSize3D;
    if (size.x > most || size.y > most || size.z > most) {
        throw Error(ErrorKind::BadInput,
                    fmt::format("{}x{}x{} is larger than the device's 3D textures", size.x, size.y, size.z),
                    context.capabilities().renderer, fmt::format("at most {0}x{0}x{0}", most));
    }
    glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_3D, name_);
    glTexStorage3D(GL_TEXTURE_3D, 1, info(format).internal, size.x, size.y, size.z);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
    setLinear(false);
    setLabel(GL_TEXTURE, name_, label);
    try {
        context.check(("allocating " + label).c_str());
    } catch (...) {
        glDeleteTextures(1, &name_);
        throw;
    }
}

Texture3D::~Texture3D() {
    if (name_ != 0) glDeleteTextures(1, &name_);
}

Texture3D::Texture3D(Texture3D&& other) noexcept
    : name_(std::exchange(other.name_, 0)), format_(other.format_), size_(other.size_) {}

Texture3D& Texture3D::operator=(Texture3D&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(format_, other.format_);
    std::swap(size_, other.size_);
    return *this;
}

void Texture3D::setLinear(bool linear) {
    glBindTexture(GL_TEXTURE_3D, name_);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_3D, filter, linear ? GL_LINEAR : GL_NEAREST);
}

void Texture3D::upload(std::span<const std::byte> texels, int first, int slices) {
    upload(texels, glm::ivec3(0, 0, first), glm::ivec3(size_.x, size_.y, slices));
}

void Texture3D::upload(std::span<const std::byte> texels, glm::ivec3 first, glm::ivec3 size) {
    const TexelLayout f = info(format_);
    assert(glm::all(glm::greaterThanEqual(glm::min(first, size), glm::ivec3(0))));
    assert(glm::all(glm::lessThanEqual(first + size, size_)));
    assert(texels.size() == static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                static_cast<std::size_t>(size.z) * static_cast<std::size_t>(f.bytes));
    glBindTexture(GL_TEXTURE_3D, name_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage3D(GL_TEXTURE_3D, 0, first.x, first.y, first.z, size.x, size.y, size.z, f.format, f.type,
                    texels.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

} // namespace apeiron::gpu
