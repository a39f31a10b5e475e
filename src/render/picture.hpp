#pragma once

#include "gpu/texture.hpp"

namespace apeiron::render {

/// What renderers present and effects work on: HDR radiance (premultiplied) with coverage; normal and depth; albedo and
/// hit share.
struct Picture {
    /// @param withPoints with what each pixel shows, so that it can be seen from another place (see glsl/history.glsl)
    Picture(const gpu::Context& context, glm::ivec2 size, bool withPoints = false)
        : radiance(context, gpu::PixelFormat::RGBA32F, size, "picture radiance"),
          geometry(context, gpu::PixelFormat::RGBA32F, size, "picture geometry"),
          albedo(context, gpu::PixelFormat::RGBA32F, size, "picture albedo"),
          point(withPoints ? gpu::Texture(context, gpu::PixelFormat::RGBA32F, size, "picture point") : gpu::Texture()),
          targets(context, withPoints ? std::vector<const gpu::Texture*>{&radiance, &geometry, &albedo, &point}
                                      : std::vector<const gpu::Texture*>{&radiance, &geometry, &albedo}) {}
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    gpu::Texture radiance; ///< rgb, w coverage
    gpu::Texture geometry; ///< xyz unit normal in world space, w distance from the camera
    gpu::Texture albedo;   ///< rgb, w part of the samples that hit something
    gpu::Texture point;    ///< xyz from the camera, w 1; background: direction, w 0. Only if it is asked for
    gpu::Targets targets;  ///< all, in this order
    /// The accumulators that it was presented from (see glsl/accumulator_mean.glsl), the renderer's: for effects that
    /// want to know how sure a pixel is. Null while no sample is complete.
    mutable const gpu::Texture* mean = nullptr;
    mutable const gpu::Texture* spread = nullptr;
};

} // namespace apeiron::render
