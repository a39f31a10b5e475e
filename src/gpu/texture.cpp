#include "gpu/texture.hpp"

#include "gpu/texel_layout.hpp"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <utility>

namespace apeiron::gpu {
namespace {

TexelLayout info(PixelFormat format) {
    switch (format) {
    case PixelFormat::R32F:
        return {GL_R32F, GL_RED, GL_FLOAT, 1, 4};
    case PixelFormat::RG32F:
        return {GL_RG32F, GL_RG, GL_FLOAT, 2, 8};
    case PixelFormat::RGBA32F:
        return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 16};
    case PixelFormat::RGBA16F:
        return {GL_RGBA16F, GL_RGBA, GL_FLOAT, 4, 8};
    case PixelFormat::RGBA8:
        return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4};
    case PixelFormat::R32I:
        return {GL_R32I, GL_RED_INTEGER, GL_INT, 1, 4};
    case PixelFormat::RG32I:
        return {GL_RG32I, GL_RG_INTEGER, GL_INT, 2, 8};
    }
    assert(false);
    return {};
}

/// A framebuffer for reading one texture, for as long as it lives.
class ReadBinding {
  public:
    explicit ReadBinding(GLuint texture) {
        glGenFramebuffers(1, &framebuffer_);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
        glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
        glReadBuffer(GL_COLOR_ATTACHMENT0);
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
    }
    ~ReadBinding() {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
        glDeleteFramebuffers(1, &framebuffer_);
    }
    ReadBinding(const ReadBinding&) = delete;
    ReadBinding& operator=(const ReadBinding&) = delete;

  private:
    GLuint framebuffer_ = 0;
};

} // namespace

int bytesPerTexel(PixelFormat format) {
    return info(format).bytes;
}

Texture::Texture(const Context& context, PixelFormat format, glm::ivec2 size, const std::string& label)
    : format_(format), size_(size) {
    assert(size.x > 0 && size.y > 0);
    if (size.x > context.capabilities().maxTextureSize || size.y > context.capabilities().maxTextureSize) {
        throw Error(ErrorKind::BadInput, fmt::format("{}x{} is larger than the device's textures", size.x, size.y),
                    context.capabilities().renderer,
                    fmt::format("at most {0}x{0}", context.capabilities().maxTextureSize));
    }
    glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glTexStorage2D(GL_TEXTURE_2D, 1, info(format).internal, size.x, size.y);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
        glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    }
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    }
    setLabel(GL_TEXTURE, name_, label);
    try {
        context.check(("allocating " + label).c_str());
    } catch (...) {
        glDeleteTextures(1, &name_);
        throw;
    }
    // Storage starts out undefined outside WebGL: clear it, so that nothing ever depends on what was there.
    if (format != PixelFormat::R32I && format != PixelFormat::RG32I) {
        GLuint framebuffer = 0;
        glGenFramebuffers(1, &framebuffer);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, name_, 0);
        const std::array<float, 4> zero{};
        glDisable(GL_SCISSOR_TEST);
        glClearBufferfv(GL_COLOR, 0, zero.data());
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glDeleteFramebuffers(1, &framebuffer);
    }
}

Texture::~Texture() {
    if (name_ != 0) glDeleteTextures(1, &name_);
}

Texture::Texture(Texture&& other) noexcept
    : name_(std::exchange(other.name_, 0)), format_(other.format_), size_(other.size_) {}

Texture& Texture::operator=(Texture&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(format_, other.format_);
    std::swap(size_, other.size_);
    return *this;
}

void Texture::upload(std::span<const float> texels) {
    upload(glm::ivec2(0), size_, texels);
}

void Texture::upload(glm::ivec2 origin, glm::ivec2 size, std::span<const float> texels) {
    const TexelLayout f = info(format_);
    assert(f.type == GL_FLOAT && texels.size() == static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                                      static_cast<std::size_t>(f.channels));
    glBindTexture(GL_TEXTURE_2D, name_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, origin.x, origin.y, size.x, size.y, f.format, f.type, texels.data());
}

void Texture::upload(glm::ivec2 origin, glm::ivec2 size, std::span<const std::int32_t> texels) {
    const TexelLayout f = info(format_);
    assert(f.type == GL_INT && texels.size() == static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                                    static_cast<std::size_t>(f.channels));
    glBindTexture(GL_TEXTURE_2D, name_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, origin.x, origin.y, size.x, size.y, f.format, f.type, texels.data());
}

void Texture::copy(const Texture& from) {
    assert(from.format_ == format_ && from.size_.x >= size_.x && from.size_.y >= size_.y);
    const ReadBinding binding(from.name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glCopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, size_.x, size_.y);
}

std::vector<std::int32_t> Texture::downloadIntegers(glm::ivec2 origin, glm::ivec2 size) const {
    assert(format_ == PixelFormat::R32I || format_ == PixelFormat::RG32I);
    std::vector<std::int32_t> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * 4);
    const ReadBinding binding(name_);
    glReadPixels(origin.x, origin.y, size.x, size.y, GL_RGBA_INTEGER, GL_INT, texels.data());
    return texels;
}

Image<float> Texture::download() const {
    return download(0, size_.y);
}

Image<float> Texture::download(int first, int rows) const {
    assert(first >= 0 && rows > 0 && first + rows <= size_.y);
    Image<float> image(size_.x, rows, 4);
    const ReadBinding binding(name_);
    if (format_ == PixelFormat::RGBA8) {
        std::vector<std::uint8_t> bytes(image.data().size());
        glReadPixels(0, first, size_.x, rows, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
        for (std::size_t i = 0; i < bytes.size(); ++i)
            image.data()[i] = static_cast<float>(bytes[i]) / 255.0F;
    } else {
        glReadPixels(0, first, size_.x, rows, GL_RGBA, GL_FLOAT, image.data().data());
    }
    return image;
}

glm::vec4 Texture::texel(glm::ivec2 position) const {
    assert(position.x >= 0 && position.y >= 0 && position.x < size_.x && position.y < size_.y);
    glm::vec4 value(0.0F);
    const ReadBinding binding(name_);
    glReadPixels(position.x, position.y, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
    return value;
}

Targets::Targets(const Context& context, std::vector<const Texture*> textures) : textures_(std::move(textures)) {
    assert(!textures_.empty() && textures_.size() <= 4);
    size_ = textures_.front()->size();
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    std::vector<GLenum> buffers;
    for (const Texture* texture : textures_) {
        assert(texture->size() == size_);
        const auto attachment = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size());
        glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture->name(), 0);
        buffers.push_back(attachment);
    }
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        glDeleteFramebuffers(1, &framebuffer_);
        throw Error(ErrorKind::Gpu, fmt::format("the driver refuses a framebuffer (0x{:04x})", status),
                    context.capabilities().renderer);
    }
}

Targets::~Targets() {
    if (framebuffer_ != 0) glDeleteFramebuffers(1, &framebuffer_);
}

Targets::Targets(Targets&& other) noexcept
    : textures_(std::move(other.textures_)), framebuffer_(std::exchange(other.framebuffer_, 0)), size_(other.size_) {}

Targets& Targets::operator=(Targets&& other) noexcept {
    std::swap(textures_, other.textures_);
    std::swap(framebuffer_, other.framebuffer_);
    std::swap(size_, other.size_);
    return *this;
}

Targets Targets::screen(glm::ivec2 size) {
    Targets targets;
    targets.size_ = size;
    return targets;
}

} // namespace apeiron::gpu
