#include "volume/orientation.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::volume {

Orientation orientationOf(const Volume& volume) {
    constexpr double kDegrees = 57.29577951308232;
    std::array<glm::dvec3, 3> axes{};
    for (int i = 0; i < 3; ++i)
        axes[static_cast<std::size_t>(i)] = glm::normalize(glm::dvec3(volume.indexToWorld[i]));

    // Of all ways to give each axis a direction of its own, the one that fits best.
    std::array<std::size_t, 3> order{0, 1, 2};
    std::array<std::size_t, 3> best = order;
    double most = -1;
    do {
        double fit = 0;
        for (std::size_t i = 0; i < 3; ++i)
            fit += std::abs(axes[i][static_cast<int>(order[i])]);
        if (fit > most + 1e-12) {
            most = fit;
            best = order;
        }
    } while (std::next_permutation(order.begin(), order.end()));

    Orientation result;
    for (std::size_t i = 0; i < 3; ++i) {
        const double along = axes[i][static_cast<int>(best[i])];
        result.letters += (along < 0 ? "RAI" : "LPS")[best[i]];
        result.oblique = std::max(result.oblique, kDegrees * std::acos(std::min(1.0, std::abs(along))));
        const double skew = std::abs(glm::dot(axes[i], axes[(i + 1) % 3]));
        result.shear = std::max(result.shear, kDegrees * std::asin(std::min(1.0, skew)));
    }
    result.mirrored = glm::determinant(glm::dmat3(volume.indexToWorld)) < 0;
    return result;
}

} // namespace apeiron::volume
