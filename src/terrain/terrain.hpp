#pragma once

#include "render/subject.hpp"

namespace apeiron::terrain {

/// The `terrain` subject: fractal mountains without end, at any address (see height.hpp, address.hpp).
///
/// The world of its scenes is the local frame of the address's cell: one unit is the cell's edge, x and y from its
/// corner, z from that corner's height.
render::SubjectType subjectType();

} // namespace apeiron::terrain
