#include "io/radiance_file.hpp"

#include "core/error.hpp"
#include "render/picture_source.hpp"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace apeiron::io {
namespace {

constexpr int kLargest = 16'384; ///< pixels along an edge

float linear(float encoded) { // IEC 61966-2-1, backwards
    return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

} // namespace

Image<float> readRadiance(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& what) { return Error(ErrorKind::Io, what, path.string()); };
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) throw fail("there is no such file");
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) throw fail("cannot be read as a picture: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > kLargest || spec.height > kLargest || spec.depth > 1)
        throw fail("has a size that a picture of light cannot have");
    const auto channels = static_cast<std::size_t>(std::min(spec.nchannels, 4));
    const bool encoded = !spec.format.is_floating_point();
    const std::size_t pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    std::vector<float> values(pixels * channels);
    if (!input->read_image(0, 0, 0, static_cast<int>(channels), OIIO::TypeDesc::FLOAT, values.data()))
        throw fail("is damaged: " + input->geterror());
    Image<float> image(spec.width, spec.height, 3);
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = values[i * channels + (channels < 3 ? 0 : c)];
            image.data()[3 * i + c] = encoded ? linear(value) : value;
        }
    }
    return image;
}

void registerPictureFiles() {
    render::setPictureLoader(readRadiance);
}

} // namespace apeiron::io
