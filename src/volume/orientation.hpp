#pragma once

#include "volume/volume.hpp"

namespace apeiron::volume {

/// How a grid lies in the patient.
struct Orientation {
    std::string letters;   ///< where the axes x, y, z lead: "LPS", "RAS", ...; every letter's direction is used once
    double oblique = 0;    ///< largest angle between an axis and the direction of its letter [degrees]
    double shear = 0;      ///< by how much the most skewed pair of axes is off a right angle [degrees]
    bool mirrored = false; ///< left-handed
};

/// @pre indexToWorld has an inverse
Orientation orientationOf(const Volume& volume);

} // namespace apeiron::volume
