#pragma once

#include "parameter/parameter.hpp"

namespace apeiron::parameter {

/// Reads "nothing", "present", "samples" or "program". @throws Error (BadInput).
Invalidates parseInvalidates(std::string_view text);

/// The parameter that an annotated uniform declares; for the grammar see parseModule().
/// @param glslType   "float", "vec3", ...
/// @param annotation the text after `//!`
/// @param byDefault  what it invalidates where the annotation does not say
/// @throws Error (BadInput); its place is left to the caller.
Parameter parseAnnotation(std::string_view glslType, std::string name, std::string_view annotation,
                          Invalidates byDefault);

} // namespace apeiron::parameter
