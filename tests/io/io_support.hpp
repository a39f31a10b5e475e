#pragma once

#include "../unit/support.hpp"
#include "core/file.hpp"
#include "core/image.hpp"
#include "core/json.hpp"
#include "io/codec.hpp"
#include "render/accumulation.hpp"

#include <cstdint>

namespace apeiron::test {

/// Uniform numbers in [0, 1), the same every time (PCG-XSH-RR; O'Neill 2014).
class Random {
  public:
    float operator()() { return static_cast<float>(bits() >> 8) / 16777216.0F; }
    std::uint32_t bits() {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        const auto mixed = static_cast<std::uint32_t>(((state_ >> 18) ^ state_) >> 27);
        const auto turn = static_cast<std::uint32_t>(state_ >> 59);
        return (mixed >> turn) | (mixed << ((32 - turn) & 31));
    }

  private:
    std::uint64_t state_ = 1;
};

/// A picture of noise with the given alpha.
inline Image<float> noisePicture(int width, int height, float alpha) {
    Image<float> picture(width, height, 4);
    Random random;
    for (std::size_t i = 0; i < picture.data().size(); ++i)
        picture.data()[i] = i % 4 == 3 ? alpha : random();
    return picture;
}

/// An accumulation with plausible values; some pixels hit nothing.
inline render::Accumulation noiseAccumulation(int width, int height) {
    render::Accumulation all;
    Random random;
    for (Image<float>* image : {&all.mean, &all.spread, &all.normal, &all.albedo}) {
        *image = Image<float>(width, height, 4);
        for (float& value : image->data())
            value = random() - (image == &all.normal ? 0.5F : 0.0F);
    }
    for (std::size_t i = 0; i < all.mean.data().size(); i += 4) {
        all.mean.data()[i + 3] = 64.0F;
        const bool hit = i % 3 != 0;
        all.albedo.data()[i + 3] = hit ? 0.5F : 0.0F;
        all.normal.data()[i + 3] = hit ? 3.0F : 0.0F;
    }
    return all;
}

/// Writes a file as other programs might: without our metadata.
inline void writeEncoded(const std::filesystem::path& path, io::ImageFormat format, const io::Header& header,
                         io::SampleType type, const void* pixels) {
    writeFile(path, io::encode(format, header, type, pixels));
}

/// A scene-like document with characters of all kinds and about `size` bytes of GLSL.
inline Json document(std::size_t size = 0) {
    std::string source;
    while (source.size() < size)
        source += "float f(float x) { return x < 0.0 ? \"-\" : x; } // \xC3\xA4\t\\ & <>\r\n";
    return {{"apeiron", 1},
            {"title", "\xC3\x84pfel \xE6\xBC\xA2\xF0\x9F\x8E\x89 \"quoted\" \\ \x01 end"},
            {"subject", {{"type", "fractal"}, {"formula", {{"name", "mine"}, {"source", source}}}}}};
}

} // namespace apeiron::test
