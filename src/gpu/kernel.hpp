#pragma once

#include "gpu/shader_source.hpp"
#include "gpu/texture.hpp"
#include "gpu/texture3d.hpp"

#include <unordered_map>

namespace apeiron::gpu {

/// Where a kernel's code runs.
enum class Stage {
    Fragment, ///< everywhere; the only one in WebGL 2
    Compute,  ///< GL >= 4.3 or ES >= 3.1
};

std::string_view toString(Stage stage);

/// A rectangle of target texels.
struct Region {
    glm::ivec2 origin{0};
    glm::ivec2 size{0};
};

/// How target texels map to the kernel's pixels: pixel = (texel - origin) * stride + offset.
/// The identity by default; sub-images of an interleaved picture otherwise.
struct PixelMap {
    glm::ivec2 origin{0};
    int stride = 1;
    glm::ivec2 offset{0};
};

/// The complete text of a kernel for a stage, as a compiler takes it.
/// @param formats of the outputs; as many as kernel_main has
/// @param version "300 es", "310 es" or "430"
std::string stageText(const ShaderSource& source, Stage stage, const std::vector<PixelFormat>& formats,
                      std::string_view version);

/// GLSL that computes one pixel, `void kernel_main(ivec2 pixel, out vec4 a, ...)`, compiled for a stage.
///
/// Pixels count from the top left. Outputs are at most 4; earlier state is read with texelFetch. Needs its context
/// current.
class Kernel {
  public:
    /// @param label for driver tools and messages
    /// @throws Error (BadInput) at file:line with the compiler's words for a user's file, (Gpu) for the engine's own.
    Kernel(const Context& context, const std::string& label, const ShaderSource& source, Stage stage,
           std::vector<PixelFormat> formats);
    ~Kernel();
    Kernel(Kernel&& other) noexcept;
    Kernel& operator=(Kernel&& other) noexcept;

    Stage stage() const { return stage_; }
    const std::vector<UniformBinding>& bindings() const { return bindings_; }

    /// Sets a uniform; names that the kernel does not use are ignored.
    void set(std::string_view name, bool value);
    void set(std::string_view name, int value);
    void set(std::string_view name, std::uint32_t value);
    void set(std::string_view name, float value);
    void set(std::string_view name, glm::ivec2 value);
    void set(std::string_view name, glm::vec2 value);
    void set(std::string_view name, glm::vec3 value);
    void set(std::string_view name, glm::vec4 value);
    void set(std::string_view name, const glm::mat3& value);
    void set(std::string_view name, std::span<const float> values);
    void set(std::string_view name, std::span<const int> values);
    void set(std::string_view name, std::span<const glm::vec3> values);
    void set(std::string_view name, std::span<const glm::vec4> values);
    /// Binds a texture to a sampler uniform. The texture must live until the next run().
    void set(std::string_view name, const Texture& texture);
    void set(std::string_view name, const Texture3D& texture);
    /// Sets every parameter that is bound to `slot` from the node.
    void setParameters(std::string_view slot, const parameter::Node& node);

    /// Runs over the texels of a region; returns at once, before the GPU has finished.
    /// @param size the picture: pixels at or beyond it write zero and do no work
    void run(const Targets& targets, const Region& region, glm::ivec2 size, const PixelMap& map = {});
    /// Runs over all texels of the targets.
    void run(const Targets& targets);

  private:
    int location(std::string_view name);
    void setSampler(std::string_view name, unsigned target, unsigned texture);

    unsigned program_ = 0;
    unsigned vertexArray_ = 0;
    Stage stage_ = Stage::Fragment;
    std::vector<PixelFormat> formats_;
    std::vector<UniformBinding> bindings_;
    std::unordered_map<std::string, int> locations_;
    struct Sampler {
        int unit;
        unsigned target;
        unsigned texture;
    };
    std::unordered_map<int, Sampler> samplers_; ///< by uniform location
};

} // namespace apeiron::gpu
