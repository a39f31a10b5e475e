#pragma once

#include "render/subject.hpp"
#include "volume/reading.hpp"
#include "volume/slices.hpp"
#include "volume/transfer_function.hpp"

#include <optional>

namespace apeiron::volume {

/// What a subject `volume` shows, for those who look at its data.
struct Shown {
    std::shared_ptr<const Volume> volume;
    int time = 0;
    std::vector<DataRange> ranges;          ///< of each channel
    std::vector<TransferFunction> transfer; ///< of each channel, in value units
    Modality modality = Modality::Unknown;
    Between between = Between::Linear;
    glm::dmat4 indexToScene{1}; ///< centre of voxel (i, j, k) -> the scene's world: the file's, or half a turn from it
    std::vector<SlicePlane> slices; ///< that are shown, in the scene's world
};

/// Nothing where the subject is another one. @param scene that the subject was made ready for
std::optional<Shown> shown(const render::Subject& subject, const scene::Scene& scene);

/// What an editor of transfer functions begins with: {"time", "unit", "modality", "channels": [{"name", "minimum",
/// "maximum", "low", "high", "gradient_high", "axis": [from, to], "transfer": {...}}, ...]}. The axis is what
/// histograms are shown over (see histogramAxis()); the transfer function is in value units.
Json toJson(const Shown& shown);

/// The subject `volume`: a measured or generated grid of values, as `field` and `medium`.
render::SubjectType subjectType();

} // namespace apeiron::volume
