#include "gpu/timer.hpp"

#include "gpu/gl.hpp"

namespace apeiron::gpu {

#ifdef __EMSCRIPTEN__
Timer::Timer(const Context& /*context*/) {}
Timer::~Timer() = default;
void Timer::start() const {}
void Timer::stop() const {}
double Timer::milliseconds() const {
    return static_cast<double>(query_);
}
#else
Timer::Timer(const Context& context) {
    if (context.capabilities().timers) glGenQueries(1, &query_);
}

Timer::~Timer() {
    if (query_ != 0) glDeleteQueries(1, &query_);
}

void Timer::start() const {
    if (query_ != 0) glBeginQuery(GL_TIME_ELAPSED, query_);
}

void Timer::stop() const {
    if (query_ != 0) glEndQuery(GL_TIME_ELAPSED);
}

double Timer::milliseconds() const {
    if (query_ == 0) return 0.0;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query_, GL_QUERY_RESULT, &nanoseconds);
    return 1e-6 * static_cast<double>(nanoseconds);
}
#endif

} // namespace apeiron::gpu
