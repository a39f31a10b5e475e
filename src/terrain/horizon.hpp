#pragma once

#include "core/math.hpp"

#include <array>

namespace apeiron::terrain {

/// What ground that was drawn hides of what is behind it, by directions around the camera. Conservative: it may show
/// what is hidden, and never hides what is seen.
class Horizon {
  public:
    Horizon();
    /// Whether all of a box [from the camera, z up] is below what is known to be ground before it.
    bool hides(const glm::dvec3& least, const glm::dvec3& most) const;
    /// All ground in the box is at least as high as its bottom. Boxes come from near to far.
    void add(const glm::dvec3& least, const glm::dvec3& most);

  private:
    static constexpr int kDirections = 512;
    std::array<float, kDirections> slopes_{}; ///< below these all rays meet the ground
};

} // namespace apeiron::terrain
