#pragma once

#include "volume/volume.hpp"

#include <cassert>
#include <cstring>

namespace apeiron::volume {

/// A 16-bit float (IEEE 754 binary16) as it is stored.
struct Half {
    std::uint16_t bits = 0;
};

/// Exactly, infinities and NaN too.
inline float toFloat(Half half) {
    const auto bits = static_cast<std::uint32_t>(half.bits);
    const std::uint32_t sign = (bits & 0x8000U) << 16;
    std::uint32_t exponent = (bits >> 10) & 0x1FU;
    std::uint32_t mantissa = bits & 0x3FFU;
    if (exponent == 0x1F) {
        exponent = 0xFF;
    } else if (exponent != 0) {
        exponent += 112;
    } else if (mantissa != 0) {
        // Subnormal: shift until the leading one is where it is implied.
        exponent = 113;
        while ((mantissa & 0x400U) == 0) {
            mantissa <<= 1;
            --exponent;
        }
        mantissa &= 0x3FFU;
    }
    const std::uint32_t result = sign | (exponent << 23) | (mantissa << 13);
    float value = 0;
    std::memcpy(&value, &result, sizeof value);
    return value;
}

/// To the nearest, ties to even; beyond the range infinity.
inline Half toHalf(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    const auto sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000U);
    const std::uint32_t magnitude = bits & 0x7FFFFFFFU;
    if (magnitude > 0x7F800000U) return {static_cast<std::uint16_t>(sign | 0x7E00U)};
    if (magnitude >= 0x477FF000U) return {static_cast<std::uint16_t>(sign | 0x7C00U)};
    if (magnitude < 0x33000001U) return {sign};
    const auto exponent = static_cast<int>(magnitude >> 23) - 112;
    std::uint32_t mantissa = (magnitude & 0x7FFFFFU) | 0x800000U;
    const int drop = exponent >= 1 ? 13 : 14 - exponent;
    const std::uint32_t half = 1U << (drop - 1);
    const std::uint32_t rest = mantissa & ((1U << drop) - 1U);
    mantissa >>= drop;
    if (rest > half || (rest == half && (mantissa & 1U) != 0)) ++mantissa;
    // A carry out of the mantissa raises the exponent, as it should.
    const std::uint32_t result = exponent >= 1 ? (static_cast<std::uint32_t>(exponent - 1) << 10) + mantissa : mantissa;
    return {static_cast<std::uint16_t>(sign | result)};
}

// As numbers to calculate with.
inline float number(std::uint8_t v) {
    return v;
}
inline float number(std::int8_t v) {
    return v;
}
inline float number(std::uint16_t v) {
    return v;
}
inline float number(std::int16_t v) {
    return v;
}
inline float number(Half v) {
    return toFloat(v);
}
inline float number(float v) {
    return v;
}

/// Calls `use` with the voxels from `first` on as a `const T*` of the type in which they are stored; number() makes
/// floats of them. All stored values are exact as float.
template <class Use> decltype(auto) visitVoxels(const Volume& volume, std::size_t first, Use&& use) {
    // What std::vector<std::byte> owns is aligned for any of these types, and so is every multiple of their size.
    const std::byte* begin = volume.voxels.data() + first * bytesPerVoxel(volume.type);
    switch (volume.type) {
    case VoxelType::UInt8:
        return use(reinterpret_cast<const std::uint8_t*>(begin));
    case VoxelType::Int8:
        return use(reinterpret_cast<const std::int8_t*>(begin));
    case VoxelType::UInt16:
        return use(reinterpret_cast<const std::uint16_t*>(begin));
    case VoxelType::Int16:
        return use(reinterpret_cast<const std::int16_t*>(begin));
    case VoxelType::Float16:
        return use(reinterpret_cast<const Half*>(begin));
    case VoxelType::Float32:
        break;
    }
    return use(reinterpret_cast<const float*>(begin));
}

/// The voxels of a volume that is being made. @pre T is what volume.type says
template <class T> T* mutableVoxels(Volume& volume, std::size_t first = 0) {
    assert(sizeof(T) == bytesPerVoxel(volume.type));
    return reinterpret_cast<T*>(volume.voxels.data()) + first;
}

} // namespace apeiron::volume
