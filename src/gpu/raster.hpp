#pragma once

#include "gpu/kernel.hpp"

#include <array>

namespace apeiron::gpu {

/// Vertices or indices in GPU memory. Needs its context current.
class Buffer {
  public:
    enum class Kind { Vertices, Indices };

    Buffer() = default;
    /// Copies `bytes`; for data that stay. @throws Error (Gpu) when memory runs out.
    Buffer(const Context& context, Kind kind, std::span<const std::byte> bytes, const std::string& label);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    /// Replaces everything; the driver keeps the old content for draws that still need it.
    void upload(std::span<const std::byte> bytes);

    explicit operator bool() const { return name_ != 0; }
    unsigned name() const { return name_; } ///< the GL name, for gpu/ only

  private:
    unsigned name_ = 0;
    unsigned target_ = 0;
};

/// Textures with a 32-bit float depth buffer, to draw into. References the textures; owns the depth buffer.
class DepthTargets {
  public:
    DepthTargets() = default;
    /// @param textures 1 to 4 of the same size @throws Error (Gpu) when the driver refuses.
    DepthTargets(const Context& context, const std::vector<const Texture*>& textures);
    ~DepthTargets();
    DepthTargets(DepthTargets&& other) noexcept;
    DepthTargets& operator=(DepthTargets&& other) noexcept;

    /// Makes all texels of all textures `value` and the depth that of the farthest.
    /// @param reversed 0 is far (see Raster::Depth)
    void clear(glm::vec4 value, bool reversed) const;
    /// The depth alone.
    void clearDepth(bool reversed) const;

    glm::ivec2 size() const { return size_; }
    unsigned framebuffer() const { return framebuffer_; } ///< the GL name, for gpu/ only

  private:
    unsigned framebuffer_ = 0;
    unsigned depth_ = 0;
    int textures_ = 0;
    glm::ivec2 size_{0};
};

/// Whether depth can be reversed: near 1, far 0 in a float buffer, with clip space from 0 to 1, so that its digits are
/// where they are needed (Reed 2015, "Depth Precision Visualized"). Everywhere but in WebGL 2 without EXT_clip_control.
bool canReverseDepth(const Context& context);

/// A program of a vertex and a fragment shader (GLSL ES 3.00), and how to draw with it. Both sources define `main`.
class Raster {
  public:
    /// Where a vertex shader's input comes from: floats or ints in a buffer.
    struct Attribute {
        const char* name;   ///< in GLSL
        int components;     ///< 1 to 4
        bool integers;      ///< ivecs
        bool perInstance;   ///< one a instance, else one a vertex
        std::size_t offset; ///< in its record [bytes]
    };

    enum class Depth {
        Reversed, ///< greater is nearer; clip space from 0 to 1. @pre canReverseDepth()
        Common,   ///< less is nearer; clip space from -1 to 1
    };

    /// @throws Error (Gpu) at file:line with the compiler's words.
    Raster(const Context& context, const std::string& label, const ShaderSource& vertex, const ShaderSource& fragment,
           std::vector<Attribute> attributes);
    ~Raster();
    Raster(const Raster&) = delete;
    Raster& operator=(const Raster&) = delete;

    /// Sets a uniform; names that the program does not use are ignored.
    void set(const char* name, int value);
    void set(const char* name, float value);
    void set(const char* name, glm::vec2 value);
    void set(const char* name, glm::vec3 value);
    void set(const char* name, glm::vec4 value);
    void set(const char* name, const glm::mat3& value);
    /// Binds a texture to a sampler uniform. It must live until the last draw().
    void set(const char* name, const Texture& texture);

    /// What is drawn: triangles (or lines) of indexed vertices, once for each instance.
    struct Mesh {
        const Buffer& vertices;
        std::size_t vertexBytes; ///< size of one vertex' record
        const Buffer& indices;   ///< 16-bit
        int indexCount;
        const Buffer& instances;
        std::size_t instanceBytes; ///< size of one instance's record
        bool lines = false;        ///< pairs of indices are lines
    };

    /// Draws instances [first, first + count). Returns at once; on a software device, when the last some ten thousand
    /// triangles are left to be drawn: such a driver keeps all that it has not drawn yet in memory.
    void draw(const DepthTargets& targets, const Mesh& mesh, int first, int count, Depth depth);

  private:
    int location(const char* name);
    void drawPart(const Mesh& mesh, int first, int count);
    /// Waits until no more than the last part is left to be drawn.
    void waitForParts();

    bool inParts_;                 ///< triangles are drawn some at a time
    std::array<void*, 2> parts_{}; ///< fences behind the last ones (GLsync), the older one first

    unsigned program_ = 0;
    unsigned vertexArray_ = 0;
    std::vector<Attribute> attributes_;
    std::vector<int> places_; ///< attribute locations; -1: not used
    std::unordered_map<std::string, int> locations_;
    struct Sampler {
        int unit;
        unsigned texture;
    };
    std::unordered_map<int, Sampler> samplers_; ///< by uniform location
};

} // namespace apeiron::gpu
