#pragma once

#include "core/image.hpp"

#include <cstdint>

namespace apeiron::render {

/// What a renderer with means has accumulated, in CPU memory (see glsl/integrate_mean.glsl): 4 channels each.
/// The base for splitting work: samples [0, n) of one machine and [n, 2n) of another merge into [0, 2n).
struct Accumulation {
    Image<float> mean;   ///< rgb mean radiance, number of samples
    Image<float> spread; ///< rgb sum of squared deviations from the mean, mean coverage (alpha)
    Image<float> normal; ///< mean of the hits' normals, mean of the hits' depths, both over all samples
    Image<float> albedo; ///< mean of the hits' albedos, part of the samples that hit

    /// Adds another accumulation of the same size (Chan, Golub & LeVeque 1983, eq. 2.1).
    /// @throws Error (BadInput) when the sizes differ.
    void merge(const Accumulation& other);

    /// The most samples of any pixel.
    std::int64_t samples() const;

    /// Mean luminance of the picture [radiance].
    double luminance() const;

    /// Estimated noise: root mean square over the pixels of the standard error of the mean luminance, relative to the
    /// picture's mean luminance. 0 with less than two samples.
    double noise() const;
};

} // namespace apeiron::render
