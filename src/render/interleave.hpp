#pragma once

#include "core/math.hpp"

#include <array>
#include <vector>

namespace apeiron::render {

/// The order in which the k x k interleaved sub-images of a picture are computed. Every prefix covers the picture
/// evenly: each next one is where the pixels are that are farthest from all computed ones (farthest-point order on the
/// torus, Eldar et al. 1997), which for powers of two visits the same lattices as Bayer's order (1973).
class Interleave {
  public:
    static constexpr int kMost = 8; ///< the largest factor

    /// @param first the place in the order where it begins, cyclically: successive pictures then begin with other
    /// pixels
    /// @pre 1 <= factor <= kMost
    explicit Interleave(int factor, int first = 0);

    int factor() const { return factor_; }
    int count() const { return factor_ * factor_; }
    int first() const { return first_; }
    /// The pixel offset of the i-th sub-image.
    glm::ivec2 offset(int i) const { return offsets_[static_cast<std::size_t>((i + first_) % count())]; }

    /// For a pixel at offset (x, y) of its k x k cell, at [y * 8 + x]: the step (dx, dy) to the nearest pixel of the
    /// first `done` sub-images, as (dy + 8) * 16 + dx + 8. @pre done >= 1
    std::array<int, kMost * kMost> nearest(int done) const;

    /// Size of one sub-image of a picture (the last ones may reach beyond it).
    glm::ivec2 block(glm::ivec2 size) const { return (size + factor_ - 1) / factor_; }

  private:
    int factor_;
    int first_;
    std::vector<glm::ivec2> offsets_;
};

} // namespace apeiron::render
