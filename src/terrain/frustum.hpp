#pragma once

#include "core/math.hpp"

#include <algorithm>
#include <array>

namespace apeiron::terrain {

/// As std::max(), but of values: compilers make one instruction of it, also for several numbers at once.
constexpr double larger(double a, double b) {
    return a > b ? a : b;
}

struct Box {
    glm::dvec3 least{0.0}; ///< from the camera [world]
    glm::dvec3 most{0.0};
};

/// Four boxes, each coordinate in a row of its own: compilers make vector instructions of that.
struct Boxes {
    using Row = std::array<double, 4>;
    std::array<Row, 3> least; ///< x, y, z
    std::array<Row, 3> most;

    Box operator[](std::size_t i) const {
        return {{least[0][i], least[1][i], least[2][i]}, {most[0][i], most[1][i], most[2][i]}};
    }
    void set(std::size_t i, const Box& box) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            least[axis][i] = box.least[static_cast<int>(axis)];
            most[axis][i] = box.most[static_cast<int>(axis)];
        }
    }
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
    /// The same of four boxes.
    std::array<unsigned, 4> sees(const Boxes& boxes, unsigned planes) const {
        std::array<unsigned, 4> seen{planes, planes, planes, planes};
        for (unsigned i = 0; i < normals_.size(); ++i) {
            if ((planes >> i & 1U) == 0) continue;
            const glm::dvec3& n = normals_[i];
            // The corners that are farthest along the normal, and against it.
            const auto rowOf = [&](int axis, bool along) -> const Boxes::Row& {
                const auto a = static_cast<std::size_t>(axis);
                return (n[axis] > 0.0) == along ? boxes.most[a] : boxes.least[a];
            };
            Boxes::Row high{};
            Boxes::Row low{};
            const Boxes::Row& hx = rowOf(0, true);
            const Boxes::Row& hy = rowOf(1, true);
            const Boxes::Row& hz = rowOf(2, true);
            const Boxes::Row& lx = rowOf(0, false);
            const Boxes::Row& ly = rowOf(1, false);
            const Boxes::Row& lz = rowOf(2, false);
            for (std::size_t k = 0; k < 4; ++k) {
                high[k] = n.x * hx[k] + n.y * hy[k] + n.z * hz[k];
                low[k] = n.x * lx[k] + n.y * ly[k] + n.z * lz[k];
            }
            for (std::size_t k = 0; k < 4; ++k) {
                if (high[k] < 0.0) seen[k] = kOutside;
                if (low[k] >= 0.0) seen[k] &= ~(1U << i);
            }
        }
        return seen;
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
