#pragma once

#include "gpu/kernel.hpp"
#include "terrain/height.hpp"

namespace apeiron::terrain {

/// Adds terrain/glsl/height.glsl: `ivec2 terrain_height(ivec2 vertex)`, what tileHeights() computes, on the GPU.
void addHeightSource(gpu::ShaderSource& source);

/// Sets the uniforms of terrain/glsl/height.glsl: of which tile heights are asked for. Needs the kernel's context
/// current. @param levels 1 to kMaxTileLevels, as in tileHeights()
void setTile(gpu::Kernel& kernel, const Shape& shape, const Cell& cell, int levels);

} // namespace apeiron::terrain
