#include "render/shared_points.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::render {
namespace {

constexpr double kTau = 6.283185307179586;

} // namespace

SharedPoints::SharedPoints(const scene::Scene& scene)
    : filter_(scene.camera.choice("filter")), blades_(static_cast<int>(scene.camera.integer("blades"))) {
    const auto seed = static_cast<double>(scene.output.integer("seed"));
    start_ = glm::fract(glm::dvec4(0.5, 0.5, 0.25, 0.5) + seed * glm::dvec4(0.618034, 0.414214, 0.732051, 0.236068));
}

glm::vec2 SharedPoints::shift(std::uint32_t sample) const {
    const glm::dvec2 u = glm::fract(glm::dvec2(start_) +
                                    glm::dvec2(0.7548776662466927, 0.5698402909980532) * static_cast<double>(sample));
    if (filter_ == 0) return glm::vec2(u - 0.5);
    if (filter_ == 1) {
        const auto tent = [](double v) { return v < 0.5 ? std::sqrt(2.0 * v) - 1.0 : 1.0 - std::sqrt(2.0 - 2.0 * v); };
        return {static_cast<float>(tent(u.x)), static_cast<float>(tent(u.y))};
    }
    // As camera.glsl: Gaussian of sigma 0.45 px, cut off at 1.5 px.
    const double radius = std::min(0.45 * std::sqrt(-2.0 * std::log(std::max(1.0 - u.x, 1e-6))), 1.5);
    return {static_cast<float>(radius * std::cos(kTau * u.y)), static_cast<float>(radius * std::sin(kTau * u.y))};
}

glm::vec2 SharedPoints::lens(std::uint32_t sample) const {
    // Other multiples than those of the place in the pixel: the two must not move together.
    const glm::dvec2 u = glm::fract(glm::dvec2(start_.z, start_.w) +
                                    glm::dvec2(0.8191725133961645, 0.6710436067037893) * static_cast<double>(sample));
    if (blades_ >= 3) {
        const double corner = std::floor(u.x * blades_);
        const double a = kTau * (corner + 0.25) / blades_;
        const double b = kTau * (corner + 1.25) / blades_;
        const double part = u.x * blades_ - corner;
        const glm::dvec2 edge =
            glm::mix(glm::dvec2(std::cos(a), std::sin(a)), glm::dvec2(std::cos(b), std::sin(b)), part);
        return glm::vec2(std::sqrt(u.y) * edge);
    }
    const double radius = std::sqrt(u.x);
    return {static_cast<float>(radius * std::cos(kTau * u.y)), static_cast<float>(radius * std::sin(kTau * u.y))};
}

} // namespace apeiron::render
