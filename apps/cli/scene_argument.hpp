#pragma once

#include "scene/scene.hpp"

#include <string>
#include <vector>

namespace apeiron::cli {

/// What SCENE may be, for help texts.
inline constexpr const char* kSceneHelp = "A scene's .json file, a picture by Apeiron (.png .jpg .exr), a volume "
                                          "(NRRD, NIfTI, MetaImage, TIFF, OpenVDB, a folder of "
                                          "DICOM), a gallery name (see 'apeiron list scenes'), or - for standard input";

/// Loads what a SCENE argument names. Paths inside a document are relative to its folder.
/// @throws Error (BadInput, Io).
scene::Scene loadScene(const std::string& argument);

/// Parses the document that an image file of ours holds. @throws Error (BadInput).
scene::Scene parseScene(const std::string& file, const std::string& text);

/// The embedded example scenes, sorted.
std::vector<std::string> galleryNames();

} // namespace apeiron::cli
