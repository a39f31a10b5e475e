#pragma once

#include "gpu_support.hpp"
#include "volume/volume.hpp"

#include <functional>

namespace apeiron::test {

/// A volume of 1 mm voxels about the origin, its values given by a function of place [mm] and channel; known to scenes
/// by `name` from now on.
std::shared_ptr<const volume::Volume> provide(const std::string& name, int size,
                                              const std::function<double(glm::dvec3, int)>& value, int channels = 1);

/// A scene of the volume `source`: a box of `size` mm, seen along +y in parallel projection, `extent` mm of it, through
/// a box filter, in the dark, with the linear tone mapper.
scene::Scene volumeScene(const std::string& source, double extent, glm::ivec2 size = {32, 32});

/// Everything that has any value has that colour and opacity 1.
std::string uniformTransfer(double color);

/// Mean of all pixels of channel 1 and the variance of that mean.
struct MeanOf {
    double value = 0.0;
    double variance = 0.0;
};
MeanOf meanOf(const scene::Scene& scene);

} // namespace apeiron::test
