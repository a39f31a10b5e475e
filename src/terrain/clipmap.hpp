#pragma once

#include "gpu/kernel.hpp"
#include "terrain/place.hpp"

namespace apeiron::terrain {

/// Heights around the camera for rays: nested squares of 256 x 256 lattice points, each with twice the spacing of the
/// one within ("geometry clipmaps", Losasso & Hoppe 2004). Needs its context current.
class Clipmap {
  public:
    static constexpr int kSide = 256;
    static constexpr int kMostLevels = 20;

    explicit Clipmap(const gpu::Context& context);

    /// Brings it to where the camera is; computes only the squares that changed.
    /// @param spacing of the finest points, or somewhat more [world] @param relief factor on heights
    void update(const Place& place, double spacing, double relief);

    /// Adds the constants that terrain/glsl/clipmap.glsl stands on.
    static void addConstants(gpu::ShaderSource& source);
    /// Sets the uniforms of terrain/glsl/clipmap.glsl.
    void bind(gpu::Kernel& kernel) const;

  private:
    struct Level {
        std::int64_t level = -1; ///< of its points
        std::uint32_t x = 0;     ///< of the first block's cell
        std::uint32_t y = 0;
        std::int32_t reference = 0; ///< heights are stored as differences to it
    };
    void fill(const Place& place, std::size_t slot, std::int64_t cellLevel, glm::ivec2 first);

    gpu::Texture texture_; ///< of each point the heights of (0, 0), (1, 0), (0, 1), (1, 1) from it [units of its level]
    std::array<Level, kMostLevels> levels_; ///< by slots: the level modulo their number
    Shape shape_;
    int count_ = 0;
    int slot_ = 0;        ///< of the finest square
    float finest_ = 1.0F; ///< the spacing that was asked for [world]
    std::array<glm::vec4, kMostLevels> places_{};
    std::array<float, kMostLevels> units_{};
    std::vector<VertexHeights> vertices_;
    std::vector<float> texels_;
};

} // namespace apeiron::terrain
