#include "render/interleave.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace apeiron::render {
namespace {

/// The shortest step between two offsets of a pattern that repeats every `period` pixels.
int wrapped(int difference, int period) {
    const int positive = ((difference % period) + period) % period;
    return 2 * positive > period ? positive - period : positive;
}

int squaredDistance(glm::ivec2 a, glm::ivec2 b, int period) {
    const int dx = wrapped(b.x - a.x, period);
    const int dy = wrapped(b.y - a.y, period);
    return dx * dx + dy * dy;
}

std::vector<glm::ivec2> farthestPointOrder(int factor) {
    std::vector<glm::ivec2> left;
    for (int y = 0; y < factor; ++y) {
        for (int x = 0; x < factor; ++x)
            left.emplace_back(x, y);
    }
    std::vector<glm::ivec2> order;
    while (!left.empty()) {
        // The farthest from what is there; of several, the one with the least company.
        std::size_t best = 0;
        int bestNearest = -1;
        double bestCompany = 0.0;
        for (std::size_t i = 0; i < left.size(); ++i) {
            int nearest = std::numeric_limits<int>::max();
            double company = 0.0;
            for (const glm::ivec2 there : order) {
                const int d2 = squaredDistance(left[i], there, factor);
                nearest = std::min(nearest, d2);
                company += 1.0 / d2;
            }
            if (nearest > bestNearest || (nearest == bestNearest && company < bestCompany - 1e-9)) {
                best = i;
                bestNearest = nearest;
                bestCompany = company;
            }
        }
        order.push_back(left[best]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return order;
}

/// Every move of the camera makes an Interleave: the orders are worked out once.
const std::vector<glm::ivec2>& orderOf(int factor) {
    static const auto kOrders = [] {
        std::array<std::vector<glm::ivec2>, Interleave::kMost> orders;
        for (int f = 1; f <= Interleave::kMost; ++f)
            orders[static_cast<std::size_t>(f) - 1] = farthestPointOrder(f);
        return orders;
    }();
    return kOrders[static_cast<std::size_t>(factor) - 1];
}

} // namespace

Interleave::Interleave(int factor, int first) : factor_(factor), first_(first % (factor * factor)) {
    assert(factor >= 1 && factor <= kMost && first >= 0);
    offsets_ = orderOf(factor);
}

std::array<int, Interleave::kMost * Interleave::kMost> Interleave::nearest(int done) const {
    assert(done >= 1 && done <= count());
    std::array<int, kMost * kMost> steps{};
    for (int y = 0; y < factor_; ++y) {
        for (int x = 0; x < factor_; ++x) {
            int best = 0;
            for (int i = 1; i < done; ++i) {
                if (squaredDistance({x, y}, offset(i), factor_) < squaredDistance({x, y}, offset(best), factor_))
                    best = i;
            }
            const glm::ivec2 to = offset(best);
            steps[static_cast<std::size_t>(y) * kMost + static_cast<std::size_t>(x)] =
                (wrapped(to.y - y, factor_) + 8) * 16 + wrapped(to.x - x, factor_) + 8;
        }
    }
    return steps;
}

} // namespace apeiron::render
