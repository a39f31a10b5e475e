#pragma once

#include "scene/scene.hpp"

#include <string>

namespace apeiron::session {

/// A scene that shows a volume with no settings at all: from the side that one knows it by, in a dark studio, with the
/// transfer function that follows from the data. @param source as the parameter subject.source
scene::Scene volumeScene(const std::string& source, const std::string& title = {});

} // namespace apeiron::session
