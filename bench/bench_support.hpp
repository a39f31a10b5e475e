#pragma once

#include "core/image.hpp"

#include <cmath>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <vector>

/// What the benchmarks share.
namespace apeiron::bench {

/// Of a sorted list. @param part 0 to 1
inline double percentile(const std::vector<double>& sorted, double part) {
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

/// Peak signal-to-noise ratio of two display-encoded pictures of one size, RGBA; alpha does not count [dB].
inline double psnr(const Image<float>& a, const Image<float>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.data().size(); ++i) {
        if (i % 4 == 3) continue;
        const double d = static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]);
        squares += d * d;
    }
    return -10.0 * std::log10(squares / (0.75 * static_cast<double>(a.data().size())));
}

/// Does the work of a program. @returns its exit code; an error is one line on stderr
template <typename Work> int runAs(const char* program, const Work& work) {
    try {
        work();
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", program, error.what());
        return 1;
    }
    return 0;
}

} // namespace apeiron::bench
