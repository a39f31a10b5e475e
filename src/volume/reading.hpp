#pragma once

#include "core/json.hpp"
#include "volume/volume.hpp"

#include <optional>
#include <string>
#include <vector>

namespace apeiron::volume {

/// What a volume holds at a place.
struct Reading {
    glm::dvec3 position{0}; ///< in the world of the volume's file [mm]
    glm::ivec3 voxel{0};    ///< in which it lies, counted from 0
    /// As measured (slope and intercept applied), one for each channel. NaN where a voxel that has a part in it is.
    std::vector<double> values;
    std::vector<std::string> names; ///< of the channels; empty where the file has none
    std::string unit;               ///< of the values, "HU" for example; empty: unknown
};

/// How values between the centres of voxels come about.
enum class Between { Linear, Nearest };

/// What is at a place of the grid, where the centre of voxel (i, j, k) is (i, j, k) and the border of the grid half a
/// voxel beyond the first and the last. Between the outermost centres and the border values stay as they are, as in
/// pictures. Nothing outside.
/// @pre the point of time is in the volume
std::optional<Reading> readingAtIndex(const Volume& volume, glm::dvec3 index, int time = 0,
                                      Between between = Between::Linear);

/// What is at a place of the world [mm]; nothing outside. @pre as readingAtIndex(), and the axes of the grid span space
std::optional<Reading> readingAt(const Volume& volume, glm::dvec3 position, int time = 0,
                                 Between between = Between::Linear);

/// {"position": [x, y, z], "voxel": [i, j, k], "unit", "values": [{"name", "value"}, ...]}; null for what is no number.
Json toJson(const Reading& reading);

} // namespace apeiron::volume
