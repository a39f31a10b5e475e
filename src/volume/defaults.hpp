#pragma once

#include "volume/transfer_function.hpp"
#include "volume/volume.hpp"

#include <vector>

// What a volume looks like as long as nobody says anything: a picture that a person who knows the field recognises.
namespace apeiron::volume {

/// Where the values of each channel lie. The window leaves out the background: the most frequent value and its noise,
/// where that is at the low end. Looks at the voxels: about 0.1 s for 256³.
std::vector<DataRange> dataRanges(const Volume& volume, int time = 0);

/// The `transfer` parameter's JSON that "auto" stands for: a preset for what made the data (CT in Hounsfield units,
/// MRI, simulation), colours by the channels' names for microscopy.
/// @param ranges as dataRanges() has them
Json automaticTransfer(const Volume& volume, const std::vector<DataRange>& ranges);

/// Whether the values are Hounsfield units.
bool inHounsfieldUnits(const Volume& volume, const std::vector<DataRange>& ranges);

/// The direction from the middle of the volume to the camera of a first picture, of length 1: a little to the side of
/// the front. Patients are seen from the front, their left on the right of the picture.
glm::dvec3 frontDirection();

/// How far the camera is from the middle so that the sphere around the volume fills the picture.
/// @param radius of that sphere @param fov of the narrower side of the picture [rad]
double framingDistance(double radius, double fov);

} // namespace apeiron::volume
