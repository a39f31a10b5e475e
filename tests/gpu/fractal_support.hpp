#pragma once

#include "gpu_support.hpp"

#include <random>

namespace apeiron::test {

/// Points in the ball of that radius, as floats hold them: both sides then start from the same numbers.
inline std::vector<glm::vec3> pointsInBall(std::size_t count, double radius, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-radius, radius);
    std::vector<glm::vec3> points;
    while (points.size() < count) {
        const glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
        if (glm::length(glm::dvec3(p)) < radius) points.push_back(p);
    }
    return points;
}

/// A fractal of that JSON, its camera at the origin: what GLSL sees is the fractal's own space.
inline scene::Scene fractalOf(const std::string& subject) {
    return sceneOf(R"({"apeiron": 1, "camera": {"mode": "free", "position": ["0", "0", "0"]}, "subject": )" + subject +
                   "}");
}

/// What a GLSL expression of `vec3 p` (a vec4) is at each of at most 256 points.
inline std::vector<glm::dvec4> valuesAt(const scene::Scene& scene, const std::vector<glm::vec3>& points,
                                        const std::string& expression) {
    const auto images = runOnScene(scene,
                                   "uniform vec3 points[256];\n"
                                   "void kernel_main(ivec2 pixel, out vec4 a) { vec3 p = points[pixel.x]; a = " +
                                       expression + "; }\n",
                                   {static_cast<int>(points.size()), 1}, 1, [&](gpu::Kernel& kernel) {
                                       kernel.set("points[0]", std::span<const glm::vec3>(points));
                                   });
    std::vector<glm::dvec4> values;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float* v = images[0].data().data() + 4 * i;
        values.emplace_back(v[0], v[1], v[2], v[3]);
    }
    return values;
}

inline std::vector<double> distancesAt(const scene::Scene& scene, const std::vector<glm::vec3>& points) {
    std::vector<double> distances;
    for (const glm::dvec4& value : valuesAt(scene, points, "vec4(distance_estimate(p))"))
        distances.push_back(value.x);
    return distances;
}

} // namespace apeiron::test
