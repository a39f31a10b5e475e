#include "gpu/context.hpp"

#include "gpu/context_native.hpp"
#include "gpu/gl.hpp"
#ifdef __EMSCRIPTEN__
#include <emscripten/html5.h>
#endif

#include <fmt/format.h>

#include <cstring>

namespace apeiron::gpu {
namespace {

std::string glString(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text != nullptr ? text : "";
}

int glInteger(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

/// Float colour targets are optional in ES and WebGL: ask the driver with a real one.
bool canRenderToFloat() {
    GLuint texture = 0;
    GLuint framebuffer = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32F, 4, 4);
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteTextures(1, &texture);
    while (glGetError() != GL_NO_ERROR) {
    }
    return complete;
}

} // namespace

bool isSoftwareRenderer(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "SwiftShader", "Software Rasterizer"}) {
        if (renderer.find(name) != std::string::npos) return true;
    }
    return false;
}

void Context::readCapabilities() {
    Capabilities& c = capabilities_;
    c.renderer = glString(GL_RENDERER);
    c.version = glString(GL_VERSION);
    c.software = isSoftwareRenderer(c.renderer);
    c.maxTextureSize = glInteger(GL_MAX_TEXTURE_SIZE);
    c.maxTextureSize3D = glInteger(GL_MAX_3D_TEXTURE_SIZE);
    c.maxDrawBuffers = glInteger(GL_MAX_DRAW_BUFFERS);
#ifdef __EMSCRIPTEN__
    // Browsers give the device's real name (UNMASKED_RENDERER_WEBGL) only where WEBGL_debug_renderer_info is on.
    if (const std::string device = glString(0x9246); !device.empty()) c.renderer = device;
    c.software = isSoftwareRenderer(c.renderer);
    c.es = true;
    c.web = true;
    c.floatFiltering =
        emscripten_webgl_enable_extension(emscripten_webgl_get_current_context(), "OES_texture_float_linear");
#else
    c.es = !epoxy_is_desktop_gl();
    const int version = epoxy_gl_version();
    if (version < (c.es ? 30 : 43)) {
        throw Error(ErrorKind::NoContext, fmt::format("{} offers {} only", c.renderer, c.version), {},
                    "OpenGL 4.3 or OpenGL ES 3.0 is needed");
    }
    c.compute = version >= (c.es ? 31 : 43);
    c.timers = !c.es;
    c.floatFiltering = !c.es || epoxy_has_gl_extension("GL_OES_texture_float_linear");
#endif
    c.floatTargets = canRenderToFloat();
    if (!c.floatTargets) {
        throw Error(ErrorKind::NoContext, fmt::format("{} cannot render to 32-bit float textures", c.renderer), {},
                    "EXT_color_buffer_float is needed");
    }
}

void Context::finish() const {
#ifdef __EMSCRIPTEN__
    // A browser's glFinish does not wait; reading a pixel back does.
    std::uint8_t pixel[4];
    GLint bound = 0;
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound);
    GLint type = GL_UNSIGNED_BYTE;
    glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &type);
    if (bound == 0) {
        glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    } else {
        float texel[4];
        glReadBuffer(GL_COLOR_ATTACHMENT0);
        glReadPixels(0, 0, 1, 1, GL_RGBA, type == GL_UNSIGNED_BYTE ? GL_UNSIGNED_BYTE : GL_FLOAT, texel);
    }
#else
    glFinish();
#endif
    check("rendering");
}

void Context::check(const char* doing) const {
    if (const std::string problem = nativeProblem(); !problem.empty()) {
        throw Error(ErrorKind::Gpu, fmt::format("{} while {}", problem, doing), capabilities_.renderer,
                    "start again; try another --device or a smaller size");
    }
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    while (glGetError() != GL_NO_ERROR) {
    }
    if (error == GL_OUT_OF_MEMORY) {
        throw Error(ErrorKind::Gpu, fmt::format("out of GPU memory while {}", doing), capabilities_.renderer,
                    "choose a smaller size");
    }
    throw Error(ErrorKind::Gpu, fmt::format("OpenGL error 0x{:04x} while {}", error, doing), capabilities_.renderer);
}

} // namespace apeiron::gpu
