#pragma once

#include "render/subject.hpp"

namespace apeiron::volume {

/// The subject `volume`: a measured or generated grid of values, as `field` and `medium`.
render::SubjectType subjectType();

} // namespace apeiron::volume
