#include "render/view.hpp"

#include "scene/camera.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::render {

glm::dvec3 difference(const parameter::Decimal3& value, const parameter::Decimal3& origin) {
    return {(value[0] - origin[0]).toDouble(), (value[1] - origin[1]).toDouble(), (value[2] - origin[2]).toDouble()};
}

namespace {

/// Unit vectors along the width and the height of a rectangle whose front side looks along `front` (0: down), the
/// height being as near to +z as it can be before the roll [deg]. Their cross product is the direction of the front.
glm::dmat2x3 rectangleSides(glm::dvec3 front, double roll) {
    const double length = glm::length(front);
    front = length > 0.0 ? front / length : glm::dvec3(0, 0, -1);
    const glm::dvec3 up = std::abs(front.z) < 0.9999999 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(up, front));
    const glm::dvec3 y = glm::cross(front, x);
    const double c = std::cos(glm::radians(roll));
    const double s = std::sin(glm::radians(roll));
    return {c * x + s * y, c * y - s * x};
}

} // namespace

View::View(const scene::Scene& scene, glm::ivec2 size) : size_(size) {
    const scene::Camera camera(scene.camera);
    basis_ = glm::mat3(glm::mat3_cast(camera.orientation()));
    orthographic_ = scene.camera.text("projection") == "orthographic";
    extent_ = static_cast<float>(camera.extent());
    height_ = static_cast<float>(camera.position()[2].toDouble());
    filter_ = scene.camera.choice("filter");
    focus_ = static_cast<float>(camera.focus());
    lens_ = static_cast<float>(0.5 * scene.camera.number("aperture") * camera.focus());
    blades_ = static_cast<int>(scene.camera.integer("blades"));

    bool sunSeen = false;
    for (const parameter::Node& light : scene.lights) {
        glm::vec3 color(light.vec3("color") * light.number("intensity"));
        glm::vec4 x(0.0F);
        glm::vec4 y(0.0F);
        if (light.type().name == "sun") {
            const double azimuth = glm::radians(light.number("azimuth"));
            const double elevation = glm::radians(light.number("elevation"));
            const glm::vec3 direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                      std::sin(elevation));
            const double radius = std::tan(0.5 * glm::radians(std::min(light.number("size"), 170.0)));
            lightKinds_.push_back(0);
            lightPlaces_.emplace_back(direction, static_cast<float>(radius));
            if (!sunSeen) sun_ = direction;
            sunSeen = true;
        } else {
            const auto& position = light.get<parameter::Decimal3>("position");
            const glm::vec3 place(difference(position, camera.position()));
            if (light.type().name == "point") {
                lightKinds_.push_back(1);
                lightPlaces_.emplace_back(place, static_cast<float>(light.number("radius")));
            } else {
                const glm::dmat2x3 sides = rectangleSides(
                    difference(light.get<parameter::Decimal3>("target"), position), light.number("roll"));
                const double width = light.number("width");
                const double height = light.number("height");
                lightKinds_.push_back(2);
                lightPlaces_.emplace_back(place, light.get<bool>("visible") ? 1.0F : 0.0F);
                x = glm::vec4(glm::vec3(sides[0]), static_cast<float>(0.5 * width));
                y = glm::vec4(glm::vec3(sides[1]), static_cast<float>(0.5 * height));
                color /= static_cast<float>(width * height);
            }
        }
        lightX_.push_back(x);
        lightY_.push_back(y);
        lightColors_.push_back(color);
    }
    environmentIntensity_ = static_cast<float>(scene.environment.number("intensity"));
    environmentAngle_ = static_cast<float>(glm::radians(scene.environment.number("rotation")));
    transparent_ = scene.environment.text("background") == "transparent";
    seed_ = static_cast<std::uint32_t>(scene.output.integer("seed"));
}

void View::uploadAsHistory(gpu::Kernel& kernel, glm::vec3 offset, float scale) const {
    kernel.set("history_scale", scale);
    kernel.set("history_basis", basis_);
    kernel.set("history_extent", extent_);
    kernel.set("history_offset", offset);
}

void View::upload(gpu::Kernel& kernel) const {
    kernel.set("camera_basis", basis_);
    kernel.set("camera_size", size_);
    kernel.set("camera_extent", extent_);
    kernel.set("camera_height", height_);
    kernel.set("camera_orthographic", orthographic_);
    kernel.set("camera_filter", filter_);
    kernel.set("camera_lens", lens_);
    kernel.set("camera_focus", focus_);
    kernel.set("camera_blades", blades_);
    if (!lightKinds_.empty()) {
        kernel.set("light_kind", std::span<const int>(lightKinds_));
        kernel.set("light_place", std::span<const glm::vec4>(lightPlaces_));
        kernel.set("light_x", std::span<const glm::vec4>(lightX_));
        kernel.set("light_y", std::span<const glm::vec4>(lightY_));
        kernel.set("light_color", std::span<const glm::vec3>(lightColors_));
    }
    kernel.set("light_sun", sun_);
    kernel.set("environment_intensity", environmentIntensity_);
    kernel.set("environment_angle", environmentAngle_);
    kernel.set("environment_transparent", transparent_);
    kernel.set("random_seed", seed_);
}

} // namespace apeiron::render
