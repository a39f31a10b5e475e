#pragma once

#include "gpu/kernel.hpp"

namespace apeiron::render {

/// Decides how much work to hand to the GPU at once, so that a step ends within its time budget and no submission
/// comes near a driver's watchdog (2 s on common systems). It knows nothing beforehand: it starts with little,
/// measures, and at most quadruples.
class Governor {
  public:
    /// No submission is meant to take longer than this [s].
    static constexpr double kMaxSubmission = 0.25;
    static constexpr std::int64_t kFirstPixels = 4096;

    /// How many pixels may be submitted now, when `remaining` seconds of the step are left; 0 when it is better to
    /// stop.
    /// @param mustWork nothing was done in this step yet: at least one pixel
    std::int64_t next(double remaining, bool mustWork) const;

    /// Reports that `pixels` took `seconds` until the GPU was done.
    void report(std::int64_t pixels, double seconds);

    /// The work changed in kind (another program, another place): forget what a pixel costs, start small.
    void restart();

    /// The highest recent cost of a pixel [s]; 0 before the first report.
    double costPerPixel() const { return cost_; }

  private:
    double cost_ = 0.0;     ///< of a pixel [s]
    double overhead_ = 0.0; ///< of a submission [s]
    std::int64_t limit_ = kFirstPixels;
};

/// Hands out a picture's texels in order, in rectangles of at most a given number.
class TileCursor {
  public:
    /// @param first row to begin with; the rows before it come last
    explicit TileCursor(glm::ivec2 size, int first = 0) : size_(size), first_(first % size.y) {}
    bool done() const { return next_ >= total(); }
    std::int64_t taken() const { return next_; }
    std::int64_t left() const { return total() - next_; }
    /// The row that the next rectangle is in or begins with, cyclically.
    int row() const { return static_cast<int>((first_ + next_ / size_.x) % size_.y); }
    int first() const { return first_; }
    /// The next rectangle of at most `texels`: whole rows when they fit, else part of one. @pre !done(), texels >= 1
    gpu::Region take(std::int64_t texels);

  private:
    std::int64_t total() const { return static_cast<std::int64_t>(size_.x) * size_.y; }
    glm::ivec2 size_;
    int first_;
    std::int64_t next_ = 0;
};

} // namespace apeiron::render
