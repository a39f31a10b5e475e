// The numbers behind the picture of a volume.

#include "core/error.hpp"
#include "session/session.hpp"

#include <fmt/format.h>

#include <cmath>

namespace apeiron::session {
namespace {

/// What a pixel shows is a mean over the pixel, in single precision: on the grid's border it may lie so far outside
/// [voxels].
constexpr double kBorder = 0.5;

} // namespace

std::optional<glm::dvec3> Session::pointAt(glm::ivec2 pixel) {
    const std::optional<double> distance = distanceAt(pixel);
    if (!distance) return std::nullopt;
    // As camera.glsl makes rays, through the middle of the pixel.
    const scene::Camera eye = camera();
    const glm::dvec2 whole(size());
    const glm::dvec2 middle(glm::clamp(pixel, glm::ivec2(0), size() - 1));
    const glm::dvec2 film =
        glm::dvec2(middle.x + 0.5 - 0.5 * whole.x, 0.5 * whole.y - middle.y - 0.5) * (eye.extent() / whole.y);
    if (eye.node().text("projection") == "orthographic") return eye.orientation() * glm::dvec3(film, -*distance);
    return *distance * (eye.orientation() * glm::normalize(glm::dvec3(film, -1.0)));
}

std::optional<volume::Reading> Session::valueAt(glm::ivec2 pixel) {
    const std::optional<volume::Shown> shown = volume();
    if (!shown) return std::nullopt;
    const std::optional<glm::dvec3> point = pointAt(pixel);
    if (!point) return std::nullopt;
    const glm::dvec3 place = *point + render::difference(camera().position(), {});
    glm::dvec3 index(glm::inverse(shown->indexToScene) * glm::dvec4(place, 1.0));
    const glm::dvec3 last = glm::dvec3(shown->volume->size) - 0.5;
    const glm::dvec3 inside = glm::clamp(index, glm::dvec3(-0.5), last);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(inside[axis] - index[axis]) <= kBorder) index[axis] = inside[axis];
    return volume::readingAtIndex(*shown->volume, index, shown->time, shown->between);
}

std::optional<volume::Histogram> Session::histogram(int channel, int values, int gradients) const {
    const std::optional<volume::Shown> shown = volume();
    if (!shown) return std::nullopt;
    const volume::Volume& data = *shown->volume;
    if (channel < 0 || channel >= data.channels)
        throw Error(ErrorKind::BadInput, fmt::format("there is no channel {}: {} has {}, counted from 0", channel,
                                                     data.name, data.channels));
    constexpr int kMostValues = 4096;
    constexpr int kMostGradients = 1024;
    if (values < 1 || values > kMostValues || gradients < 1 || gradients > kMostGradients)
        throw Error(ErrorKind::BadInput, fmt::format("a histogram cannot have {} x {} classes", values, gradients), {},
                    fmt::format("choose 1 to {} values and 1 to {} gradients", kMostValues, kMostGradients));
    const volume::DataRange& range = shown->ranges[static_cast<std::size_t>(channel)];
    const auto [low, high] = volume::histogramAxis(range);
    if (gradients == 1) return volume::valueHistogram(data, low, high, values, channel, shown->time);
    return volume::jointHistogram(data, low, high, range.gradientHigh, values, gradients, channel, shown->time);
}

} // namespace apeiron::session
