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

/// Whether things stand on their heads in a volume whose file does not say how it lies: what is cut off by the box, as
/// a neck is, is cut off below, and here it is above; or (CT) the end with more bone, a skull's, is below. Slices that
/// begin at the crown of a head are common.
bool isUpsideDown(const Volume& volume, const std::vector<DataRange>& ranges, int time = 0);

/// The direction from the middle of the volume to the camera of a first picture, of length 1: a little to the side of
/// the front. Patients are seen from the front, their left on the right of the picture; what lies on a microscope's
/// stage, and what is flat, from above.
/// @param extent of what is seen, along the world's axes [mm]
glm::dvec3 frontDirection(Modality modality, glm::dvec3 extent);

} // namespace apeiron::volume
