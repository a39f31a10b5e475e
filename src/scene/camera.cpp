#include "scene/camera.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace apeiron::scene {

using parameter::Decimal3;

namespace {

/// Nearest that orbit() comes to a pole [rad]: there, up and the view direction become parallel.
constexpr double kPoleMargin = 1e-3;

/// Digits that a move has below its own size: more than a double has, so that rounding never shows.
constexpr int kMoveDigits = 20;

/// Distances stay within what doubles hold with all their digits.
constexpr double kSmallestDistance = 1e-290;
constexpr double kLargestDistance = 1e290;

bool isFinite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

double largestComponent(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Length without the overflow and underflow of squares: offsets may be as small as 1e-290.
double length(const glm::dvec3& v) {
    return std::hypot(v.x, v.y, v.z);
}

/// @pre v is not zero
glm::dvec3 normalized(const glm::dvec3& v) {
    const glm::dvec3 scaled = v / largestComponent(v);
    return scaled / glm::length(scaled);
}

/// to - from: exact, then rounded once.
glm::dvec3 displacement(const Decimal3& to, const Decimal3& from) {
    glm::dvec3 result;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        result[i] = (to[axis] - from[axis]).toDouble();
    }
    return result;
}

/// The point moved by an offset, which is rounded far below its own size so that repeated moves do not lengthen the
/// decimals without limit.
Decimal3 moved(const Decimal3& point, const glm::dvec3& offset) {
    const double size = largestComponent(offset);
    if (size == 0 || !std::isfinite(size)) return point;
    const int places = kMoveDigits - static_cast<int>(std::floor(std::log10(size)));
    Decimal3 result;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        result[axis] = point[axis] + Decimal(offset[i]).rounded(places);
    }
    return result;
}

/// The axis that is least along `v`: never parallel to it.
glm::dvec3 otherAxis(const glm::dvec3& v) {
    const glm::dvec3 a = glm::abs(v);
    if (a.y <= a.x && a.y <= a.z) return {0, 1, 0};
    return a.x <= a.z ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
}

/// Camera to world, looking along `forward` (of length 1) with `up` upwards.
glm::dquat lookAlong(const glm::dvec3& forward, const glm::dvec3& up) {
    constexpr double kParallel = 1e-7; // sine below which the cross product has lost half its digits
    glm::dvec3 right = glm::cross(forward, up);
    if (glm::length(right) < kParallel) right = glm::cross(forward, otherAxis(forward));
    right = glm::normalize(right);
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(right, forward), -forward)));
}

glm::dquat turn(double angle, const glm::dvec3& axis) {
    return glm::angleAxis(angle, axis);
}

} // namespace

Camera::Camera(parameter::Node node) : node_(std::move(node)) {
    assert(node_.type().role == "camera");
}

bool Camera::orbiting() const {
    return node_.text("mode") == "orbit";
}

const Decimal3& Camera::position() const {
    return node_.get<Decimal3>("position");
}

const Decimal3& Camera::target() const {
    return node_.get<Decimal3>("target");
}

glm::dquat Camera::orientation() const {
    if (!orbiting()) {
        const auto& q = node_.get<glm::dvec4>("orientation");
        const glm::dvec4 unit =
            glm::normalize(q / std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z), std::abs(q.w)}));
        return {unit.w, unit.x, unit.y, unit.z};
    }
    const glm::dvec3 ahead = displacement(target(), position());
    const glm::dvec3 direction = ahead == glm::dvec3(0) ? glm::dvec3(0, 1, 0) : normalized(ahead);
    return lookAlong(direction, normalized(node_.vec3("up"))) *
           turn(glm::radians(node_.number("roll")), glm::dvec3(0, 0, 1));
}

glm::dvec3 Camera::forward() const {
    return orientation() * glm::dvec3(0, 0, -1);
}

glm::dvec3 Camera::right() const {
    return orientation() * glm::dvec3(1, 0, 0);
}

glm::dvec3 Camera::up() const {
    return orientation() * glm::dvec3(0, 1, 0);
}

double Camera::fov() const {
    return glm::radians(node_.number("fov"));
}

double Camera::distance() const {
    return length(displacement(target(), position()));
}

double Camera::extent() const {
    const double extent = 2.0 * std::tan(0.5 * fov());
    return node_.text("projection") == "orthographic" ? extent * distance() : extent;
}

double Camera::focus() const {
    const double focus = node_.number("focus");
    return focus > 0.0 ? focus : distance();
}

void Camera::focusOn(double distance, glm::dvec2 place, double aspect) {
    if (!std::isfinite(distance) || distance <= 0.0) return;
    double depth = distance;
    if (node_.text("projection") == "perspective") {
        const glm::dvec2 slope = place * std::tan(0.5 * fov()) * glm::dvec2(aspect, 1.0);
        depth /= std::sqrt(1.0 + glm::dot(slope, slope));
    }
    const parameter::Parameter& declared = node_.schema().at("focus");
    node_.set("focus", std::min(depth, declared.maximum.value()));
}

void Camera::frame(const glm::dvec3& center, double radius, double aspect, const glm::dvec3& front) {
    assert(radius > 0);
    const glm::dvec3 back = front == glm::dvec3(0.0) ? -forward() : normalized(front);
    const double half = std::min(fov() / 2, std::atan(std::tan(fov() / 2) * aspect));
    // Boxes do not fill their spheres.
    const double distance = std::clamp(0.9 * radius / std::sin(half), kSmallestDistance, kLargestDistance);
    const Decimal3 target{Decimal(center.x), Decimal(center.y), Decimal(center.z)};
    node_.set("target", target);
    node_.set("position", moved(target, distance * back));
}

void Camera::frame(const glm::dvec3& center, std::span<const glm::dvec3> points, double aspect,
                   const glm::dvec3& front) {
    assert(!points.empty());
    const glm::dvec3 back = normalized(front);
    const glm::dmat3 view = glm::mat3_cast(lookAlong(-back, normalized(node_.vec3("up"))));
    constexpr double kMargin = 1.08;
    const double tangent = std::tan(fov() / 2) / kMargin;
    // A point at p.z towards the camera is inside if |p.x - shift| <= slope (distance - p.z). The limits to both sides
    // decide how far away the camera must be at least, and where in between it looks.
    double distance = kSmallestDistance;
    glm::dvec2 shift(0.0);
    for (int axis = 0; axis < 2; ++axis) {
        const double slope = axis == 0 ? tangent * aspect : tangent;
        double most = -std::numeric_limits<double>::infinity();
        double least = std::numeric_limits<double>::infinity();
        for (const glm::dvec3& point : points) {
            const glm::dvec3 p = glm::transpose(view) * point;
            most = std::max(most, p[axis] + slope * p.z);
            least = std::min(least, p[axis] - slope * p.z);
            distance = std::max(distance, p.z + kSmallestDistance);
        }
        distance = std::max(distance, (most - least) / (2.0 * slope));
        shift[axis] = 0.5 * (most + least);
    }
    distance = std::min(distance, kLargestDistance);
    const glm::dvec3 middle = center + view * glm::dvec3(shift, 0.0);
    const Decimal3 target{Decimal(middle.x), Decimal(middle.y), Decimal(middle.z)};
    node_.set("target", target);
    node_.set("position", moved(target, distance * back));
}

void Camera::orbit(double yaw, double pitch) {
    if (!std::isfinite(yaw) || !std::isfinite(pitch)) return;
    makeOrbit();
    const glm::dvec3 offset = displacement(position(), target());
    const double radius = length(offset);
    if (radius == 0 || (yaw == 0 && pitch == 0)) return;

    // "Right" and "up" are those of the picture: with a rolled camera the two turns mix.
    const double roll = glm::radians(node_.number("roll"));
    const double turnRight = yaw * std::cos(roll) - pitch * std::sin(roll);
    const double turnUp = yaw * std::sin(roll) + pitch * std::cos(roll);

    const glm::dvec3 axis = normalized(node_.vec3("up"));
    const glm::dvec3 outward = normalized(offset);
    const glm::dvec3 sideways = lookAlong(-outward, axis) * glm::dvec3(1, 0, 0);
    // Horizontal direction from the target to the camera; well defined at the poles, too.
    const glm::dvec3 level = normalized(glm::cross(sideways, axis));
    const double limit = std::numbers::pi / 2 - kPoleMargin;
    const double elevation = std::atan2(glm::dot(outward, axis), glm::dot(outward, level));
    const double raised = std::clamp(elevation + turnUp, -limit, limit);
    const glm::dvec3 direction =
        std::cos(raised) * (std::cos(turnRight) * level + std::sin(turnRight) * sideways) + std::sin(raised) * axis;
    node_.set("position", moved(target(), radius * normalized(direction)));
}

void Camera::zoom(double factor) {
    assert(factor > 0);
    if (!std::isfinite(factor) || factor <= 0) return;
    if (!orbiting()) aimTarget();
    const glm::dvec3 offset = displacement(position(), target());
    const double radius = length(offset);
    if (radius == 0 || factor == 1) return;
    const double changed = std::clamp(radius * factor, kSmallestDistance, kLargestDistance);
    // From the target, not from the old position: a long way in would leave only the rounding of the step.
    node_.set("position", moved(target(), changed * normalized(offset)));
}

void Camera::pan(double right, double up) {
    const double height = 2 * distance() * std::tan(fov() / 2);
    const glm::dvec3 offset = orientation() * glm::dvec3(right * height, up * height, 0);
    if (!isFinite(offset)) return;
    const Decimal3 place = moved(position(), offset);
    node_.set("target", moved(target(), offset)); // by the same decimals: the distance does not change at all
    node_.set("position", place);
}

void Camera::fly(const glm::dvec3& offset) {
    const glm::dvec3 worldOffset = orientation() * offset;
    if (!isFinite(worldOffset)) return;
    makeFree();
    node_.set("target", moved(target(), worldOffset));
    node_.set("position", moved(position(), worldOffset));
}

void Camera::look(double yaw, double pitch, double roll) {
    if (!isFinite({yaw, pitch, roll})) return;
    makeFree();
    const glm::dquat turned =
        glm::normalize(orientation() * turn(yaw, {0, 1, 0}) * turn(pitch, {1, 0, 0}) * turn(roll, {0, 0, 1}));
    node_.set("orientation", glm::dvec4(turned.x, turned.y, turned.z, turned.w));
    aimTarget();
}

/// Keeps the present view, as a free orientation.
void Camera::makeFree() {
    if (!orbiting()) return;
    const glm::dquat q = orientation();
    node_.set("orientation", glm::dvec4(q.x, q.y, q.z, q.w));
    node_.set("mode", std::string("free"));
}

/// Keeps the present view, as a target with a roll.
void Camera::makeOrbit() {
    if (orbiting()) return;
    aimTarget();
    const glm::dquat free = orientation();
    node_.set("mode", std::string("orbit"));
    node_.set("roll", 0.0);
    // What is left between the two looks along the same direction: a turn around z.
    const glm::dquat rest = glm::conjugate(orientation()) * free;
    const double roll = glm::degrees(2 * std::atan2(rest.z, rest.w));
    node_.set("roll", std::clamp(std::remainder(roll, 360.0), -180.0, 180.0));
}

/// Puts the target straight ahead, as far away as it is.
void Camera::aimTarget() {
    const double radius = distance();
    if (std::isfinite(radius)) node_.set("target", moved(position(), radius * forward()));
}

} // namespace apeiron::scene
