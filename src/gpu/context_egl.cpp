#include "gpu/context.hpp"
#include "gpu/context_native.hpp"
#include "gpu/gl.hpp"

#include <epoxy/egl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <utility>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace apeiron::gpu {
namespace {

/// Extension functions are fetched by hand: a loader's dispatch asks the current display, and there is none yet.
template <class Function> Function eglFunction(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool contains(const char* extensions, const char* name) {
    return extensions != nullptr && std::strstr(extensions, name) != nullptr;
}

/// A display to try: an EGL device, or Mesa's surfaceless platform.
struct Candidate {
    EGLDeviceEXT device = nullptr; ///< null: the surfaceless platform
    bool software = false;
};

std::vector<Candidate> candidates() {
    std::vector<Candidate> found;
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (contains(client, "EGL_EXT_platform_device") || contains(client, "EGL_EXT_device_base") ||
        contains(client, "EGL_EXT_device_enumeration")) {
        const auto queryDevices = eglFunction<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
        const auto queryString = eglFunction<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
        EGLint count = 0;
        if (queryDevices != nullptr && queryDevices(0, nullptr, &count) == EGL_TRUE && count > 0) {
            std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
            queryDevices(count, devices.data(), &count);
            devices.resize(static_cast<std::size_t>(count));
            for (EGLDeviceEXT device : devices) {
                const char* extensions = queryString != nullptr ? queryString(device, EGL_EXTENSIONS) : nullptr;
                found.push_back({device, contains(extensions, "EGL_MESA_device_software")});
            }
        }
    }
    std::stable_partition(found.begin(), found.end(), [](const Candidate& c) { return !c.software; });
    const bool hasSoftware = !found.empty() && found.back().software;
    if (contains(client, "EGL_MESA_platform_surfaceless") && !hasSoftware) found.push_back({nullptr, true});
    return found;
}

// What the driver's debug callback said last; a context reports it at its next check().
std::mutex messageMutex;
std::string debugMessage;

void onDebugMessage(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity, GLsizei /*length*/,
                    const GLchar* message, const void* /*user*/) {
    if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
    const std::lock_guard lock(messageMutex);
    if (debugMessage.empty()) debugMessage = message;
}

std::string eglError() {
    const EGLint code = eglGetError();
    switch (code) {
    case EGL_NOT_INITIALIZED:
        return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ALLOC:
        return "EGL_BAD_ALLOC";
    case EGL_BAD_MATCH:
        return "EGL_BAD_MATCH";
    case EGL_BAD_DISPLAY:
        return "EGL_BAD_DISPLAY";
    case EGL_SUCCESS:
        return "no driver";
    default:
        return fmt::format("EGL error 0x{:04x}", code);
    }
}

} // namespace

struct Context::Native {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

    ~Native() {
        if (context == EGL_NO_CONTEXT) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, context);
        // The display stays initialised: others of this process may use the same one.
    }

    /// Opens the display and makes a context current on it; says why not otherwise.
    std::string open(const Candidate& candidate, bool debug) {
        const auto platformDisplay = eglFunction<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
        if (platformDisplay == nullptr) return "EGL_EXT_platform_base is missing";
        display = candidate.device != nullptr
                      ? platformDisplay(EGL_PLATFORM_DEVICE_EXT, candidate.device, nullptr)
                      : platformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display == EGL_NO_DISPLAY) return "no display: " + eglError();
        EGLint major = 0;
        EGLint minor = 0;
        if (eglInitialize(display, &major, &minor) != EGL_TRUE) return "cannot initialise: " + eglError();
        const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
        if (!contains(extensions, "EGL_KHR_surfaceless_context")) return "EGL_KHR_surfaceless_context is missing";
        const bool robust = contains(extensions, "EGL_EXT_create_context_robustness") || (major > 1 || minor >= 5);

        struct Version {
            EGLenum api;
            EGLint major;
            EGLint minor;
        };
        for (const Version v : {Version{EGL_OPENGL_API, 4, 5}, Version{EGL_OPENGL_API, 4, 3},
                                Version{EGL_OPENGL_ES_API, 3, 1}, Version{EGL_OPENGL_ES_API, 3, 0}}) {
            const bool es = v.api == EGL_OPENGL_ES_API;
            if (eglBindAPI(v.api) != EGL_TRUE) continue;
            EGLConfig config = nullptr;
            EGLint count = 0;
            const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE,
                                               es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
            if (eglChooseConfig(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count == 0) {
                config = EGL_NO_CONFIG_KHR;
            }
            for (const bool withReset : {true, false}) {
                if (withReset && !robust) continue;
                std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION, v.major, EGL_CONTEXT_MINOR_VERSION, v.minor};
                if (!es) {
                    attributes.insert(attributes.end(),
                                      {EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT});
                }
                if (withReset) {
                    attributes.insert(attributes.end(),
                                      {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
                }
                if (debug) attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
                attributes.push_back(EGL_NONE);
                context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
                if (context != EGL_NO_CONTEXT) break;
            }
            if (context == EGL_NO_CONTEXT) continue;
            if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
                return "cannot make the context current: " + eglError();
            }
            return {};
        }
        return "no OpenGL 4.3 or OpenGL ES 3.0: " + eglError();
    }
};

Context::Context() = default;
Context::~Context() = default;

std::vector<Device> Context::devices() {
    std::vector<Device> devices;
    for (const Candidate& candidate : candidates()) {
        Device device;
        device.index = static_cast<int>(devices.size());
        device.software = candidate.software;
        Native native;
        device.problem = native.open(candidate, false);
        device.usable = device.problem.empty();
        if (device.usable) {
            device.name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
            device.driver = reinterpret_cast<const char*>(glGetString(GL_VERSION));
            device.software = isSoftwareRenderer(device.name);
        } else {
            device.name = candidate.software ? "software device" : "hardware device";
        }
        devices.push_back(device);
    }
    return devices;
}

namespace {

/// A driver that renders on the CPU takes memory for every picture's triangles, tens of megabytes in small pieces, and
/// frees it. An allocator that gives that back to the system each time has the processor fetch, and clear, every page
/// of it anew: half of the time of a terrain's picture.
void keepFreedMemory() {
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, 256 << 20);
    // Setting one fixes the other, which would have risen to this with the sizes that are used.
    mallopt(M_MMAP_THRESHOLD, 8 << 20);
#endif
}

} // namespace

std::unique_ptr<Context> Context::create(const ContextOptions& options) {
    const std::vector<Candidate> all = candidates();
    if (all.empty()) {
        throw Error(ErrorKind::NoContext, "no EGL device on this machine", {},
                    "install a GPU driver, or Mesa's software one (Debian: libegl-mesa0 libgl1-mesa-dri)");
    }
    if (options.device >= static_cast<int>(all.size())) {
        throw Error(ErrorKind::BadInput, fmt::format("no device {}", options.device), "--device",
                    fmt::format("there are {}; see 'apeiron list devices'", all.size()));
    }
    std::string problems;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (options.device >= 0 && static_cast<std::size_t>(options.device) != i) continue;
        std::unique_ptr<Context> context(new Context);
        context->native_ = std::make_unique<Native>();
        const std::string problem = context->native_->open(all[i], options.debug);
        if (!problem.empty()) {
            problems += fmt::format("{}device {}: {}", problems.empty() ? "" : "; ", i, problem);
            continue;
        }
        try {
            context->readCapabilities();
        } catch (const Error& error) {
            if (options.device >= 0) throw;
            problems += fmt::format("{}device {}: {}", problems.empty() ? "" : "; ", i, error.what());
            continue;
        }
        if (context->capabilities_.software) keepFreedMemory();
        if (options.debug) {
            glEnable(GL_DEBUG_OUTPUT);
            glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
            glDebugMessageCallback(onDebugMessage, nullptr);
        }
        return context;
    }
    throw Error(ErrorKind::NoContext, "no usable GPU context", {}, problems);
}

std::unique_ptr<Context> Context::adopt() {
    std::unique_ptr<Context> context(new Context);
    context->readCapabilities();
    return context;
}

void Context::makeCurrent() const {
    if (native_ == nullptr) return;
    if (eglMakeCurrent(native_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, native_->context) != EGL_TRUE) {
        throw Error(ErrorKind::Gpu, "cannot make the context current: " + eglError(), capabilities_.renderer);
    }
}

std::string nativeProblem() {
    if (epoxy_is_desktop_gl() && epoxy_gl_version() >= 45 && glGetGraphicsResetStatus() != GL_NO_ERROR) {
        return "the GPU was reset and the context is lost";
    }
    const std::lock_guard lock(messageMutex);
    return std::exchange(debugMessage, {});
}

} // namespace apeiron::gpu
