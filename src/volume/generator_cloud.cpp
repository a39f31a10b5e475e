#include "core/error.hpp"
#include "volume/generators.hpp"
#include "volume/voxels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apeiron::volume {
namespace {

/// PCG's output permutation as a hash (Jarzynski & Olano 2020).
std::uint32_t hashed(std::uint32_t v) {
    const std::uint32_t state = v * 747796405U + 2891336453U;
    const std::uint32_t word = ((state >> ((state >> 28) + 4U)) ^ state) * 277803737U;
    return (word >> 22) ^ word;
}

std::uint32_t hashed(glm::ivec3 cell, std::uint32_t seed) {
    return hashed(
        static_cast<std::uint32_t>(cell.x) +
        hashed(static_cast<std::uint32_t>(cell.y) + hashed(static_cast<std::uint32_t>(cell.z) + hashed(seed))));
}

float unit(std::uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24F;
}

glm::vec3 unit3(std::uint32_t bits) {
    return glm::vec3(static_cast<float>(bits & 1023U), static_cast<float>((bits >> 10) & 1023U),
                     static_cast<float>((bits >> 20) & 1023U)) /
           1024.0F;
}

float smooth(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

/// Gradient noise in about [-1, 1] (Perlin 2002).
float perlin(glm::vec3 p, std::uint32_t seed) {
    const glm::vec3 base = glm::floor(p);
    const glm::ivec3 cell(base);
    const glm::vec3 f = p - base;
    const glm::vec3 w = f * f * f * (f * (f * 6.0F - 15.0F) + 10.0F);
    std::array<float, 8> corner{};
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 offset(i & 1, (i >> 1) & 1, i >> 2);
        const std::uint32_t h = hashed(cell + offset, seed) & 15U;
        const glm::vec3 d = f - glm::vec3(offset);
        // One of the directions from a cube's centre to its edges.
        const float u = h < 8 ? d.x : d.y;
        const float v = h < 4 ? d.y : (h == 12 || h == 14 ? d.x : d.z);
        corner[static_cast<std::size_t>(i)] = ((h & 1U) != 0 ? -u : u) + ((h & 2U) != 0 ? -v : v);
    }
    const auto mix = [&](std::size_t a, std::size_t b, float t) { return corner[a] + t * (corner[b] - corner[a]); };
    const float near0 = mix(0, 1, w.x) + w.y * (mix(2, 3, w.x) - mix(0, 1, w.x));
    const float near1 = mix(4, 5, w.x) + w.y * (mix(6, 7, w.x) - mix(4, 5, w.x));
    return near0 + w.z * (near1 - near0);
}

/// One minus the distance to the nearest of a cell's random points, 0 to 1 (Worley 1996): billows.
float billows(glm::vec3 p, std::uint32_t seed) {
    const glm::vec3 base = glm::floor(p);
    const glm::ivec3 cell(base);
    const glm::vec3 f = p - base;
    float nearest = 1;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const glm::vec3 d = glm::vec3(x, y, z) + unit3(hashed(cell + glm::ivec3(x, y, z), seed)) - f;
                nearest = std::min(nearest, glm::dot(d, d));
            }
    return 1 - std::sqrt(nearest);
}

struct Puff {
    glm::vec3 centre;
    float radius;
};

/// In units of half the cloud's width; z from -0.5 to 0.5.
class Cloud {
  public:
    explicit Cloud(std::uint32_t seed) : seed_(hashed(seed)) {
        std::uint32_t state = seed_;
        const auto random = [&state] { return unit(state = hashed(state)); };
        puffs_.push_back({{0, 0, -0.12F}, 0.40F});
        while (puffs_.size() < 26) {
            // Many small ones around few large ones, higher in the middle.
            const float angle = 6.2831853F * random();
            const float out = 0.78F * std::sqrt(random());
            const float high = (1 - out) * random();
            const float radius = 0.13F + 0.19F * (1 - out) * random();
            puffs_.push_back(
                {{out * std::cos(angle), 0.72F * out * std::sin(angle), kBase + 0.10F + 0.60F * high}, radius});
        }
    }

    /// 0 to 1.
    float density(glm::vec3 p) const {
        // How deep inside the nearest puff, in units of length; a flat base.
        float depth = -1;
        for (const Puff& puff : puffs_) {
            const glm::vec3 d = p - puff.centre;
            const float reach = puff.radius - depth;
            const float d2 = glm::dot(d, d);
            if (d2 < reach * reach) depth = puff.radius - std::sqrt(d2);
        }
        depth = std::min(depth, 0.6F * (p.z - kBase));
        // Noise moves the border by no more than this.
        constexpr float kOutside = 0.10F;
        if (depth < -kOutside) return 0;
        // Air is drawn in from below and the sides: wisps there, hard billows on top.
        const glm::vec3 warp = p + 0.06F * glm::vec3(perlin(3.0F * p, seed_ + 1), perlin(3.0F * p, seed_ + 2),
                                                     perlin(3.0F * p, seed_ + 3));
        float noise = 0;
        float weight = 0.5F;
        float frequency = 4.5F;
        for (std::uint32_t octave = 0; octave < 4; ++octave) {
            noise += weight * (billows(frequency * warp, seed_ + 10 + octave) - 0.55F);
            weight *= 0.5F;
            frequency *= 2.1F;
        }
        const float wisps = perlin(7.0F * warp, seed_ + 20) + 0.5F * perlin(15.0F * warp, seed_ + 21);
        const float border = depth + 0.22F * noise + 0.025F * wisps;
        return smooth(0, 0.09F, border) * (0.55F + 0.45F * smooth(0, 0.3F, depth));
    }

  private:
    static constexpr float kBase = -0.38F;
    std::uint32_t seed_;
    std::vector<Puff> puffs_;
};

} // namespace

Volume cloud(int size, std::uint32_t seed) {
    if (size < kMinGeneratedSize || size > kMaxGeneratedSize)
        throw Error(ErrorKind::BadInput, fmt::format("a generated volume cannot be {} voxels wide", size), {},
                    fmt::format("choose {} to {}", kMinGeneratedSize, kMaxGeneratedSize));
    const glm::ivec3 edges(size, std::max(1, size * 4 / 5), std::max(1, size / 2));
    Volume volume = makeVolume(edges, VoxelType::UInt8);
    centre(volume, glm::dvec3(kGeneratedExtent / size));
    volume.name = "cloud";
    volume.modality = Modality::Simulation;
    const Cloud shape(seed);
    auto* voxel = mutableVoxels<std::uint8_t>(volume);
    const float step = 2.0F / static_cast<float>(size);
    const glm::vec3 first = -0.5F * step * glm::vec3(edges - 1);
    for (int z = 0; z < edges.z; ++z)
        for (int y = 0; y < edges.y; ++y)
            for (int x = 0; x < edges.x; ++x)
                *voxel++ =
                    static_cast<std::uint8_t>(std::lround(255 * shape.density(first + step * glm::vec3(x, y, z))));
    return volume;
}

} // namespace apeiron::volume
