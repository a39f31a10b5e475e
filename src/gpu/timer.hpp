#pragma once

#include "gpu/context.hpp"

namespace apeiron::gpu {

/// Measures how long the GPU works on what is submitted between start() and stop(). Needs its context current.
/// Does nothing where the context has no timers.
class Timer {
  public:
    explicit Timer(const Context& context);
    ~Timer();
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    void start() const;
    void stop() const;
    /// Milliseconds of the last pair, after the work has finished (waits for it); 0 without timers.
    double milliseconds() const;

  private:
    unsigned query_ = 0;
};

} // namespace apeiron::gpu
