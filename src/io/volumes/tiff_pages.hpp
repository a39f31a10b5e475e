#pragma once

#include "volume/volume.hpp"

#include <optional>
#include <string>
#include <vector>

namespace apeiron::io::volumes {

/// What a description says about the pages of a TIFF file.
struct PageOrder {
    int sizeX = 0, sizeY = 0; ///< of a page; 0: not told
    int sizeZ = 1, sizeC = 1, sizeT = 1;
    std::string order = "XYCZT";
    glm::dvec3 spacing{0}; ///< [mm]; 0: not told
    double timeStep = 0;   ///< [s]
    std::vector<std::string> channelNames;
    /// Where the plane of (z, c, t) is, at (t * sizeC + c) * sizeZ + z: a page, counted from 0; -1: nowhere.
    std::vector<int> pages;
    bool isOme = false;
};

/// Reads OME-XML (Open Microscopy Environment, schema 2016-06; earlier ones are alike) or ImageJ's description.
/// @param pageCount pages of the file, each of which has `samples` samples of a pixel
/// @returns nothing for any other description. @throws Error (Io) for one that makes no sense.
std::optional<PageOrder> pageOrder(const std::string& description, int pageCount, int samples);

} // namespace apeiron::io::volumes
