#pragma once

#include "core/stopwatch.hpp"

#include <cstdint>
#include <string>

namespace apeiron::cli {

/// How far a rendering is.
struct Progress {
    double samples = 0.0;   ///< samples done, with a fraction for the one in progress
    std::int64_t total = 0; ///< samples wanted; 0: no such goal
    double seconds = 0.0;   ///< spent so far [s]
    double timeLimit = 0.0; ///< [s]; 0: none
};

/// One line on stderr that is drawn over and over while it is a terminal; silent otherwise.
class ProgressBar {
  public:
    /// @param quiet never show anything
    explicit ProgressBar(bool quiet);
    /// Clears the line.
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Draws, but not more often than can be seen.
    void update(const Progress& progress);

    /// The line as it is drawn, at most `width` columns wide.
    static std::string line(const Progress& progress, int width);

  private:
    bool shown_;
    bool drawn_ = false;
    Stopwatch watch_;
    double next_ = 0.2; ///< quick renderings end before anything flashes up [s]
};

} // namespace apeiron::cli
