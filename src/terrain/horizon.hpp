#pragma once

#include "terrain/frustum.hpp"

#include <array>
#include <cstddef>

namespace apeiron::terrain {

/// What ground that was drawn hides of what is behind it, by directions around the camera. Conservative: it may show
/// what is hidden, and never hides what is seen.
class Horizon {
  public:
    Horizon();

    /// Where the ground of four boxes [from the camera, z up] lies around the camera.
    struct Footprints {
        Boxes::Row first; ///< the directions in which it is seen; last - first < half of all
        Boxes::Row last;
        Boxes::Row top;    ///< the greatest slope under which something of it can be seen
        Boxes::Row bottom; ///< a ray below that meets it, where the box is crossed from side to side; -infinity: none
    };
    /// Whether the camera is neither over nor under a box.
    static bool isOutside(const Boxes& boxes, std::size_t i) {
        return boxes.least[0][i] > 0.0 || boxes.most[0][i] < 0.0 || boxes.least[1][i] > 0.0 || boxes.most[1][i] < 0.0;
    }
    /// Those of boxes that the camera is not outside of mean nothing.
    static Footprints footprints(const Boxes& boxes);

    /// Whether all of a box is below what is known to be ground before it.
    bool hides(const Footprints& boxes, std::size_t i) const;
    /// All ground in the box is at least as high as its bottom. Boxes come from near to far.
    void add(const Footprints& boxes, std::size_t i);

  private:
    static constexpr int kDirections = 512; ///< a power of two
    /// Calls work(first, count) for the parts of a range of directions that lie in one piece.
    template <class Work> static void eachPart(int first, int last, const Work& work);

    std::array<float, kDirections> slopes_{}; ///< below these all rays meet the ground
};

} // namespace apeiron::terrain
