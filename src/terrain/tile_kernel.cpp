#include "terrain/tile_kernel.hpp"

#include "terrain/height_detail.hpp"

namespace apeiron::terrain {

void addHeightSource(gpu::ShaderSource& source) {
    source.addFile("terrain/glsl/height.glsl");
}

void setTile(gpu::Kernel& kernel, const Shape& shape, const Cell& cell, int levels) {
    const LevelUniforms uniforms = levelUniforms(shape, cell.level);
    const auto ints = [](const auto& values) { return std::span<const int>(values.data(), values.size()); };
    kernel.set("terrain_window", ints(cell.window));
    kernel.set("terrain_cell", glm::ivec2(static_cast<std::int32_t>(cell.x), static_cast<std::int32_t>(cell.y)));
    kernel.set("terrain_levels", levels);
    kernel.set("terrain_outer", static_cast<int>(detail::outerWeight(shape.kernel)));
    kernel.set("terrain_hash", ints(uniforms.hash));
    kernel.set("terrain_amplitude", ints(uniforms.amplitude));
    kernel.set("terrain_step", ints(uniforms.step));
}

} // namespace apeiron::terrain
