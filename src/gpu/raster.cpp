#include "gpu/raster.hpp"

#include "gpu/context_native.hpp"
#include "gpu/gl.hpp"

#ifdef __EMSCRIPTEN__
#include <emscripten/em_js.h>
#include <emscripten/html5.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace apeiron::gpu {
namespace {

#ifdef __EMSCRIPTEN__
// EXT_clip_control has no entry in Emscripten's GL library of this age: it is called on the context itself.
EM_JS(int, apeiron_clip_control_there, (), { return GLctx.getExtension("EXT_clip_control") ? 1 : 0; });
EM_JS(void, apeiron_clip_control, (int zeroToOne), {
    const extension = GLctx.getExtension("EXT_clip_control");
    if (extension) extension.clipControlEXT(0x8CA1, zeroToOne ? 0x935F : 0x935E);
});
#endif

void clipControl(bool zeroToOne) {
#ifdef __EMSCRIPTEN__
    apeiron_clip_control(zeroToOne ? 1 : 0);
#else
    const GLenum depth = zeroToOne ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE;
    if (epoxy_is_desktop_gl())
        glClipControl(GL_LOWER_LEFT, depth);
    else
        glClipControlEXT(GL_LOWER_LEFT, depth);
#endif
}

std::string shaderLog(GLuint shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetShaderInfoLog(shader, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

/// A software driver may be a whole picture behind with drawing, and keeps what it knows of all these triangles until
/// then: hundreds of bytes of each. Drawing goes on while the next part is prepared, but not more than that.
constexpr int kIndicesAtOnce = 3 * 16384;

/// Whether glClientWaitSync() may wait: a browser's does not.
constexpr bool waitsInClient() {
#ifdef __EMSCRIPTEN__
    return false;
#else
    return true;
#endif
}

/// Compiles into a program. @throws Error (Gpu) with mapped lines.
void attach(GLuint program, GLenum kind, const std::string& label, const ShaderSource& source) {
    const std::string text = "#version 300 es\nprecision highp float;\nprecision highp int;\n"
                             "precision highp sampler2D;\nprecision highp isampler2D;\n#line 1 0\n" +
                             source.text();
    const GLuint shader = glCreateShader(kind);
    const char* data = text.c_str();
    glShaderSource(shader, 1, &data, nullptr);
    glCompileShader(shader);
    GLint compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    const std::string log = compiled == GL_TRUE ? std::string() : shaderLog(shader);
    if (compiled == GL_TRUE) glAttachShader(program, shader);
    glDeleteShader(shader); // once no program has it any more
    if (compiled == GL_TRUE) return;
    nativeProblem();
    throw Error(ErrorKind::Gpu, fmt::format("'{}' does not compile: {}", label, source.mapLog(log)));
}

} // namespace

Buffer::Buffer(const Context& context, Kind kind, std::span<const std::byte> bytes, const std::string& label)
    : target_(kind == Kind::Vertices ? GL_ARRAY_BUFFER : GL_ELEMENT_ARRAY_BUFFER) {
    glGenBuffers(1, &name_);
    glBindVertexArray(0); // an index buffer's binding belongs to the vertex array
    glBindBuffer(target_, name_);
    glBufferData(target_, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
    try {
        context.check(("allocating " + label).c_str());
    } catch (...) {
        glDeleteBuffers(1, &name_);
        throw;
    }
}

Buffer::~Buffer() {
    if (name_ != 0) glDeleteBuffers(1, &name_);
}

Buffer::Buffer(Buffer&& other) noexcept : name_(std::exchange(other.name_, 0)), target_(other.target_) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(target_, other.target_);
    return *this;
}

void Buffer::upload(std::span<const std::byte> bytes) {
    glBindVertexArray(0);
    glBindBuffer(target_, name_);
    glBufferData(target_, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
}

DepthTargets::DepthTargets(const Context& context, const std::vector<const Texture*>& textures)
    : textures_(static_cast<int>(textures.size())) {
    assert(!textures.empty() && textures.size() <= 4);
    size_ = textures.front()->size();
    glGenFramebuffers(1, &framebuffer_);
    glGenRenderbuffers(1, &depth_);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, size_.x, size_.y);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    std::vector<GLenum> buffers;
    for (const Texture* texture : textures) {
        assert(texture->size() == size_);
        const auto attachment = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size());
        glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture->name(), 0);
        buffers.push_back(attachment);
    }
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        glDeleteFramebuffers(1, &framebuffer_);
        glDeleteRenderbuffers(1, &depth_);
        throw Error(ErrorKind::Gpu, fmt::format("the driver refuses a framebuffer with depth (0x{:04x})", status),
                    context.capabilities().renderer);
    }
}

DepthTargets::~DepthTargets() {
    if (framebuffer_ != 0) glDeleteFramebuffers(1, &framebuffer_);
    if (depth_ != 0) glDeleteRenderbuffers(1, &depth_);
}

DepthTargets::DepthTargets(DepthTargets&& other) noexcept
    : framebuffer_(std::exchange(other.framebuffer_, 0)), depth_(std::exchange(other.depth_, 0)),
      textures_(other.textures_), size_(other.size_) {}

DepthTargets& DepthTargets::operator=(DepthTargets&& other) noexcept {
    std::swap(framebuffer_, other.framebuffer_);
    std::swap(depth_, other.depth_);
    std::swap(textures_, other.textures_);
    std::swap(size_, other.size_);
    return *this;
}

void DepthTargets::clear(glm::vec4 value, bool reversed) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    for (int i = 0; i < textures_; ++i)
        glClearBufferfv(GL_COLOR, i, &value.x);
    clearDepth(reversed);
}

void DepthTargets::clearDepth(bool reversed) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    const float far = reversed ? 0.0F : 1.0F;
    glClearBufferfv(GL_DEPTH, 0, &far);
}

bool canReverseDepth([[maybe_unused]] const Context& context) {
#ifdef __EMSCRIPTEN__
    return apeiron_clip_control_there() != 0;
#else
    // Desktop GL has it from 4.5 on, or as an extension.
    return context.capabilities().es ? epoxy_has_gl_extension("GL_EXT_clip_control")
                                     : epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
#endif
}

Raster::Raster(const Context& context, const std::string& label, const ShaderSource& vertex,
               const ShaderSource& fragment, std::vector<Attribute> attributes)
    : inParts_(waitsInClient() && context.capabilities().software), program_(glCreateProgram()),
      attributes_(std::move(attributes)) {
    try {
        attach(program_, GL_VERTEX_SHADER, label, vertex);
        attach(program_, GL_FRAGMENT_SHADER, label, fragment);
        glLinkProgram(program_);
        GLint linked = 0;
        glGetProgramiv(program_, GL_LINK_STATUS, &linked);
        if (linked != GL_TRUE) {
            GLint length = 0;
            glGetProgramiv(program_, GL_INFO_LOG_LENGTH, &length);
            std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
            glGetProgramInfoLog(program_, length, &length, log.data());
            log.resize(static_cast<std::size_t>(std::max(length, 0)));
            nativeProblem();
            throw Error(ErrorKind::Gpu, fmt::format("'{}' does not link: {}", label, log));
        }
        context.check(("compiling " + label).c_str());
    } catch (...) {
        glDeleteProgram(program_);
        throw;
    }
#ifndef __EMSCRIPTEN__
    if (!context.capabilities().es)
        glObjectLabel(GL_PROGRAM, program_, static_cast<GLsizei>(label.size()), label.data());
#endif
    for (const Attribute& attribute : attributes_)
        places_.push_back(glGetAttribLocation(program_, attribute.name));
    glGenVertexArrays(1, &vertexArray_);
}

Raster::~Raster() {
    for (void* part : parts_)
        glDeleteSync(static_cast<GLsync>(part)); // null is ignored
    glDeleteProgram(program_);
    glDeleteVertexArrays(1, &vertexArray_);
}

int Raster::location(const char* name) {
    glUseProgram(program_);
    const auto [it, isNew] = locations_.try_emplace(name, -1);
    if (isNew) it->second = glGetUniformLocation(program_, name);
    return it->second;
}

void Raster::set(const char* name, int value) {
    glUniform1i(location(name), value);
}
void Raster::set(const char* name, float value) {
    glUniform1f(location(name), value);
}
void Raster::set(const char* name, glm::vec2 value) {
    glUniform2f(location(name), value.x, value.y);
}
void Raster::set(const char* name, glm::vec3 value) {
    glUniform3f(location(name), value.x, value.y, value.z);
}
void Raster::set(const char* name, glm::vec4 value) {
    glUniform4f(location(name), value.x, value.y, value.z, value.w);
}
void Raster::set(const char* name, const glm::mat3& value) {
    glUniformMatrix3fv(location(name), 1, GL_FALSE, &value[0].x);
}

void Raster::set(const char* name, const Texture& texture) {
    const int where = location(name);
    if (where < 0) return;
    const auto [it, isNew] = samplers_.try_emplace(where, Sampler{static_cast<int>(samplers_.size()), texture.name()});
    it->second.texture = texture.name();
    if (isNew) glUniform1i(where, it->second.unit);
}

void Raster::draw(const DepthTargets& targets, const Mesh& mesh, int first, int count, Depth depth) {
    if (count <= 0) return;
    glUseProgram(program_);
    for (const auto& [where, sampler] : samplers_) {
        glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + sampler.unit));
        glBindTexture(GL_TEXTURE_2D, sampler.texture);
    }
    glActiveTexture(GL_TEXTURE0);
    glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer());
    glViewport(0, 0, targets.size().x, targets.size().y);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    const bool reversed = depth == Depth::Reversed;
    glDepthFunc(reversed ? GL_GREATER : GL_LESS);
    if (reversed) clipControl(true);

    glBindVertexArray(vertexArray_);
    const int each = inParts_ ? std::max(1, kIndicesAtOnce / std::max(mesh.indexCount, 1)) : count;
    for (int part = 0; part < count; part += each) {
        drawPart(mesh, first + part, std::min(each, count - part));
        if (inParts_) waitForParts();
    }
    glBindVertexArray(0);

    if (reversed) clipControl(false);
    glDisable(GL_DEPTH_TEST);
}

void Raster::waitForParts() {
    constexpr GLuint64 kForever = 10'000'000'000; // [ns]
    const auto before = static_cast<GLsync>(std::exchange(parts_[0], parts_[1]));
    parts_[1] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    if (before == nullptr) return;
    glClientWaitSync(before, 0, kForever);
    glDeleteSync(before);
}

void Raster::drawPart(const Mesh& mesh, int first, int count) {
    for (std::size_t i = 0; i < attributes_.size(); ++i) {
        if (places_[i] < 0) continue;
        const Attribute& a = attributes_[i];
        const auto place = static_cast<GLuint>(places_[i]);
        const std::size_t stride = a.perInstance ? mesh.instanceBytes : mesh.vertexBytes;
        // ES 3.0 has no first instance: the pointer begins there.
        const std::size_t offset = a.offset + (a.perInstance ? static_cast<std::size_t>(first) * stride : 0);
        const auto* pointer = reinterpret_cast<const void*>(offset); // NOLINT: what GL calls a pointer is an offset
        glBindBuffer(GL_ARRAY_BUFFER, a.perInstance ? mesh.instances.name() : mesh.vertices.name());
        glEnableVertexAttribArray(place);
        glVertexAttribDivisor(place, a.perInstance ? 1 : 0);
        if (a.integers)
            glVertexAttribIPointer(place, a.components, GL_INT, static_cast<GLsizei>(stride), pointer);
        else
            glVertexAttribPointer(place, a.components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), pointer);
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.name());
    glDrawElementsInstanced(mesh.lines ? GL_LINES : GL_TRIANGLES, mesh.indexCount, GL_UNSIGNED_SHORT, nullptr, count);
}

} // namespace apeiron::gpu
