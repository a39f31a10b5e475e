#pragma once

#include "gpu/kernel.hpp"
#include "scene/scene.hpp"

namespace apeiron::render {

/// What kernels need to know of camera, lights and environment: worked out once per edit, uploaded to each kernel.
class View {
  public:
    /// @param size of the picture [px]
    View(const scene::Scene& scene, glm::ivec2 size);

    glm::ivec2 size() const { return size_; }

    /// Sets the uniforms of camera.glsl, light.glsl and environment.glsl.
    void upload(gpu::Kernel& kernel) const;

    /// Sets the uniforms of history.glsl: this view is the one of an older picture. @param offset from the present
    /// camera to this one [world units] @param scale world units now per unit then
    void uploadAsHistory(gpu::Kernel& kernel, glm::vec3 offset, float scale) const;

  private:
    glm::ivec2 size_;
    glm::mat3 basis_{1.0F};
    float extent_ = 1.0F;
    float height_ = 0.0F;
    bool orthographic_ = false;
    int filter_ = 0;
    float lens_ = 0.0F;
    float focus_ = 1.0F;
    int blades_ = 0;
    std::vector<int> lightKinds_;
    std::vector<glm::vec4> lightPlaces_;
    std::vector<glm::vec4> lightX_;
    std::vector<glm::vec4> lightY_;
    std::vector<glm::vec3> lightColors_;
    glm::vec3 sun_{0.0F, 0.0F, 1.0F};
    float environmentIntensity_ = 1.0F;
    float environmentAngle_ = 0.0F;
    bool transparent_ = false;
    std::uint32_t seed_ = 0;
};

/// `value - origin` in double: exact to double's precision of the difference, however many digits both have.
glm::dvec3 difference(const parameter::Decimal3& value, const parameter::Decimal3& origin);

} // namespace apeiron::render
