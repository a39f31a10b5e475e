#pragma once

#include "gpu/kernel.hpp"
#include "scene/scene.hpp"

namespace apeiron::render {

/// The picture that a scene's environment is made of, where its module asks for one: `#pragma apeiron picture NAME` in
/// it declares a parameter NAME with the file, and the module has a `uniform sampler2D picture`. Needs its context
/// current.
class EnvironmentPicture {
  public:
    /// Reads it. @throws Error (Io, BadInput) at environment.NAME
    EnvironmentPicture(const gpu::Context& context, const scene::Scene& scene);

    /// For a kernel with the environment in it.
    void bind(gpu::Kernel& kernel) const;

  private:
    gpu::Texture texture_; ///< none where the module asks for none
};

} // namespace apeiron::render
