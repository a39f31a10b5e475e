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

/// Hands out a picture's texels in rectangles of at most a given number: band by band, and within a band column by
/// column. Small rectangles are compact that way, and begin and end where a rasteriser's blocks do: a strip of few rows
/// is computed in blocks, too.
class TileCursor {
  public:
    static constexpr int kBand = 8; ///< rows of a band; the last one may have fewer

    /// @param first the band of this row comes first; those before it come last
    explicit TileCursor(glm::ivec2 size, int first = 0) : size_(size), first_(first % size.y / kBand * kBand) {}
    bool done() const { return next_ >= total(); }
    std::int64_t taken() const { return next_; }
    std::int64_t left() const { return total() - next_; }
    int first() const { return first_; } ///< row
    /// The first row, cyclically, of the bands that nothing was taken from.
    int fresh() const;
    /// The next rectangle of at most `texels`: whole bands when they fit, else part of one. @pre !done(), texels >= 1
    gpu::Region take(std::int64_t texels);

  private:
    std::int64_t total() const { return static_cast<std::int64_t>(size_.x) * size_.y; }
    /// The index of the next texel, counted from row 0.
    std::int64_t index() const { return (static_cast<std::int64_t>(first_) * size_.x + next_) % total(); }
    glm::ivec2 size_;
    int first_;
    std::int64_t next_ = 0;
};

} // namespace apeiron::render
