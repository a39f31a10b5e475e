// Why a picture shows nothing, in words: an empty picture that does not say so looks like a broken program.

#include "session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace apeiron::session {
namespace {

/// Rows that are read back at once.
constexpr int kRows = 64;

/// What the rows of a picture hold that were looked at.
struct Content {
    bool surface = false;    ///< somewhere
    bool background = false; ///< somewhere
    bool light = false;
    double nearest = std::numeric_limits<double>::infinity(); ///< surface
    double farthest = 0.0;
};

void look(Content& content, const Session::Layers& layers) {
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
    const double scale = std::max(glm::length(place), 1.0);
    const double distance = distanceToSurface();
    present();
    const Phases::Scope reading(statistics_.phases, "read");
    Content content;
    const auto showsNothing = [&] { return !content.surface || !content.light || isInside(content, distance, scale); };
    const auto lookAt = [&](int first, int rows) {
        look(content, {picture_->radiance.download(first, rows), picture_->geometry.download(first, rows),
                       picture_->albedo.download(first, rows)});
    };
    // More rows can only take a reason away. One from the middle nearly always does, and costs next to nothing.
    const int height = size().y;
    lookAt(height / 2, 1);
    for (int first = 0; first < height && showsNothing(); first += kRows)
        lookAt(first, std::min(kRows, height - first));
    // A camera may be inside a volume; what hides one is not what hides a formula's surface.
    if (!content.surface && scene_.subject.type().name == "volume")
        return "nothing of the volume is in view; turn the camera (camera.target), let more of its values be seen "
               "(subject.transfer, subject.density), or cut away less (subject.clip, subject.clip_planes)";
    if (isInside(content, distance, scale) || (!content.surface && distance <= 0.0))
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
