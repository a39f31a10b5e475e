#pragma once

#include "scene/scene.hpp"

namespace apeiron::render {

/// Where samples lie that are drawn, not traced: one place in the pixel and one on the lens for all pixels, by the R2
/// sequence (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"). A sample's place depends on its
/// number and the scene's seed alone.
class SharedPoints {
  public:
    SharedPoints() = default;
    explicit SharedPoints(const scene::Scene& scene);

    /// From the pixel's centre [px], in proportion to the camera's filter.
    glm::vec2 shift(std::uint32_t sample) const;
    /// On the lens of radius 1, uniform.
    glm::vec2 lens(std::uint32_t sample) const;

  private:
    int filter_ = 0;
    int blades_ = 0;
    glm::dvec4 start_{0.5};
};

} // namespace apeiron::render
