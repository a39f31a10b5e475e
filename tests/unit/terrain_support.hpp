#pragma once

#include "terrain/height.hpp"

#include <random>
#include <string>

namespace apeiron::terrain {

/// The cell at the end of a path of digits, step by step.
inline Cell cellAt(const Shape& shape, const std::string& path) {
    Cell cell = rootCell(shape);
    for (const char digit : path)
        cell = childCell(shape, cell, digit - '0');
    return cell;
}

inline std::string randomPath(std::mt19937& random, int levels) {
    std::string path;
    for (int i = 0; i < levels; ++i)
        path += static_cast<char>('0' + random() % 4);
    return path;
}

/// Both kernels, plain and self-affine.
inline std::vector<Shape> shapes() {
    return {
        {Kernel::BSpline, 1, 1000}, {Kernel::Bilinear, 2, 1000}, {Kernel::BSpline, 3, 800}, {Kernel::Bilinear, 4, 430}};
}

/// The hash that the noise is cut from, written down once more.
inline std::uint32_t noiseOf(std::uint32_t seed, std::int64_t level, std::uint32_t x, std::uint32_t y) {
    const auto mix = [](std::uint32_t v) {
        v = (v ^ (v >> 16U)) * 0x7feb352dU;
        v = (v ^ (v >> 15U)) * 0x846ca68bU;
        return v ^ (v >> 16U);
    };
    return mix(x ^ mix(y ^ mix((static_cast<std::uint32_t>(level) * 0x9E3779B9U) ^ seed)));
}

} // namespace apeiron::terrain
