#pragma once

#include "volume/volume.hpp"

#include <string>
#include <vector>

// Volumes that need no file: closed forms, the classic test signals, and two for the eye. All of them are the same on
// every machine up to rounding, centred at the world's origin, and kGeneratedExtent long along their longest edge.
namespace apeiron::volume {

/// Longest edge of generated volumes [mm].
inline constexpr double kGeneratedExtent = 200.0;

/// Edges of generated volumes have this many voxels.
inline constexpr int kMinGeneratedSize = 4;
inline constexpr int kMaxGeneratedSize = 1024;

/// The signal of Marschner & Lobb (1994, eq. 2 and 3) in [-1, 1]³ with f_M = 6, alpha = 0.25, as Float32 in [0, 1]: 41
/// voxels sample it just above its Nyquist rate; what is left of its rings judges a reconstruction filter.
Volume marschnerLobb(int size);

/// The value of the same signal at a point of [-1, 1]³.
double marschnerLobbValue(glm::dvec3 p);

/// The head phantom of Shepp & Logan (1974) in 3D after Kak & Slaney (1988, table 3.2), as CT in Hounsfield units: its
/// densities are relative to water, so that the skull has 1000 HU, the brain 20, the ventricles 0, tumours 30, air
/// -1000. Voxels on borders hold their share of both sides. The face looks to -y, the crown to +z.
Volume sheppLogan(int size);

/// Quantum numbers of an electron in a hydrogen atom, 1 <= n <= 10, 0 <= l < n, -l <= m <= l.
struct Orbital {
    int n = 4;
    int l = 2;
    int m = 0;
};

/// Real orbital of the hydrogen atom (Schrödinger 1926; cosine for m > 0, sine for m < 0): probability density |psi|²
/// over its maximum, as Float32. The cube holds all but about a thousandth of the probability.
/// @param phases 2 channels instead of one: where psi is positive, and where it is negative
/// @throws Error (BadInput) for quantum numbers that cannot be.
Volume hydrogen(int size, const Orbital& orbital = {}, bool phases = false);

/// The real wave function at a point [Bohr radii], normalised: the integral of its square over space is 1.
double hydrogenWave(const Orbital& orbital, glm::dvec3 p);

/// The Mandelbulb of power 8 (White & Nylander 2009) as voxels, UInt8: 0 outside, inside 64 to 255 by how near the
/// orbit comes to the axis' planes; voxels on the border hold the share that is inside, by the distance estimate.
Volume voxelFractal(int size);

/// A cumulus cloud, UInt8, twice as wide as high: puffs over a flat base, eroded by gradient and cell noise (Perlin
/// 2002, Worley 1996, in the way of Schneider & Vos 2015). 0 is clear air, 255 the densest core.
Volume cloud(int size, std::uint32_t seed = 1);

/// What generate() takes.
struct GeneratorOptions {
    int size = 128; ///< voxels along the longest edge
    Orbital orbital;
    bool phases = false;    ///< of the orbital
    std::uint32_t seed = 1; ///< of the cloud
};

/// A generated volume's name, and one line about it.
struct Generator {
    std::string name;
    std::string doc;
};

/// All generators: marschner_lobb, shepp_logan, hydrogen, fractal, cloud.
const std::vector<Generator>& generators();

/// A volume by its generator's name. @throws Error (BadInput) for an unknown name and sizes out of range.
Volume generate(const std::string& name, const GeneratorOptions& options = {});

} // namespace apeiron::volume
