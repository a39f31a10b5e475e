#include "render/picture_source.hpp"

#include "core/error.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::render {
namespace {

PictureLoader& theLoader() {
    static PictureLoader loader;
    return loader;
}

Image<float> halved(const Image<float>& image) {
    Image<float> half(std::max(image.width() / 2, 1), std::max(image.height() / 2, 1), image.channels());
    for (int y = 0; y < half.height(); ++y) {
        for (int x = 0; x < half.width(); ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                float sum = 0.0F;
                for (int i = 0; i < 4; ++i)
                    sum += image.at(std::min(2 * x + i % 2, image.width() - 1),
                                    std::min(2 * y + i / 2, image.height() - 1))[c];
                half.at(x, y)[c] = 0.25F * sum;
            }
        }
    }
    return half;
}

} // namespace

void setPictureLoader(PictureLoader loader) {
    theLoader() = std::move(loader);
}

Image<float> loadPicture(const std::filesystem::path& file, int limit) {
    if (!theLoader()) throw Error(ErrorKind::BadInput, "pictures cannot be read here", file.string());
    Image<float> image = theLoader()(file);
    if (image.channels() < 3 || image.width() < 1 || image.height() < 1)
        throw Error(ErrorKind::BadInput, "is no picture in colour", file.string());
    constexpr float kMost = 1e6F; // with room for sums of many
    for (float& value : image.data())
        value = std::isnan(value) ? 0.0F : std::clamp(value, 0.0F, kMost);
    while (std::max(image.width(), image.height()) > limit)
        image = halved(image);
    return image;
}

} // namespace apeiron::render
