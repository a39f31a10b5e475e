#include "volume/reading.hpp"

#include <cmath>

namespace apeiron::volume {
namespace {

/// Interpolates one channel. @param index inside the range of the voxels' centres
double linearAt(const Volume& volume, glm::dvec3 index, int channel, int time) {
    const glm::ivec3 last = volume.size - 1;
    const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(index)), last);
    const glm::dvec3 part = index - glm::dvec3(low);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis)
            weight *= step[axis] == 1 ? part[axis] : 1.0 - part[axis];
        // What has no part in it must not spoil it: 0 times NaN is NaN.
        if (weight > 0.0) sum += weight * valueAt(volume, glm::min(low + step, last), channel, time);
    }
    return sum;
}

} // namespace

std::optional<Reading> readingAtIndex(const Volume& volume, glm::dvec3 index, int time, Between between) {
    const glm::dvec3 size(volume.size);
    for (int axis = 0; axis < 3; ++axis)
        if (!(index[axis] >= -0.5 && index[axis] <= size[axis] - 0.5)) return std::nullopt;
    Reading reading;
    reading.position = glm::dvec3(volume.indexToWorld * glm::dvec4(index, 1.0));
    reading.voxel = glm::clamp(glm::ivec3(glm::floor(index + 0.5)), glm::ivec3(0), volume.size - 1);
    const glm::dvec3 inside = glm::clamp(index, glm::dvec3(0.0), size - 1.0);
    for (int channel = 0; channel < volume.channels; ++channel)
        reading.values.push_back(between == Between::Linear ? linearAt(volume, inside, channel, time)
                                                            : valueAt(volume, reading.voxel, channel, time));
    reading.names = volume.channelNames;
    reading.names.resize(volume.channelNames.empty() ? 0 : reading.values.size());
    reading.unit = volume.unit;
    return reading;
}

std::optional<Reading> readingAt(const Volume& volume, glm::dvec3 position, int time, Between between) {
    return readingAtIndex(volume, glm::dvec3(glm::inverse(volume.indexToWorld) * glm::dvec4(position, 1.0)), time,
                          between);
}

Json toJson(const Reading& reading) {
    Json values = Json::array();
    for (std::size_t i = 0; i < reading.values.size(); ++i)
        values.push_back({{"name", i < reading.names.size() ? reading.names[i] : ""},
                          {"value", std::isfinite(reading.values[i]) ? Json(reading.values[i]) : Json(nullptr)}});
    return {{"position", {reading.position.x, reading.position.y, reading.position.z}},
            {"voxel", {reading.voxel.x, reading.voxel.y, reading.voxel.z}},
            {"unit", reading.unit},
            {"values", std::move(values)}};
}

} // namespace apeiron::volume
