#include "volume/large.hpp"

#include "volume/voxels.hpp"

#include <cmath>

namespace apeiron::volume {

LargeVolume inParts(std::shared_ptr<const Volume> volume) {
    LargeVolume large;
    large.form.size = volume->size;
    large.form.channels = volume->channels;
    large.form.timePoints = volume->timePoints;
    large.form.type = volume->type;
    large.form.slope = volume->slope;
    large.form.intercept = volume->intercept;
    large.form.indexToWorld = volume->indexToWorld;
    large.form.oriented = volume->oriented;
    large.form.timeStep = volume->timeStep;
    large.form.modality = volume->modality;
    large.form.unit = volume->unit;
    large.form.name = volume->name;
    large.form.channelNames = volume->channelNames;
    large.form.messages = volume->messages;
    large.read = [volume = std::move(volume)](const VoxelBox& box, int channel, int time, float* to) {
        visitVoxels(*volume, channelOffset(*volume, channel, time), [&](const auto* voxels) {
            const auto width = static_cast<std::size_t>(volume->size.x);
            const auto height = static_cast<std::size_t>(volume->size.y);
            for (int z = 0; z < box.size.z; ++z)
                for (int y = 0; y < box.size.y; ++y) {
                    const auto row =
                        static_cast<std::size_t>(box.first.z + z) * height + static_cast<std::size_t>(box.first.y + y);
                    const auto* from = voxels + row * width + box.first.x;
                    for (int x = 0; x < box.size.x; ++x) {
                        const float value = number(from[x]);
                        *to++ = std::isfinite(value) ? value : 0.0F;
                    }
                }
        });
    };
    return large;
}

glm::dmat4 coarserIndexToWorld(const glm::dmat4& indexToWorld, int level) {
    // The centre of coarse voxel i is at 2^l (i + 1/2) - 1/2.
    const double scale = std::exp2(level);
    const glm::dvec3 shift(0.5 * (scale - 1.0));
    return indexToWorld * glm::dmat4(glm::dvec4(scale, 0, 0, 0), glm::dvec4(0, scale, 0, 0), glm::dvec4(0, 0, scale, 0),
                                     glm::dvec4(shift, 1.0));
}

} // namespace apeiron::volume
