#include "render/interleave.hpp"

#include <cassert>

namespace apeiron::render {

Interleave::Interleave(int factor)
    : factor_(factor), offsets_(static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor)) {
    assert(factor == 1 || factor == 2 || factor == 4 || factor == 8);
    for (int y = 0; y < factor; ++y) {
        for (int x = 0; x < factor; ++x) {
            // The coarsest bit of the offset is the lowest digit of the rank. Digits: (0,0) (1,1) (1,0) (0,1).
            int rank = 0;
            int weight = 1;
            for (int bit = factor / 2; bit > 0; bit /= 2, weight *= 4) {
                const bool bx = (x & bit) != 0;
                const bool by = (y & bit) != 0;
                rank += weight * (bx == by ? static_cast<int>(bx) : (bx ? 2 : 3));
            }
            offsets_[static_cast<std::size_t>(rank)] = {x, y};
            ranks_[static_cast<std::size_t>(y) * 8 + static_cast<std::size_t>(x)] = rank;
        }
    }
}

} // namespace apeiron::render
