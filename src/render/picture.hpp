#pragma once

#include "gpu/texture.hpp"

namespace apeiron::render {

/// What renderers present and effects work on: HDR radiance (premultiplied) with coverage; normal and depth; albedo and
/// hit share.
struct Picture {
    Picture(const gpu::Context& context, glm::ivec2 size)
        : radiance(context, gpu::PixelFormat::RGBA32F, size, "picture radiance"),
          geometry(context, gpu::PixelFormat::RGBA32F, size, "picture geometry"),
          albedo(context, gpu::PixelFormat::RGBA32F, size, "picture albedo"),
          targets(context, {&radiance, &geometry, &albedo}) {}
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    gpu::Texture radiance; ///< rgb, w coverage
    gpu::Texture geometry; ///< xyz unit normal in world space, w distance from the camera
    gpu::Texture albedo;   ///< rgb, w part of the samples that hit something
    gpu::Targets targets;  ///< the three, in this order
};

} // namespace apeiron::render
