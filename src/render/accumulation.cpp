#include "render/accumulation.hpp"

#include "core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apeiron::render {

namespace {

constexpr std::array kLuminance{0.2126, 0.7152, 0.0722};

} // namespace

void Accumulation::merge(const Accumulation& other) {
    if (mean.width() != other.mean.width() || mean.height() != other.mean.height()) {
        throw Error(ErrorKind::BadInput, fmt::format("cannot merge {}x{} with {}x{}", mean.width(), mean.height(),
                                                     other.mean.width(), other.mean.height()));
    }
    for (std::size_t i = 0; i < mean.data().size(); i += 4) {
        const double a = mean.data()[i + 3];
        const double b = other.mean.data()[i + 3];
        if (b == 0.0) continue;
        const double n = a + b;
        const double share = b / n;
        for (std::size_t c = 0; c < 3; ++c) {
            const double delta =
                static_cast<double>(other.mean.data()[i + c]) - static_cast<double>(mean.data()[i + c]);
            mean.data()[i + c] = static_cast<float>(static_cast<double>(mean.data()[i + c]) + delta * share);
            spread.data()[i + c] =
                static_cast<float>(static_cast<double>(spread.data()[i + c]) +
                                   static_cast<double>(other.spread.data()[i + c]) + delta * delta * a * share);
        }
        mean.data()[i + 3] = static_cast<float>(n);
        const auto mix = [share](float& x, float y) {
            x = static_cast<float>(static_cast<double>(x) + (static_cast<double>(y) - static_cast<double>(x)) * share);
        };
        mix(spread.data()[i + 3], other.spread.data()[i + 3]);
        for (std::size_t c = 0; c < 4; ++c) {
            mix(normal.data()[i + c], other.normal.data()[i + c]);
            mix(albedo.data()[i + c], other.albedo.data()[i + c]);
        }
    }
}

std::int64_t Accumulation::samples() const {
    float most = 0.0F;
    for (std::size_t i = 3; i < mean.data().size(); i += 4)
        most = std::max(most, mean.data()[i]);
    return static_cast<std::int64_t>(most);
}

double Accumulation::luminance() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < mean.data().size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c)
            sum += kLuminance[c] * static_cast<double>(mean.data()[i + c]);
    }
    return 4.0 * sum / static_cast<double>(mean.data().size());
}

double Accumulation::noise() const {
    double squares = 0.0;
    for (std::size_t i = 0; i < mean.data().size(); i += 4) {
        const double n = mean.data()[i + 3];
        if (n < 2.0) return 0.0;
        // Channels of one sample rise and fall together: their deviations add, not their variances.
        double deviation = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            deviation += kLuminance[c] * std::sqrt(std::max(static_cast<double>(spread.data()[i + c]), 0.0));
        }
        squares += deviation * deviation / (n * (n - 1.0));
    }
    const double pixels = static_cast<double>(mean.data().size()) / 4.0;
    const double level = luminance();
    return level > 0.0 ? std::sqrt(squares / pixels) / level : 0.0;
}

} // namespace apeiron::render
