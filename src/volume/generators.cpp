#include "volume/generators.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "volume/voxels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace apeiron::volume {
namespace {

void requireSize(int size) {
    if (size < kMinGeneratedSize || size > kMaxGeneratedSize)
        throw Error(ErrorKind::BadInput, fmt::format("a generated volume cannot be {} voxels wide", size), {},
                    fmt::format("choose {} to {}", kMinGeneratedSize, kMaxGeneratedSize));
}

/// A cube of values of a function of the voxel's centre in [-1, 1]³, whose corners are the outermost voxels' outer
/// corners.
template <class T, class Value> Volume cubeOf(int size, VoxelType type, const char* name, const Value& value) {
    requireSize(size);
    Volume volume = makeVolume(glm::ivec3(size), type);
    centre(volume, glm::dvec3(kGeneratedExtent / size));
    volume.name = name;
    volume.modality = Modality::Simulation;
    const auto coordinate = [size](int i) { return (2.0 * i + 1.0) / size - 1.0; };
    T* voxel = mutableVoxels<T>(volume);
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                *voxel++ = value(glm::dvec3(coordinate(x), coordinate(y), coordinate(z)));
    return volume;
}

/// An ellipsoid of the head phantom, turned about z.
struct Ellipsoid {
    glm::dvec3 centre;
    glm::dvec3 axes;
    double turn; ///< [degrees]
    double density;
};

/// Kak & Slaney (1988), Principles of Computerized Tomographic Imaging, table 3.2. Densities add up where ellipsoids
/// overlap.
const std::array<Ellipsoid, 10> kHead{{
    {{0, 0, 0}, {0.69, 0.92, 0.9}, 0, 2.0},
    {{0, 0, 0}, {0.6624, 0.874, 0.88}, 0, -0.98},
    {{-0.22, 0, -0.25}, {0.41, 0.16, 0.21}, 108, -0.02},
    {{0.22, 0, -0.25}, {0.31, 0.11, 0.22}, 72, -0.02},
    {{0, 0.35, -0.25}, {0.21, 0.25, 0.5}, 0, 0.02},
    {{0, 0.1, -0.25}, {0.046, 0.046, 0.046}, 0, 0.02},
    {{-0.08, -0.65, -0.25}, {0.046, 0.023, 0.02}, 0, 0.01},
    {{0.06, -0.65, -0.25}, {0.046, 0.023, 0.02}, 90, 0.01},
    {{0.06, -0.105, 0.625}, {0.056, 0.04, 0.1}, 90, 0.02},
    {{0, 0.1, 0.625}, {0.056, 0.056, 0.1}, 0, -0.02},
}};

/// How much of a voxel of width `h` around `p` is inside, from the first-order distance to the surface.
double share(const Ellipsoid& e, glm::dvec3 p, double h) {
    const double angle = e.turn * std::numbers::pi / 180;
    const glm::dvec3 d = p - e.centre;
    const glm::dvec3 q =
        glm::dvec3(std::cos(angle) * d.x + std::sin(angle) * d.y, std::cos(angle) * d.y - std::sin(angle) * d.x, d.z) /
        e.axes;
    const double f = glm::dot(q, q);
    const glm::dvec3 gradient = 2.0 * q / e.axes;
    const double length = glm::length(gradient);
    if (length <= 0) return 1;
    return std::clamp(0.5 - (f - 1) / (length * h), 0.0, 1.0);
}

/// z^8 of a triplex number: latitude and longitude times 8, radius to the power of 8, without a trigonometric function.
glm::dvec3 triplexPower8(glm::dvec3 z) {
    const double rho = std::sqrt(z.x * z.x + z.y * z.y);
    std::complex<double> latitude(rho, z.z);
    std::complex<double> longitude = rho > 0 ? std::complex<double>(z.x / rho, z.y / rho) : 1.0;
    for (int doubling = 0; doubling < 3; ++doubling) {
        latitude = {latitude.real() * latitude.real() - latitude.imag() * latitude.imag(),
                    2 * latitude.real() * latitude.imag()};
        longitude = {longitude.real() * longitude.real() - longitude.imag() * longitude.imag(),
                     2 * longitude.real() * longitude.imag()};
    }
    return {latitude.real() * longitude.real(), latitude.real() * longitude.imag(), latitude.imag()};
}

std::uint8_t fractalVoxel(glm::dvec3 c, double h) {
    constexpr int kIterations = 14;
    constexpr double kBailout = 16.0; // squared
    glm::dvec3 z = c;
    double derivative = 1;
    double trap = 1e9;
    double share = 1;
    for (int i = 0; i < kIterations; ++i) {
        const double r2 = glm::dot(z, z);
        if (r2 > kBailout) {
            const double r = std::sqrt(r2);
            share = std::clamp(1 - 0.5 * std::log(r) * r / derivative / h, 0.0, 1.0);
            break;
        }
        trap = std::min({trap, std::abs(z.x), std::abs(z.y), std::abs(z.z)});
        derivative = 8 * std::pow(r2, 3.5) * derivative + 1;
        z = triplexPower8(z) + c;
    }
    const double shade = 64 + 191 * std::clamp(std::sqrt(4 * trap), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(share * shade));
}

} // namespace

double marschnerLobbValue(glm::dvec3 p) {
    constexpr double kFrequency = 6;
    constexpr double kAlpha = 0.25;
    const double r = std::sqrt(p.x * p.x + p.y * p.y);
    const double rings = std::cos(2 * std::numbers::pi * kFrequency * std::cos(std::numbers::pi * r / 2));
    return (1 - std::sin(std::numbers::pi * p.z / 2) + kAlpha * (1 + rings)) / (2 * (1 + kAlpha));
}

Volume marschnerLobb(int size) {
    return cubeOf<float>(size, VoxelType::Float32, "marschner_lobb",
                         [](glm::dvec3 p) { return static_cast<float>(marschnerLobbValue(p)); });
}

Volume sheppLogan(int size) {
    const double h = 2.0 / size;
    Volume volume = cubeOf<std::int16_t>(size, VoxelType::Int16, "shepp_logan", [h](glm::dvec3 p) {
        // The table's y is the direction of the face; ours is LPS.
        p.y = -p.y;
        double density = 0;
        for (const Ellipsoid& ellipsoid : kHead)
            density += ellipsoid.density * share(ellipsoid, p, h);
        return static_cast<std::int16_t>(std::lround(1000 * (density - 1)));
    });
    volume.modality = Modality::Ct;
    volume.unit = "HU";
    return volume;
}

Volume voxelFractal(int size) {
    constexpr double kHalf = 1.2;
    const double h = 2.0 * kHalf / size;
    return cubeOf<std::uint8_t>(size, VoxelType::UInt8, "fractal",
                                [h](glm::dvec3 p) { return fractalVoxel(kHalf * p, h); });
}

const std::vector<Generator>& generators() {
    static const std::vector<Generator> kAll{
        {"marschner_lobb", "Marschner and Lobb's test signal: rings at the limit of what the grid can hold"},
        {"shepp_logan", "Shepp and Logan's head phantom in Hounsfield units"},
        {"hydrogen", "An orbital of the hydrogen atom"},
        {"fractal", "The Mandelbulb as voxels"},
        {"cloud", "A cumulus cloud"},
    };
    return kAll;
}

Volume generate(const std::string& name, const GeneratorOptions& options) {
    if (name == "marschner_lobb") return marschnerLobb(options.size);
    if (name == "shepp_logan") return sheppLogan(options.size);
    if (name == "hydrogen") return hydrogen(options.size, options.orbital, options.phases);
    if (name == "fractal") return voxelFractal(options.size);
    if (name == "cloud") return cloud(options.size, options.seed);
    std::vector<std::string> known;
    for (const Generator& generator : generators())
        known.push_back(generator.name);
    throw Error(ErrorKind::BadInput, "no generated volume is called " + inQuotes(name), {}, suggestion(name, known));
}

} // namespace apeiron::volume
