// The numbers behind the picture of a volume.

#include "core/error.hpp"
#include "session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apeiron::session {
namespace {

/// What a pixel shows is a mean over the pixel, in single precision: on the grid's border it may lie so far outside
/// [voxels].
constexpr double kBorder = 0.5;

/// A ray through the middle of a pixel, as camera.glsl makes them.
struct PixelRay {
    glm::dvec3 origin;    ///< from the camera [world units]
    glm::dvec3 direction; ///< of length 1
    double width;         ///< of the pixel at a distance of 1, or anywhere in parallel projection [world units]
    bool parallel;

    glm::dvec3 at(double distance) const { return origin + distance * direction; }
    double widthAt(double distance) const { return parallel ? width : width * distance; }
};

PixelRay rayThrough(const scene::Camera& eye, glm::ivec2 pixel, glm::ivec2 size) {
    const glm::dvec2 whole(size);
    const glm::dvec2 middle(glm::clamp(pixel, glm::ivec2(0), size - 1));
    const double width = eye.extent() / whole.y;
    const glm::dvec2 film = glm::dvec2(middle.x + 0.5 - 0.5 * whole.x, 0.5 * whole.y - middle.y - 0.5) * width;
    if (eye.node().text("projection") == "orthographic")
        return {eye.orientation() * glm::dvec3(film, 0.0), eye.forward(), width, true};
    return {glm::dvec3(0.0), eye.orientation() * glm::normalize(glm::dvec3(film, -1.0)), width, false};
}

/// The distance at which a ray meets a slice, if that is what is seen at `distance`; else that one. What is seen is
/// known to a part of a pixel and in single precision, slices are known exactly.
double sharpened(const volume::Shown& shown, const PixelRay& ray, glm::dvec3 eye, double distance) {
    const glm::dvec3 spacing = volume::spacing(*shown.volume);
    const double voxel = std::min({spacing.x, spacing.y, spacing.z});
    double nearest = ray.widthAt(distance) + 0.5 * voxel;
    double result = distance;
    for (const volume::SlicePlane& slice : shown.slices) {
        const std::optional<double> met = volume::distanceTo(slice, eye + ray.origin, ray.direction);
        if (!met) continue;
        const double apart = std::abs(glm::dot(slice.normal, eye + ray.at(distance)) - slice.offset);
        if (apart >= nearest) continue;
        nearest = apart;
        result = *met;
    }
    return result;
}

} // namespace

std::optional<glm::dvec3> Session::pointAt(glm::ivec2 pixel) {
    const std::optional<double> distance = distanceAt(pixel);
    if (!distance) return std::nullopt;
    return rayThrough(camera(), pixel, size()).at(*distance);
}

std::optional<volume::Reading> Session::valueAt(glm::ivec2 pixel) {
    const std::optional<volume::Shown> shown = volume();
    if (!shown) return std::nullopt;
    const std::optional<double> distance = distanceAt(pixel);
    if (!distance) return std::nullopt;
    const glm::dvec3 eye = render::difference(camera().position(), {});
    const PixelRay ray = rayThrough(camera(), pixel, size());
    const glm::dvec3 place = eye + ray.at(sharpened(*shown, ray, eye, *distance));
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
