#include "volume/slices.hpp"

#include "volume/declare.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::volume {
namespace {

/// The slices' switches, in order.
constexpr std::array kShown{"slice_x", "slice_y", "slice_z", "slice_oblique"};

} // namespace

std::array<SlicePlane, 4> slicePlanes(const parameter::Node& subject, const glm::dmat4& toWorld, glm::dvec3 size) {
    std::array<SlicePlane, 4> planes;
    const glm::dvec3 position = subject.vec3("slice_position");
    for (int axis = 0; axis < 3; ++axis) {
        SlicePlane& plane = planes[static_cast<std::size_t>(axis)];
        plane.normal = glm::dvec3(0.0);
        plane.normal[axis] = 1.0;
        plane.offset = position[axis];
    }
    const glm::dvec3 normal = subject.vec3("slice_normal");
    planes[3].normal = glm::normalize(normal);
    planes[3].offset = subject.number("slice_offset");
    if (subject.choice("slice_units") != 0) return planes;
    // Parts of the way through the box, whose middle and reach along the normal are these.
    const glm::dvec3 middle(toWorld * glm::dvec4(0.5 * size, 1.0));
    for (SlicePlane& plane : planes) {
        double reach = 0.0;
        for (int axis = 0; axis < 3; ++axis)
            reach += size[axis] * std::abs(glm::dot(plane.normal, glm::dvec3(toWorld[axis])));
        plane.offset = glm::dot(plane.normal, middle) + (plane.offset - 0.5) * reach;
    }
    return planes;
}

std::vector<SlicePlane> shownSlices(const parameter::Node& subject, const std::array<SlicePlane, 4>& planes) {
    std::vector<SlicePlane> shown;
    for (std::size_t i = 0; i < planes.size(); ++i)
        if (subject.flag(kShown[i])) shown.push_back(planes[i]);
    return shown;
}

std::optional<double> distanceTo(const SlicePlane& plane, glm::dvec3 origin, glm::dvec3 direction) {
    const double speed = glm::dot(plane.normal, direction);
    if (std::abs(speed) < 1e-12) return std::nullopt;
    const double distance = (plane.offset - glm::dot(plane.normal, origin)) / speed;
    return distance > 0.0 ? std::optional(distance) : std::nullopt;
}

std::vector<parameter::Parameter> sliceParameters() {
    using parameter::Type;
    constexpr double kFar = 1e6;
    return {
        Declare("slice_position", Type::Vec3, glm::dvec3(0.5),
                "Where the slices across x, y and z are, each along its axis of the world")
            .range(-kFar, kFar)
            .samples(),
        Declare("slice_normal", Type::Vec3, glm::dvec3(1.0), "What the oblique slice is perpendicular to")
            .range(-1.0, 1.0)
            .nonZero()
            .samples(),
        Declare("slice_offset", Type::Float, 0.5, "Where the oblique slice is, along its normal")
            .range(-kFar, kFar)
            .samples(),
        Declare("slice_units", Type::Choice, std::string("part"),
                "What slice_position and slice_offset count: parts of the way through the volume, 0 to 1, or "
                "millimetres from the world's origin")
            .choices({"part", "mm"})
            .samples(),
        Declare("slice_window", Type::Vec2, glm::dvec2(0.0),
                "Middle and width of the values that grey slices show from black to white; width 0: what the data "
                "has besides its background")
            .range(-kFar, kFar)
            .samples(),
    };
}

} // namespace apeiron::volume
