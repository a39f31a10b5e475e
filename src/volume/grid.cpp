#include "volume/grid.hpp"

#include "volume/voxels.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace apeiron::volume {
namespace {

std::size_t sliceVoxels(const Volume& volume) {
    return static_cast<std::size_t>(volume.size.x) * static_cast<std::size_t>(volume.size.y);
}

/// The first voxel of a slice, counted in voxels.
std::size_t sliceOffset(const Volume& volume, int time, int channel, int z) {
    return channelOffset(volume, channel, time) + static_cast<std::size_t>(z) * sliceVoxels(volume);
}

bool isByte(VoxelType type) {
    return type == VoxelType::UInt8 || type == VoxelType::Int8;
}

enum class Texel { Byte, Half, Single };

Texel texelOf(VoxelType type, const BrickRanges& ranges) {
    if (isByte(type)) return Texel::Byte;
    if (type == VoxelType::Float16) return Texel::Half;
    if (type == VoxelType::Float32) return Texel::Single;
    // Half floats hold every whole number up to 2048.
    const bool exact = std::all_of(ranges.ranges.begin(), ranges.ranges.end(),
                                   [](glm::vec2 r) { return r.x >= -2048.0F && r.y <= 2048.0F; });
    return exact ? Texel::Half : Texel::Single;
}

gpu::GridFormat formatOf(Texel texel, int channels) {
    using gpu::GridFormat;
    static constexpr std::array kFormats{GridFormat::R8,   GridFormat::RG8,   GridFormat::RGBA8,
                                         GridFormat::R16F, GridFormat::RG16F, GridFormat::RGBA16F,
                                         GridFormat::R32F, GridFormat::RG32F, GridFormat::RGBA32F};
    const std::size_t column = channels == 1 ? 0 : (channels == 2 ? 1 : 2);
    return kFormats[3 * static_cast<std::size_t>(texel) + column];
}

/// Widens ranges by a row of values, one by one. In pieces of a fixed length: of those, compilers make vectors.
void widenRow(const float* __restrict values, std::size_t count, float* __restrict low, float* __restrict high) {
    constexpr std::size_t kPiece = 16;
    std::size_t i = 0;
    for (; i + kPiece <= count; i += kPiece)
        for (std::size_t k = i; k < i + kPiece; ++k) {
            low[k] = std::min(low[k], values[k]);
            high[k] = std::max(high[k], values[k]);
        }
    for (; i < count; ++i) {
        low[i] = std::min(low[i], values[i]);
        high[i] = std::max(high[i], values[i]);
    }
}

/// The largest of any range of a table (a sparse table: Bender & Farach-Colton 2000).
class RangeMaximum {
  public:
    explicit RangeMaximum(std::span<const float> values) {
        levels_.emplace_back(values.begin(), values.end());
        for (std::size_t half = 1; 2 * half <= values.size(); half *= 2) {
            const std::vector<float>& below = levels_.back();
            std::vector<float> level(values.size() - 2 * half + 1);
            for (std::size_t i = 0; i < level.size(); ++i)
                level[i] = std::max(below[i], below[i + half]);
            levels_.push_back(std::move(level));
        }
    }
    /// Of [first, last]. @pre first <= last < size
    float operator()(std::size_t first, std::size_t last) const {
        std::size_t level = 0;
        while ((std::size_t{2} << level) <= last - first + 1)
            ++level;
        const std::vector<float>& values = levels_[level];
        return std::max(values[first], values[last + 1 - (std::size_t{1} << level)]);
    }

  private:
    std::vector<std::vector<float>> levels_;
};

/// For each brick with nothing in it, how many there are to the nearest one with something, to any side, as a negative
/// number: by chamfer passes, which are exact for Chebyshev's distance (Rosenfeld & Pfaltz 1968).
void markFree(std::vector<float>& bricks, glm::ivec3 size) {
    const auto index = [&](int x, int y, int z) {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size.x) +
               static_cast<std::size_t>(x);
    };
    const int most = std::max({size.x, size.y, size.z});
    std::vector<int> distance(bricks.size());
    for (std::size_t i = 0; i < bricks.size(); ++i)
        distance[i] = bricks[i] > 0.0F ? 0 : most;
    const auto pass = [&](int direction) {
        for (int n = 0; n < size.z; ++n) {
            const int z = direction > 0 ? n : size.z - 1 - n;
            for (int m = 0; m < size.y; ++m) {
                const int y = direction > 0 ? m : size.y - 1 - m;
                for (int k = 0; k < size.x; ++k) {
                    const int x = direction > 0 ? k : size.x - 1 - k;
                    int& here = distance[index(x, y, z)];
                    if (here == 0) continue;
                    // The 13 neighbours that come before this one in the order of the pass.
                    for (int i = 0; i < 13; ++i) {
                        const int a = x + direction * (i % 3 - 1);
                        const int b = y + direction * (i / 3 % 3 - 1);
                        const int c = z + direction * (i / 9 - 1);
                        if (a < 0 || b < 0 || c < 0 || a >= size.x || b >= size.y || c >= size.z) continue;
                        here = std::min(here, distance[index(a, b, c)] + 1);
                    }
                }
            }
        }
    };
    pass(1);
    pass(-1);
    for (std::size_t i = 0; i < bricks.size(); ++i) {
        if (distance[i] > 0) bricks[i] = -static_cast<float>(distance[i]);
    }
}

} // namespace

void readSlice(const Volume& volume, int time, int channel, int z, std::span<float> out, std::size_t stride) {
    const std::size_t count = sliceVoxels(volume);
    assert(out.size() >= (count - 1) * stride + 1);
    visitVoxels(volume, sliceOffset(volume, time, channel, z), [&](const auto* voxels) {
        for (std::size_t i = 0; i < count; ++i) {
            const float value = number(voxels[i]);
            out[i * stride] = std::isfinite(value) ? value : 0.0F;
        }
    });
}

BrickRanges brickRanges(const Volume& volume, int time, int side) {
    return brickRanges(volume.size, volume.channels, side,
                       [&](int channel, int z, std::span<float> out) { readSlice(volume, time, channel, z, out); });
}

BrickRanges brickRanges(glm::ivec3 size, int channels, int side, const SliceReader& read) {
    assert(side >= 1);
    BrickRanges result;
    result.side = side;
    result.size = (size + side - 1) / side;
    result.channels = channels;
    const auto bricks = static_cast<std::size_t>(result.size.x) * static_cast<std::size_t>(result.size.y) *
                        static_cast<std::size_t>(result.size.z);
    constexpr float kMost = std::numeric_limits<float>::max();
    result.ranges.assign(bricks * static_cast<std::size_t>(channels), glm::vec2(kMost, -kMost));
    const auto width = static_cast<std::size_t>(size.x);
    std::vector<float> values(width * static_cast<std::size_t>(size.y));
    // Of the rows of a slice by bricks, for each column; then of all columns. A voxel counts for every brick that it is
    // next to.
    const auto rows = static_cast<std::size_t>(result.size.y);
    std::vector<float> low(rows * width);
    std::vector<float> high(rows * width);
    const auto first = [&](int i) { return std::max((i - 1) / side, 0); };
    const auto last = [&](int i, int count) { return std::min((i + 1) / side, count - 1); };
    for (int channel = 0; channel < channels; ++channel) {
        for (int z = 0; z < size.z; ++z) {
            read(channel, z, values);
            std::fill(low.begin(), low.end(), kMost);
            std::fill(high.begin(), high.end(), -kMost);
            for (int y = 0; y < size.y; ++y) {
                const float* line = &values[static_cast<std::size_t>(y) * width];
                for (int b = first(y); b <= last(y, result.size.y); ++b) {
                    const std::size_t at = static_cast<std::size_t>(b) * width;
                    widenRow(line, width, &low[at], &high[at]);
                }
            }
            for (std::size_t row = 0; row < rows; ++row) {
                for (int x = 0; x < result.size.x; ++x) {
                    const auto begin = static_cast<std::size_t>(std::max(x * side - 1, 0));
                    const auto end = std::min(static_cast<std::size_t>((x + 1) * side + 1), width);
                    glm::vec2 range(kMost, -kMost);
                    for (std::size_t i = row * width + begin; i < row * width + end; ++i)
                        range = {std::min(range.x, low[i]), std::max(range.y, high[i])};
                    for (int b = first(z); b <= last(z, result.size.z); ++b) {
                        glm::vec2& to = result.ranges[static_cast<std::size_t>(channel) * bricks +
                                                      (static_cast<std::size_t>(b) * rows + row) *
                                                          static_cast<std::size_t>(result.size.x) +
                                                      static_cast<std::size_t>(x)];
                        to = {std::min(to.x, range.x), std::max(to.y, range.y)};
                    }
                }
            }
        }
    }
    return result;
}

TexelForm texelForm(VoxelType type, const BrickRanges& ranges) {
    const Texel texel = texelOf(type, ranges);
    TexelForm form{formatOf(texel, ranges.channels)};
    if (texel == Texel::Byte) {
        form.scale = 255;
        form.offset = type == VoxelType::Int8 ? -128 : 0;
    }
    return form;
}

void encodeTexels(const TexelForm& form, std::span<const float> values, std::span<std::byte> texels) {
    const std::size_t bytes = static_cast<std::size_t>(gpu::bytesPerTexel(form.format)) /
                              static_cast<std::size_t>(gpu::channelsOf(form.format));
    assert(texels.size() == values.size() * bytes);
    const auto offset = static_cast<float>(form.offset);
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::byte* to = &texels[i * bytes];
        if (bytes == 1) {
            *to = static_cast<std::byte>(std::lround(values[i] - offset));
        } else if (bytes == 2) {
            const Half half = toHalf(values[i]);
            std::memcpy(to, &half.bits, sizeof half.bits);
        } else {
            std::memcpy(to, &values[i], sizeof(float));
        }
    }
}

gpu::Texture3D uploadGrid(const gpu::Context& context, const Volume& volume, int time, const TexelForm& form) {
    gpu::Texture3D texture(context, form.format, volume.size, "volume " + volume.name);
    const auto stride = static_cast<std::size_t>(gpu::channelsOf(form.format));
    const std::size_t count = sliceVoxels(volume) * stride;
    std::vector<float> values(count);
    std::vector<std::byte> texels(sliceVoxels(volume) * static_cast<std::size_t>(gpu::bytesPerTexel(form.format)));
    for (int z = 0; z < volume.size.z; ++z) {
        if (stride == 1 && volume.type == VoxelType::UInt8) {
            texture.upload({volume.voxels.data() + sliceOffset(volume, time, 0, z), count}, z, 1);
            continue;
        }
        for (int channel = 0; channel < volume.channels; ++channel)
            readSlice(volume, time, channel, z, std::span(values).subspan(static_cast<std::size_t>(channel)), stride);
        encodeTexels(form, values, texels);
        texture.upload(texels, z, 1);
    }
    context.check("uploading the volume");
    return texture;
}

std::optional<gpu::Texture3D> uploadCorners(const gpu::Context& context, const Volume& volume, int time,
                                            const BrickRanges& ranges, std::size_t limit) {
    const Texel texel = texelOf(volume.type, ranges);
    if (volume.channels != 1 || texel == Texel::Single) return std::nullopt;
    const glm::ivec3 size = volume.size + 1;
    const gpu::GridFormat format = texel == Texel::Byte ? gpu::GridFormat::RG32UI : gpu::GridFormat::RGBA32UI;
    const auto plane = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    const auto bytes = static_cast<std::size_t>(gpu::bytesPerTexel(format));
    const int most = context.capabilities().maxTextureSize3D;
    if (std::max({4 * size.x + 8, size.y, size.z}) > most || plane * static_cast<std::size_t>(size.z) * bytes > limit)
        return std::nullopt;
    const glm::ivec3 blocks = (size + 1) / 2;
    gpu::Texture3D texture(context, format, blocks * glm::ivec3(8, 1, 1), "corners of " + volume.name);
    const std::size_t count = sliceVoxels(volume);
    std::vector<float> values(count);
    const auto read = [&](int z, auto& slice) {
        using Word = typename std::remove_reference_t<decltype(slice)>::value_type;
        readSlice(volume, time, 0, z, values);
        for (std::size_t i = 0; i < count; ++i) {
            if constexpr (sizeof(Word) == 1) {
                const int lowest = volume.type == VoxelType::Int8 ? -128 : 0;
                slice[i] = static_cast<Word>(static_cast<int>(values[i]) - lowest);
            } else {
                slice[i] = toHalf(values[i]).bits;
            }
        }
    };
    const auto fill = [&](auto below) {
        using Word = typename decltype(below)::value_type;
        read(0, below);
        auto above = below;
        std::vector<Word> texels(64 * static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y));
        for (int z = 0; z < size.z; ++z) {
            if (z > 0 && z < volume.size.z) read(z, above);
            for (int y = 0; y < size.y; ++y) {
                const auto row = [&](const std::vector<Word>& slice, int which) {
                    return &slice[static_cast<std::size_t>(std::clamp(which, 0, volume.size.y - 1)) *
                                  static_cast<std::size_t>(volume.size.x)];
                };
                const std::array rows{row(below, y - 1), row(below, y), row(above, y - 1), row(above, y)};
                for (int x = 0; x < size.x; ++x) {
                    const int left = std::max(x - 1, 0);
                    const int right = std::min(x, volume.size.x - 1);
                    const int block = (y / 2 * blocks.x + x / 2) * 8 + x % 2 + 2 * (y % 2) + 4 * (z % 2);
                    Word* to = &texels[8 * static_cast<std::size_t>(block)];
                    for (const Word* from : rows) {
                        *to++ = from[left];
                        *to++ = from[right];
                    }
                }
            }
            if (z % 2 == 1 || z + 1 == size.z) texture.upload(std::as_bytes(std::span(texels)), z / 2, 1);
            std::swap(below, above);
            if (z + 1 >= volume.size.z) above = below;
        }
    };
    if (texel == Texel::Byte) {
        fill(std::vector<std::uint8_t>(count));
    } else {
        fill(std::vector<std::uint16_t>(count));
    }
    context.check("uploading the volume");
    return texture;
}

std::vector<float> majorants(const BrickRanges& ranges, std::span<const float> tables, std::size_t width,
                             std::span<const glm::dvec2> lookup) {
    const auto channels = static_cast<std::size_t>(ranges.channels);
    assert(tables.size() == width * channels && lookup.size() == channels);
    const std::size_t bricks = ranges.ranges.size() / channels;
    std::vector<float> result(bricks, 0.0F);
    for (std::size_t channel = 0; channel < channels; ++channel) {
        const RangeMaximum maximum(tables.subspan(channel * width, width));
        const auto texel = [&](float value) {
            const double place = lookup[channel].x * static_cast<double>(value) + lookup[channel].y;
            return std::clamp(place, 0.0, 1.0) * static_cast<double>(width - 1) + 0.5;
        };
        for (std::size_t i = 0; i < bricks; ++i) {
            const glm::vec2 range = ranges.ranges[channel * bricks + i];
            double low = texel(range.x);
            double high = texel(range.y);
            if (low > high) std::swap(low, high);
            // The shader's single precision may end up in the texel before or behind.
            const auto last = static_cast<double>(width - 1);
            const auto from = static_cast<std::size_t>(std::clamp(std::floor(low - 1e-2), 0.0, last));
            const auto to = static_cast<std::size_t>(std::clamp(std::floor(high + 1e-2), 0.0, last));
            result[i] += maximum(from, to);
        }
    }
    markFree(result, ranges.size);
    return result;
}

std::vector<float> crossings(const BrickRanges& ranges, double place, std::span<const glm::dvec2> lookup) {
    const auto channels = static_cast<std::size_t>(ranges.channels);
    assert(lookup.size() == channels);
    const std::size_t bricks = ranges.ranges.size() / channels;
    std::vector<float> result(bricks, 0.0F);
    for (std::size_t channel = 0; channel < channels; ++channel) {
        for (std::size_t i = 0; i < bricks; ++i) {
            const glm::dvec2 range(ranges.ranges[channel * bricks + i]);
            const double a = lookup[channel].x * range.x + lookup[channel].y;
            const double b = lookup[channel].x * range.y + lookup[channel].y;
            // With some room for single precision.
            if (std::min(a, b) <= place + 1e-5 && std::max(a, b) >= place - 1e-5) result[i] = 1.0F;
        }
    }
    markFree(result, ranges.size);
    return result;
}

} // namespace apeiron::volume
