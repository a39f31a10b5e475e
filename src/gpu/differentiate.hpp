#pragma once

#include <functional>
#include <string>
#include <vector>

namespace apeiron::gpu {

/// Differentiates GLSL: forward mode by dual numbers, from source to source.
///
/// For each of `roots`, functions that the text defines, and whatever they call, this gives a second function of the
/// same name whose floats and vectors carry their gradients with respect to a point in space (gpu/glsl/dual.glsl): of
/// `float f(vec3 p)` comes `Dual f(Dual3 p)`, and f(Dual3(p, mat3(1.0))).g is the gradient of f at p. Structs with
/// floats have a dual counterpart, `DualName`. What does not depend on a function's arguments stays as it is.
///
/// Plain code is understood: functions, declarations, assignments, swizzles, members, indices, if, for, while,
/// ternaries, constructors, GLSL's functions of floats and vectors, constant matrices, constants by macros.
///
/// Text with `dual.glsl` before it and the result behind it is complete.
/// @param where the place of a line of the text (from 1), for messages
/// @throws Error (BadInput) at the place of something else: matrices that depend on the point, arrays that do, switch,
///         global variables, assignments inside expressions.
std::string differentiate(const std::string& text, const std::vector<std::string>& roots,
                          const std::function<std::string(int line)>& where);

} // namespace apeiron::gpu
