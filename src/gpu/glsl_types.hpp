#pragma once

#include "gpu/glsl_syntax.hpp"

namespace apeiron::gpu::glsl {

/// Components of float (1), vec2, vec3, vec4; 0 for other types.
int floatSize(std::string_view type);
/// "float", "vec2", "vec3", "vec4"
std::string floatType(int size);
bool isMatrix(std::string_view type);

/// Indices of a swizzle's components in xyzw; empty when it is none.
std::vector<int> swizzle(std::string_view member);

/// The type of `a op b`.
std::string binaryType(const std::string& op, const std::string& a, const std::string& b);

/// The type that one of GLSL's own functions returns for arguments of these types; empty for an unknown function.
std::string builtinType(const std::string& function, const std::vector<std::string>& arguments);

} // namespace apeiron::gpu::glsl
