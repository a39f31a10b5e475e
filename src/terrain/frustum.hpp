#pragma once

#include "core/math.hpp"

#include <algorithm>
#include <array>

namespace apeiron::terrain {

struct Box {
    glm::dvec3 least{0.0}; ///< from the camera [world]
    glm::dvec3 most{0.0};
};

/// The four planes of a view through the camera; normals point inside.
class Frustum {
  public:
    /// @param camera columns: right, up, backward in the world @param tangent of half the vertical field of view
    /// @param aspect width / height
    Frustum(const glm::dmat3& camera, double tangent, double aspect) {
        const double y = tangent;
        const double x = tangent * aspect;
        normals_ = {camera * glm::dvec3(1, 0, -x), camera * glm::dvec3(-1, 0, -x), camera * glm::dvec3(0, 1, -y),
                    camera * glm::dvec3(0, -1, -y)};
        corners_ = {camera * glm::dvec3(-x, -y, -1), camera * glm::dvec3(x, -y, -1), camera * glm::dvec3(-x, y, -1),
                    camera * glm::dvec3(x, y, -1)};
    }

    /// Planes that the box is not known to be inside of, as bits; kOutside: it is outside of one.
    /// @param planes likewise, of a box that this one is a part of
    unsigned sees(const Box& box, unsigned planes) const {
        for (unsigned i = 0; i < normals_.size(); ++i) {
            if ((planes >> i & 1U) == 0) continue;
            const glm::dvec3& n = normals_[i];
            const glm::dvec3 low = n * box.least;
            const glm::dvec3 high = n * box.most;
            if (std::max(low.x, high.x) + std::max(low.y, high.y) + std::max(low.z, high.z) < 0.0) return kOutside;
            if (std::min(low.x, high.x) + std::min(low.y, high.y) + std::min(low.z, high.z) >= 0.0)
                planes &= ~(1U << i);
        }
        return planes;
    }
    static constexpr unsigned kAll = 15;
    static constexpr unsigned kOutside = 16;

    /// Whether two views from one point may have a direction in common. Conservative: never wrongly false.
    bool meets(const Frustum& other) const { return !isApart(other) && !other.isApart(*this); }

  private:
    /// Whether all of the other is outside of one plane.
    bool isApart(const Frustum& other) const {
        return std::any_of(normals_.begin(), normals_.end(), [&](const glm::dvec3& n) {
            return std::all_of(other.corners_.begin(), other.corners_.end(),
                               [&](const glm::dvec3& c) { return glm::dot(n, c) < 0.0; });
        });
    }

    std::array<glm::dvec3, 4> normals_;
    std::array<glm::dvec3, 4> corners_; ///< directions
};

} // namespace apeiron::terrain
