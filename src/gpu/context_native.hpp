#pragma once

#include <string>

namespace apeiron::gpu {

/// Whether GL_RENDERER names a rasteriser that runs on the CPU.
bool isSoftwareRenderer(const std::string& renderer);

/// What the platform reports as wrong with the current context (lost, reset, a driver's error message); empty when
/// well.
std::string nativeProblem();

} // namespace apeiron::gpu
