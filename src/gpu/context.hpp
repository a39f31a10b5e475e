#pragma once

#include "core/error.hpp"

#include <memory>
#include <string>
#include <vector>

namespace apeiron::gpu {

/// A device that a headless context can be made on.
struct Device {
    int index = 0;         ///< what `--device` takes
    std::string name;      ///< GL_RENDERER
    std::string driver;    ///< GL_VERSION
    bool software = false; ///< renders on the CPU
    bool usable = false;   ///< a context could be made
    std::string problem;   ///< why not, when not usable
};

/// What the current context can do.
struct Capabilities {
    std::string renderer;
    std::string version;
    bool es = false; ///< OpenGL ES or WebGL
    bool web = false;
    bool software = false;       ///< llvmpipe, softpipe, SwiftShader
    bool compute = false;        ///< compute kernels (GL >= 4.3 or ES >= 3.1)
    bool timers = false;         ///< GPU timer queries
    bool floatTargets = false;   ///< 32-bit float colour targets
    bool floatFiltering = false; ///< interpolation of 32-bit float textures
    int maxTextureSize = 0;      ///< [texels]
    int maxTextureSize3D = 0;    ///< of each side [texels]
    int maxDrawBuffers = 0;
};

struct ContextOptions {
    int device = -1;    ///< an index of Context::devices(); -1: the first hardware device, else Mesa's software one
    bool debug = false; ///< driver debug messages; a high-severity one becomes an Error at the next check()
};

/// A GL context and the display it lives on. One is current per thread; every object of gpu/ belongs to the
/// context that was current when it was made, and must die before it.
class Context {
  public:
    /// The EGL devices of this machine, software ones last. Empty where there is no EGL, and in the browser.
    static std::vector<Device> devices();

    /// A headless context, made current. @throws Error (NoContext) that lists what was tried.
    static std::unique_ptr<Context> create(const ContextOptions& options = {});

    /// Uses the context that is current now and belongs to someone else: a browser's, a window's.
    /// @throws Error (NoContext) when it lacks what the engine needs (ES 3.0, float targets).
    static std::unique_ptr<Context> adopt();

    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    const Capabilities& capabilities() const { return capabilities_; }

    /// Makes it current on this thread (nothing to do for an adopted one).
    void makeCurrent() const;

    /// Waits until the GPU has done all that was submitted. @throws as check().
    void finish() const;

    /// @throws Error (Gpu) when the context was lost, memory ran out, or a GL error is pending; `doing` says at what.
    void check(const char* doing) const;

  private:
    Context();
    void readCapabilities();

    struct Native;
    std::unique_ptr<Native> native_;
    Capabilities capabilities_;
};

} // namespace apeiron::gpu
