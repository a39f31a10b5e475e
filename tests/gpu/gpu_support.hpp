#pragma once

#include "../temporary_folder.hpp"
#include "gpu/kernel.hpp"
#include "session/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

namespace apeiron::test {

/// The one context of the whole executable, with driver messages as errors; made at the first call.
const gpu::Context& context();

/// The default scene with a document's values over it. @param json as a scene file
scene::Scene sceneOf(const std::string& json);

/// A formula whose estimate is one expression of the point `p`: an exact distance, where that is one.
parameter::ModuleReference formulaOf(const std::string& estimate, double bound);

/// The distances of the unit sphere about the origin, and of that with a small one above it.
parameter::ModuleReference unitSphere();

/// A world whose every value is known: a grey unit sphere in the dark, seen from (0, -4, 0) through a box filter with
/// the linear tone mapper and a hit threshold of a twentieth of a pixel. Tests add what they are about.
scene::Scene darkSphere(glm::ivec2 size = {64, 64});

/// Sets values by path.
void setAll(scene::Scene& scene, std::initializer_list<std::pair<const char*, const char*>> values);

/// Works until output.samples are there.
void finish(session::Session& session);

/// A session of that scene, worked until output.samples are there.
std::unique_ptr<session::Session> rendered(const scene::Scene& scene,
                                           const session::Options& options = {.specialise = false});

/// Runs a kernel of `outputs` RGBA32F outputs over a picture of that size and reads them.
std::vector<Image<float>> runKernel(const gpu::ShaderSource& source, gpu::Stage stage, glm::ivec2 size,
                                    std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare = {});

/// The same for GLSL that stands on top of files of the engine's.
std::vector<Image<float>> runText(std::initializer_list<const char*> files, const std::string& text, glm::ivec2 size,
                                  std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare = {});

/// Runs GLSL against the scene's subject, camera, lights and environment: `text` may call whatever the renderers may.
std::vector<Image<float>> runOnScene(const scene::Scene& scene, const std::string& text, glm::ivec2 size,
                                     std::size_t outputs, const std::function<void(gpu::Kernel&)>& prepare = {});

/// Equal in every bit.
bool identical(const Image<float>& a, const Image<float>& b);

/// The largest difference of two values, and whether all are numbers.
double largestDifference(const Image<float>& a, const Image<float>& b);
bool allFinite(const Image<float>& image);

inline glm::dvec3 rgb(const float* texel) {
    return {texel[0], texel[1], texel[2]};
}

/// The Error that `action` throws; nothing when it does not.
template <class F> std::optional<Error> errorOf(const F& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    return std::nullopt;
}

} // namespace apeiron::test
