#pragma once

#include "gpu/kernel_cache.hpp"
#include "render/accumulation.hpp"
#include "render/interleave.hpp"
#include "render/picture.hpp"
#include "render/subject.hpp"
#include "render/view.hpp"

#include <limits>

namespace apeiron::render {

/// How much of the first sample is there, and what else may be shown meanwhile.
struct Progress {
    int blocks = -1; ///< complete sub-images of the first sample; -1: the accumulators are to be shown
    /// Of the sub-image in progress: the first texel computed and their number, in rows of its block, cyclically.
    glm::ivec2 band{0};
};

/// The picture of before the camera moved: what a new one has not computed yet is taken from it.
struct History {
    const Picture& picture;
    const View& view;       ///< under which it was made; of the same size and projection as the present one
    glm::vec3 offset{0.0F}; ///< from the present camera to its camera [world units]
    float scale = 1.0F;     ///< world units now per unit then
    float share = 0.0F;     ///< its weight where there are new values too, 0..1
};

/// How a picture comes about, in four verbs (after Lesar, Bohak & Marolt 2018): reset | generate -> integrate ->
/// present. The progressive loop drives them; each renderer owns the meaning of its buffers. Needs its context current.
class Renderer {
  public:
    virtual ~Renderer() = default;

    /// The scene's values have changed (camera, lights, parameters), but not its programs.
    virtual void setScene(const scene::Scene& scene, const View& view, const Subject& subject) = 0;

    /// Runs every kernel over nothing, with its buffers bound: drivers finish compiling at the first draw, for the
    /// formats and sizes of the textures that they meet there, and no step should wait for that. After setScene();
    /// forgets all samples.
    virtual void warmUp(const Picture& picture) = 0;

    /// Forgets all samples.
    virtual void reset() = 0;

    /// Whether the estimate has room for that interleaving: of the largest pictures, not for all.
    virtual bool holds(const Interleave& interleave) const = 0;

    /// Texels of the prepass, which follows a reset before the first generate().
    virtual glm::ivec2 prepassSize() const = 0;
    /// Works out a region of it.
    virtual void prepass(const gpu::Region& region) = 0;

    /// Leaves out pixels whose standard error is below that from now on [radiance]; 0: computes all.
    virtual void setErrorLimit(float limit) = 0;

    /// Whether the subject has to be drawn before that sample's first generate().
    virtual bool drawDue(std::uint32_t /*sample*/) const { return false; }
    /// Draws it.
    virtual void draw(std::uint32_t /*sample*/) {}

    /// Computes estimate number `sample` for a region of a sub-image. Estimates are laid out as one block per
    /// sub-image, so that each is compact.
    /// @param offset   the sub-image: its pixels are offset, offset + (factor, 0), ...
    /// @param region   of the block, from (0, 0)
    virtual void generate(std::uint32_t sample, const Interleave& interleave, glm::ivec2 offset,
                          const gpu::Region& region) = 0;

    /// Folds the complete estimate into the accumulators.
    virtual void integrate(const Interleave& interleave) = 0;

    /// Turns accumulators, or what is there of the first estimate, into a picture.
    /// @param history nullptr: what is not there is black
    virtual void present(Picture& picture, const Interleave& interleave, const Progress& progress,
                         const History* history) = 0;

    /// The accumulators, for saving and merging.
    virtual Accumulation accumulation() const = 0;

    /// Looks around from the camera, and along a way [world units]. Subjects without surfaces are never in it.
    virtual Surroundings lookAround(const scene::Scene& scene, const Subject& subject, glm::vec3 way) = 0;
};

/// A renderer whose verbs are kernels: `generate` from a module in a renderers/ folder, the others by its `integrate`
/// tag.
std::unique_ptr<Renderer> makeRenderer(const gpu::Context& context, gpu::KernelCache& cache,
                                       const BuildOptions& options, const scene::Scene& scene, const Subject& subject,
                                       glm::ivec2 size);

/// Bytes of GPU memory that makeRenderer(), a picture and a post chain take for each pixel.
constexpr std::int64_t kBytesPerPixel = 16LL * (3 + 2 * 4 + 3 + 2 + 1);
/// What reprojection takes in addition: the points, and another picture with them.
constexpr std::int64_t kBytesPerPixelToMove = 16LL * (1 + 4);

} // namespace apeiron::render
