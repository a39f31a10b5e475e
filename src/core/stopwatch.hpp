#pragma once

#include <chrono>
#include <ctime>
#include <map>
#include <string>

namespace apeiron {

/// Seconds since it was made, by a clock that never goes back.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Where the time went: wall, processor (all threads, user and system) and GPU milliseconds per named phase.
struct Phases {
    struct Times {
        double wallMs = 0.0;
        double cpuMs = 0.0;
        double gpuMs = 0.0; ///< 0 where the device has no timers
    };
    std::map<std::string, Times> times;

    /// Adds the time until it goes out of scope to a phase.
    class Scope {
      public:
        Scope(Phases& phases, const std::string& name) : times_(phases.times[name]) {}
        ~Scope() {
            times_.wallMs += 1e3 * watch_.seconds();
            times_.cpuMs += 1e3 * static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC;
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        Times& times() { return times_; }

      private:
        Times& times_;
        Stopwatch watch_;
        std::clock_t cpu_ = std::clock();
    };
};

} // namespace apeiron
