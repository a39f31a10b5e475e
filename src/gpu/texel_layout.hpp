#pragma once

#include "gpu/gl.hpp"

#include <string>

namespace apeiron::gpu {

/// A texel format in GL's terms. For .cpp files of gpu/ only.
struct TexelLayout {
    GLenum internal;
    GLenum format;
    GLenum type;
    int channels;
    int bytes; ///< of one texel in the format's own type
};

/// Names a GL object in debuggers' lists, where there is such a thing.
inline void setLabel([[maybe_unused]] GLenum kind, [[maybe_unused]] GLuint name,
                     [[maybe_unused]] const std::string& label) {
#ifndef __EMSCRIPTEN__
    if (epoxy_is_desktop_gl()) glObjectLabel(kind, name, static_cast<GLsizei>(label.size()), label.data());
#endif
}

} // namespace apeiron::gpu
