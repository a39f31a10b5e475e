#include "core/error.hpp"
#include "volume/generators.hpp"
#include "volume/voxels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apeiron::volume {
namespace {

double factorial(int n) {
    return std::tgamma(n + 1.0);
}

/// A real orbital with its normalisation worked out once.
class Wave {
  public:
    explicit Wave(const Orbital& orbital)
        : n_(orbital.n), l_(orbital.l), m_(std::abs(orbital.m)), sine_(orbital.m < 0) {
        if (n_ < 1 || n_ > 10 || l_ < 0 || l_ >= n_ || m_ > l_)
            throw Error(ErrorKind::BadInput,
                        fmt::format("there is no orbital n = {}, l = {}, m = {}", orbital.n, orbital.l, orbital.m), {},
                        "n is 1 to 10, l is 0 to n - 1, m is -l to l");
        const double radial = std::pow(2.0 / n_, 3) * factorial(n_ - l_ - 1) / (2 * n_ * factorial(n_ + l_));
        const double angular =
            (2 * l_ + 1) / (4 * std::numbers::pi) * factorial(l_ - m_) / factorial(l_ + m_) * (m_ == 0 ? 1 : 2);
        radialScale_ = std::sqrt(radial);
        angularScale_ = std::sqrt(angular);
    }

    /// The radial part R_nl, with associated Laguerre polynomials by their recurrence.
    double radial(double r) const {
        const double x = 2 * r / n_;
        const int k = n_ - l_ - 1;
        const double a = 2 * l_ + 1;
        double before = 0;
        double laguerre = 1;
        for (int i = 1; i <= k; ++i) {
            const double next = ((2 * i - 1 + a - x) * laguerre - (i - 1 + a) * before) / i;
            before = laguerre;
            laguerre = next;
        }
        return radialScale_ * std::exp(-x / 2) * std::pow(x, l_) * laguerre;
    }

    /// The spherical harmonic in a direction (of any length; 0 counts as +z).
    double angular(glm::dvec3 p) const {
        const double r = glm::length(p);
        const glm::dvec3 d = r > 0 ? p / r : glm::dvec3(0, 0, 1);
        // P_l^m without its factor sin(theta)^m, which is in the power of (x + iy).
        double pmm = 1;
        for (int i = 1; i <= m_; ++i)
            pmm *= 2 * i - 1;
        double before = 0;
        double legendre = pmm;
        for (int i = m_ + 1; i <= l_; ++i) {
            const double next = ((2 * i - 1) * d.z * legendre - (i + m_ - 1) * before) / (i - m_);
            before = legendre;
            legendre = next;
        }
        double re = 1;
        double im = 0;
        for (int i = 0; i < m_; ++i) {
            const double t = re * d.x - im * d.y;
            im = re * d.y + im * d.x;
            re = t;
        }
        return angularScale_ * legendre * (sine_ ? im : re);
    }

    /// The sphere outside which a thousandth of the probability is.
    double radius() const {
        constexpr double kOutside = 1e-3;
        constexpr int kSteps = 4000;
        const double step = 8.0 * n_ * n_ / kSteps;
        double outside = 0;
        for (int i = kSteps; i > 0; --i) {
            const double r = i * step;
            const double value = r * radial(r);
            outside += value * value * step;
            if (outside > kOutside) return r;
        }
        return step;
    }

  private:
    int n_;
    int l_;
    int m_;
    bool sine_;
    double radialScale_ = 1;
    double angularScale_ = 1;
};

/// The radial part for every voxel would be most of the work: a fine table of it instead.
class RadialTable {
  public:
    RadialTable(const Wave& wave, double farthest) : perUnit_(kSteps / farthest), values_(kSteps + 2) {
        for (std::size_t i = 0; i < values_.size(); ++i)
            values_[i] = wave.radial(static_cast<double>(i) / perUnit_);
    }

    double at(double r) const {
        const double x = r * perUnit_;
        const auto i = static_cast<std::size_t>(x);
        return values_[i] + (x - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
    }

  private:
    static constexpr int kSteps = 1 << 15;
    double perUnit_;
    std::vector<double> values_;
};

} // namespace

double hydrogenWave(const Orbital& orbital, glm::dvec3 p) {
    const Wave wave(orbital);
    return wave.radial(glm::length(p)) * wave.angular(p);
}

Volume hydrogen(int size, const Orbital& orbital, bool phases) {
    const Wave wave(orbital);
    if (size < kMinGeneratedSize || size > kMaxGeneratedSize)
        throw Error(ErrorKind::BadInput, fmt::format("a generated volume cannot be {} voxels wide", size), {},
                    fmt::format("choose {} to {}", kMinGeneratedSize, kMaxGeneratedSize));
    Volume volume = makeVolume(glm::ivec3(size), VoxelType::Float32, phases ? 2 : 1);
    centre(volume, glm::dvec3(kGeneratedExtent / size));
    volume.name = "hydrogen";
    volume.modality = Modality::Simulation;
    if (phases) volume.channelNames = {"positive", "negative"};

    const double half = wave.radius();
    const RadialTable radial(wave, 1.74 * half); // up to the cube's corners
    const std::size_t count = voxelsPerChannel(volume);
    auto* voxels = mutableVoxels<float>(volume);
    const auto coordinate = [&](int i) { return half * ((2.0 * i + 1.0) / size - 1.0); };
    float most = 0;
    std::size_t index = 0;
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x, ++index) {
                const glm::dvec3 p(coordinate(x), coordinate(y), coordinate(z));
                const double psi = radial.at(glm::length(p)) * wave.angular(p);
                const auto density = static_cast<float>(psi * psi);
                most = std::max(most, density);
                voxels[phases && psi < 0 ? count + index : index] = density;
            }
    if (most > 0)
        for (std::size_t i = 0; i < count * static_cast<std::size_t>(volume.channels); ++i)
            voxels[i] /= most;
    return volume;
}

} // namespace apeiron::volume
