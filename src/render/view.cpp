#include "render/view.hpp"

#include "scene/camera.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::render {

glm::dvec3 difference(const parameter::Decimal3& value, const parameter::Decimal3& origin) {
    return {(value[0] - origin[0]).toDouble(), (value[1] - origin[1]).toDouble(), (value[2] - origin[2]).toDouble()};
}

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
        const glm::vec3 color(light.vec3("color") * light.number("intensity"));
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
            const glm::vec3 place(difference(light.get<parameter::Decimal3>("position"), camera.position()));
            lightKinds_.push_back(1);
            lightPlaces_.emplace_back(place, static_cast<float>(light.number("radius")));
        }
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
    kernel.set("light_count", static_cast<int>(lightKinds_.size()));
    if (!lightKinds_.empty()) {
        kernel.set("light_kind", std::span<const int>(lightKinds_));
        kernel.set("light_place", std::span<const glm::vec4>(lightPlaces_));
        kernel.set("light_color", std::span<const glm::vec3>(lightColors_));
    }
    kernel.set("light_sun", sun_);
    kernel.set("environment_intensity", environmentIntensity_);
    kernel.set("environment_angle", environmentAngle_);
    kernel.set("environment_transparent", transparent_);
    kernel.set("random_seed", seed_);
}

} // namespace apeiron::render
