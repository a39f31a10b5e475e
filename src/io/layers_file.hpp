#pragma once

#include "core/json.hpp"
#include "render/accumulation.hpp"

#include <filesystem>
#include <string>
#include <vector>

// Samples as files: OpenEXR with 32-bit float layers, a digital negative. Everything that was accumulated is in it, so
// that pictures can be developed from it and negatives of several machines merged.
//
//   R G B          mean linear radiance, before effects and tone mapping; premultiplied by A
//   A              mean coverage
//   Z              distance along the camera ray to what was hit [world units], mean over the hits;
//                  kNothing where nothing was hit
//   N.X N.Y N.Z    unit normal of what was hit, in world space; 0 where nothing was
//   albedo.R G B   mean albedo over all samples, 0 for those that hit nothing
//   samples        number of samples
//   spread.R G B   sum of squared deviations from the mean radiance: the variance times samples
//   raw.NX NY NZ   mean over all samples of the hits' normals, raw.Z of their distances
//   raw.hits       part of the samples that hit something
//
// Texts: "apeiron:scene" the document, "apeiron:samples" which samples they are.
namespace apeiron::io {

/// Z where nothing was hit: beyond any distance, and finite, so that filters make no NaN of it.
inline constexpr float kNothing = 1e30F;

/// Samples first, first + 1, ..., first + count - 1 of a scene.
struct SampleRange {
    std::int64_t first = 0;
    std::int64_t count = 0;
    bool operator==(const SampleRange&) const = default;
};

/// What a layers file holds.
struct Layers {
    render::Accumulation accumulation;
    std::string scene;                ///< the document's JSON text
    std::vector<SampleRange> samples; ///< sorted, without overlap
};

/// Writes an EXR file. Reading it gives the accumulation back bit by bit.
/// @throws Error (Io) when the file cannot be written; an old file is then untouched.
void writeLayers(const std::filesystem::path& path, const render::Accumulation& accumulation, const Json& scene,
                 const std::vector<SampleRange>& samples);

/// @throws Error (Io) for a missing or damaged file, one of another kind, and an EXR file without our layers.
Layers readLayers(const std::filesystem::path& path);

/// The samples of both. @throws Error (BadInput) when some are in both: they would count twice.
std::vector<SampleRange> joined(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b);

} // namespace apeiron::io
