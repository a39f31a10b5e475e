// Why a picture shows nothing, in words: an empty picture that does not say so looks like a broken program.

#include "session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace apeiron::session {
namespace {

/// What the layers of a picture hold.
struct Content {
    bool surface = false;    ///< somewhere
    bool background = false; ///< somewhere
    bool light = false;
    double nearest = std::numeric_limits<double>::infinity(); ///< surface
    double farthest = 0.0;
};

Content contentOf(const Session::Layers& layers) {
    Content content;
    for (int y = 0; y < layers.albedo.height(); ++y) {
        for (int x = 0; x < layers.albedo.width(); ++x) {
            const bool hit = layers.albedo.at(x, y)[3] > 0.0F;
            (hit ? content.surface : content.background) = true;
            const float* radiance = layers.radiance.at(x, y);
            content.light = content.light || std::max({radiance[0], radiance[1], radiance[2]}) > 0.0F;
            if (!hit) continue;
            const auto depth = static_cast<double>(layers.geometry.at(x, y)[3]);
            content.nearest = std::min(content.nearest, depth);
            content.farthest = std::max(content.farthest, depth);
        }
    }
    return content;
}

/// Inside, every ray ends where it starts: at once, or (where a formula's estimate never is quite 0) where the pixel's
/// footprint has outgrown the estimate, which is equally far for all.
bool isInside(const Content& content, double distance, double size) {
    if (content.background) return false;
    return content.farthest <= 1e-6 * size || distance <= 0.0 ||
           (content.farthest <= 1e-4 * size && content.farthest <= 1.3 * content.nearest);
}

} // namespace

std::string Session::emptyReason() {
    const auto& position = scene_.camera.get<parameter::Decimal3>("position");
    const glm::dvec3 place(position[0].toDouble(), position[1].toDouble(), position[2].toDouble());
    const Content content = contentOf(layers());
    const double distance = distanceToSurface();
    if (isInside(content, distance, std::max(glm::length(place), 1.0)) || (!content.surface && distance <= 0.0))
        return "the camera is inside the surface; move it (camera.position)";
    if (!content.surface) {
        return fmt::format("nothing is in view: the nearest surface is estimated {:.3g} away from the camera; turn the "
                           "camera (camera.target), or this formula has nothing there at these parameters",
                           distance);
    }
    if (!content.light)
        return "no light reaches what is in view; add lights, or raise environment.intensity or renderer.sky_light";
    return {};
}

} // namespace apeiron::session
