#pragma once

#include "core/math.hpp"
#include "parameter/node.hpp"

#include <array>
#include <optional>
#include <vector>

namespace apeiron::volume {

/// A plane through a volume that shows its values: dot(normal, p) = offset for p in the scene's world [mm].
struct SlicePlane {
    glm::dvec3 normal{0, 0, 1}; ///< of length 1
    double offset = 0.0;
};

/// Where the slices of a subject `volume` are: across x, y and z, and the oblique one.
/// @param subject its parameters slice_position, slice_normal, slice_offset, slice_units
/// @param toWorld from grid coordinates, whose box is 0 to `size`, to the scene's world [mm]
std::array<SlicePlane, 4> slicePlanes(const parameter::Node& subject, const glm::dmat4& toWorld, glm::dvec3 size);

/// Those of them that are shown.
std::vector<SlicePlane> shownSlices(const parameter::Node& subject, const std::array<SlicePlane, 4>& planes);

/// How far it is along a ray to a plane; nothing where the ray is parallel to it or leads away.
/// @param origin [mm] @param direction of length 1
std::optional<double> distanceTo(const SlicePlane& plane, glm::dvec3 origin, glm::dvec3 direction);

/// Parameters of slices that no shader sees.
std::vector<parameter::Parameter> sliceParameters();

} // namespace apeiron::volume
