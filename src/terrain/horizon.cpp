#include "terrain/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apeiron::terrain {
namespace {

/// Grows with the angle of (x, y), from 0 to 4: no trigonometry.
double diamondAngle(double x, double y) {
    const double p = y / (std::abs(x) + std::abs(y));
    const double angle = x < 0.0 ? 2.0 - p : p;
    return angle < 0.0 ? angle + 4.0 : angle;
}

struct Range {
    double first = 0.0; ///< [directions]; last - first < half of all
    double last = 0.0;
};

/// The directions in which a box's footprint is seen: from one of its corners to another one, counter-clockwise.
/// @pre the camera is outside of it
Range directionsOf(const glm::dvec3& least, const glm::dvec3& most, int directions) {
    const bool right = least.x > 0.0;
    const bool left = most.x < 0.0;
    const bool above = least.y > 0.0;
    const bool below = most.y < 0.0;
    const double besideX = right ? least.x : most.x;
    const double besideY = above ? least.y : most.y;
    const double first = diamondAngle(above   ? most.x
                                      : below ? least.x
                                              : besideX,
                                      right  ? least.y
                                      : left ? most.y
                                             : besideY);
    double last = diamondAngle(above ? least.x : below ? most.x : besideX, right ? most.y : left ? least.y : besideY);
    if (last < first) last += 4.0;
    const double scale = directions / 4.0;
    return {first * scale, last * scale};
}

bool isOutside(const glm::dvec3& least, const glm::dvec3& most) {
    return least.x > 0.0 || most.x < 0.0 || least.y > 0.0 || most.y < 0.0;
}

/// std::hypot takes ten times as long; these numbers neither overflow nor vanish.
double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

double nearest(const glm::dvec3& least, const glm::dvec3& most) {
    return length(std::max({0.0, least.x, -most.x}), std::max({0.0, least.y, -most.y}));
}
double farthest(const glm::dvec3& least, const glm::dvec3& most) {
    return length(std::max(std::abs(least.x), std::abs(most.x)), std::max(std::abs(least.y), std::abs(most.y)));
}

/// @pre the number of directions is a power of two
std::size_t wrapped(int direction, int directions) {
    return static_cast<unsigned>(direction) & static_cast<unsigned>(directions - 1);
}

} // namespace

Horizon::Horizon() {
    slopes_.fill(-std::numeric_limits<float>::infinity());
}

bool Horizon::hides(const glm::dvec3& least, const glm::dvec3& most) const {
    if (!isOutside(least, most)) return false;
    const Range range = directionsOf(least, most, kDirections);
    const double slope = most.z / (most.z > 0.0 ? nearest(least, most) : farthest(least, most));
    const int last = static_cast<int>(std::floor(range.last));
    for (int i = static_cast<int>(std::floor(range.first)); i <= last; ++i) {
        if (slope >= static_cast<double>(slopes_[wrapped(i, kDirections)])) return false;
    }
    return true;
}

void Horizon::add(const glm::dvec3& least, const glm::dvec3& most) {
    if (!isOutside(least, most)) return;
    const Range range = directionsOf(least, most, kDirections);
    // The ground within the box is above its bottom everywhere: a ray that is below the bottom at some place of the box
    // has met it. Where the bottom is below the camera that is so at the near side last.
    const double distance = least.z > 0.0 ? farthest(least, most) : nearest(least, most);
    if (distance <= 0.0) return;
    const auto slope = static_cast<float>(least.z / distance * (least.z > 0.0 ? 0.999999 : 1.000001));
    // Only directions that the box covers from side to side.
    const int last = static_cast<int>(std::floor(range.last)) - 1;
    for (int i = static_cast<int>(std::ceil(range.first)); i <= last; ++i) {
        float& known = slopes_[wrapped(i, kDirections)];
        known = std::max(known, slope);
    }
}

} // namespace apeiron::terrain
