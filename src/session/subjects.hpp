#pragma once

#include "render/subject.hpp"

namespace apeiron::session {

/// All kinds of subject, the default one first.
const std::vector<render::SubjectType>& subjectTypes();

} // namespace apeiron::session
