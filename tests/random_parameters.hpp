#pragma once

#include "parameter/node.hpp"

#include <cmath>
#include <random>

namespace apeiron::test {

/// A value of the parameter's declared range; within a tenth of the range's size from its default for `far` = 0.1.
inline parameter::Value randomValue(const parameter::Parameter& p, std::mt19937& random, double far = 1.0) {
    using parameter::Type;
    const double low = p.minimum.value_or(-1.0);
    const double high = p.maximum.value_or(1.0);
    const auto number = [&](double centre) {
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        const double u = unit(random);
        if (p.logarithmic && low > 0.0) {
            const double there = std::log(centre / low) / std::log(high / low);
            const double t = std::clamp(there + far * (u - there), 0.0, 1.0);
            return std::clamp(low * std::pow(high / low, t), low, high);
        }
        return std::clamp(centre + far * (low + u * (high - low) - centre), low, high);
    };
    switch (p.type) {
    case Type::Bool:
        return std::uniform_int_distribution<int>(0, 1)(random) == 1;
    case Type::Int:
        return static_cast<std::int64_t>(
            std::lround(number(static_cast<double>(std::get<std::int64_t>(p.defaultValue)))));
    case Type::Float:
        return number(std::get<double>(p.defaultValue));
    case Type::Vec2: {
        const glm::dvec2 v = std::get<glm::dvec2>(p.defaultValue);
        return glm::dvec2(number(v.x), number(v.y));
    }
    case Type::Vec3: {
        const glm::dvec3 v = std::get<glm::dvec3>(p.defaultValue);
        return glm::dvec3(number(v.x), number(v.y), number(v.z));
    }
    case Type::Vec4: {
        const glm::dvec4 v = std::get<glm::dvec4>(p.defaultValue);
        return glm::dvec4(number(v.x), number(v.y), number(v.z), number(v.w));
    }
    case Type::Choice:
        return p.choices[std::uniform_int_distribution<std::size_t>(0, p.choices.size() - 1)(random)];
    default:
        return p.defaultValue;
    }
}

} // namespace apeiron::test
