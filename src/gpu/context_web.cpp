#include "gpu/context.hpp"
#include "gpu/context_native.hpp"

#include <emscripten/html5.h>

namespace apeiron::gpu {

struct Context::Native {};

Context::Context() = default;
Context::~Context() = default;

std::vector<Device> Context::devices() {
    return {};
}

std::unique_ptr<Context> Context::create(const ContextOptions& /*options*/) {
    throw Error(ErrorKind::NoContext, "a browser's context is made by the page", {}, "hand it over and adopt it");
}

std::unique_ptr<Context> Context::adopt() {
    if (emscripten_webgl_get_current_context() == 0) {
        throw Error(ErrorKind::NoContext, "no WebGL 2 context is current");
    }
    std::unique_ptr<Context> context(new Context);
    context->readCapabilities();
    return context;
}

void Context::makeCurrent() const {}

std::string nativeProblem() {
    const EMSCRIPTEN_WEBGL_CONTEXT_HANDLE handle = emscripten_webgl_get_current_context();
    return emscripten_is_webgl_context_lost(handle) ? "the WebGL context was lost" : "";
}

} // namespace apeiron::gpu
