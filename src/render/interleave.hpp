#pragma once

#include "core/math.hpp"

#include <array>
#include <vector>

namespace apeiron::render {

/// The order in which the k x k interleaved sub-images of a picture are computed, so that every prefix covers it
/// evenly: after 4^j of them, each 2^(log2 k - j) th pixel of both axes is there (Bayer's order, 1973).
class Interleave {
  public:
    /// @pre factor is 1, 2, 4 or 8
    explicit Interleave(int factor);

    int factor() const { return factor_; }
    /// log2 of the factor.
    int shift() const { return factor_ == 8 ? 3 : factor_ / 2; }
    int count() const { return factor_ * factor_; }
    /// The pixel offset of the i-th sub-image.
    glm::ivec2 offset(int i) const { return offsets_[static_cast<std::size_t>(i)]; }
    /// Position in the order of the sub-image at offset (x, y), at [y * 8 + x].
    const std::array<int, 64>& ranks() const { return ranks_; }

    /// Size of one sub-image of a picture (the last ones may reach beyond it).
    glm::ivec2 block(glm::ivec2 size) const { return (size + factor_ - 1) / factor_; }

  private:
    int factor_;
    std::vector<glm::ivec2> offsets_;
    std::array<int, 64> ranks_{};
};

} // namespace apeiron::render
