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

/// A number that is at least 0, or -1 when it is not, as the whole number below it: much faster than std::floor()
/// where there is no instruction for that.
int wholeBelow(double x) {
    return static_cast<int>(x);
}

/// The same of the whole number above.
int wholeAbove(double x) {
    const int whole = static_cast<int>(x);
    return static_cast<double>(whole) < x ? whole + 1 : whole;
}

} // namespace

Horizon::Horizon() {
    slopes_.fill(-std::numeric_limits<float>::infinity());
}

Horizon::Footprints Horizon::footprints(const Boxes& boxes) {
    Footprints prints;
    // No branches: the four go through it together.
    for (std::size_t i = 0; i < 4; ++i) {
        const double lx = boxes.least[0][i];
        const double ly = boxes.least[1][i];
        const double hx = boxes.most[0][i];
        const double hy = boxes.most[1][i];
        const bool right = lx > 0.0;
        const bool left = hx < 0.0;
        const bool above = ly > 0.0;
        const bool below = hy < 0.0;
        // From one of its corners to another one, counter-clockwise.
        const double besideX = right ? lx : hx;
        const double besideY = above ? ly : hy;
        const double belowFirst = below ? lx : besideX;
        const double leftFirst = left ? hy : besideY;
        const double belowLast = below ? hx : besideX;
        const double leftLast = left ? ly : besideY;
        constexpr double kScale = kDirections / 4.0;
        const double first = diamondAngle(above ? hx : belowFirst, right ? ly : leftFirst);
        const double last = diamondAngle(above ? lx : belowLast, right ? hy : leftLast);
        prints.first[i] = first * kScale;
        prints.last[i] = (last < first ? last + 4.0 : last) * kScale;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const double nearX = larger(larger(0.0, boxes.least[0][i]), -boxes.most[0][i]);
        const double nearY = larger(larger(0.0, boxes.least[1][i]), -boxes.most[1][i]);
        const double farX = larger(-boxes.least[0][i], boxes.most[0][i]);
        const double farY = larger(-boxes.least[1][i], boxes.most[1][i]);
        // std::hypot takes ten times as long; these numbers neither overflow nor vanish.
        const double nearest = std::sqrt(nearX * nearX + nearY * nearY);
        const double farthest = std::sqrt(farX * farX + farY * farY);
        const double top = boxes.most[2][i];
        const double bottom = boxes.least[2][i];
        prints.top[i] = top / (top > 0.0 ? nearest : farthest);
        // The ground within the box is above its bottom everywhere: a ray that is below the bottom at some place of the
        // box has met it. Where the bottom is below the camera that is so at the near side last.
        const double slope = bottom / (bottom > 0.0 ? farthest : nearest) * (bottom > 0.0 ? 0.999999 : 1.000001);
        prints.bottom[i] = nearest > 0.0 ? slope : -std::numeric_limits<double>::infinity();
    }
    return prints;
}

template <class Work> void Horizon::eachPart(int first, int last, const Work& work) {
    if (first >= kDirections) {
        first -= kDirections;
        last -= kDirections;
    }
    if (last >= first) work(first, std::min(last, kDirections - 1) - first + 1);
    if (last >= kDirections) work(0, last - kDirections + 1);
}

bool Horizon::hides(const Footprints& boxes, std::size_t i) const {
    const double slope = boxes.top[i];
    // Most that is seen is seen in the first direction already.
    const int start = wholeBelow(boxes.first[i]);
    if (slope >= static_cast<double>(slopes_[static_cast<std::size_t>(start) % kDirections])) return false;
    bool hidden = true;
    eachPart(start, wholeBelow(boxes.last[i]), [&](int first, int count) {
        const float* slopes = &slopes_[static_cast<std::size_t>(first)];
        for (int k = 0; hidden && k < count; ++k)
            hidden = slope < static_cast<double>(slopes[k]);
    });
    return hidden;
}

void Horizon::add(const Footprints& boxes, std::size_t i) {
    const auto slope = static_cast<float>(boxes.bottom[i]);
    // Only directions that the box covers from side to side.
    eachPart(wholeAbove(boxes.first[i]), wholeBelow(boxes.last[i]) - 1, [&](int first, int count) {
        float* slopes = &slopes_[static_cast<std::size_t>(first)];
        for (int k = 0; k < count; ++k)
            slopes[k] = slopes[k] < slope ? slope : slopes[k];
    });
}

} // namespace apeiron::terrain
