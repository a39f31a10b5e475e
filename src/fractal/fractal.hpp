#pragma once

#include "render/subject.hpp"

namespace apeiron::fractal {

/// The `fractal` subject: a distance-estimated formula (formulas/NAME.glsl, or a user's file) as a surface.
render::SubjectType subjectType();

} // namespace apeiron::fractal
