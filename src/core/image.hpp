#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace apeiron {

/// A picture in CPU memory: `channels` interleaved values per pixel, rows from top to bottom, no padding.
template <class T> class Image {
  public:
    Image() = default;
    /// @pre width, height, channels >= 0; the caller has validated the size.
    Image(int width, int height, int channels)
        : width_(width), height_(height), channels_(channels),
          data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                static_cast<std::size_t>(channels)) {}

    int width() const { return width_; }
    int height() const { return height_; }
    int channels() const { return channels_; }
    bool empty() const { return data_.empty(); }

    /// The `channels()` values of the pixel in column x of row y (row 0 is the top one).
    T* at(int x, int y) { return data_.data() + offset(x, y); }
    const T* at(int x, int y) const { return data_.data() + offset(x, y); }

    std::vector<T>& data() { return data_; }
    const std::vector<T>& data() const { return data_; }

  private:
    std::size_t offset(int x, int y) const {
        assert(x >= 0 && x < width_ && y >= 0 && y < height_);
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels_);
    }

    int width_ = 0;
    int height_ = 0;
    int channels_ = 0;
    std::vector<T> data_;
};

} // namespace apeiron
