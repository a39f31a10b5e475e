#include "render/environment_picture.hpp"

#include "core/error.hpp"
#include "render/picture_source.hpp"

#include <algorithm>

namespace apeiron::render {

EnvironmentPicture::EnvironmentPicture(const gpu::Context& context, const scene::Scene& scene) {
    const auto& tags = scene.environment.module("type").tags;
    const auto tag = tags.find("picture");
    if (tag == tags.end()) return;
    const std::string& file = scene.environment.text(tag->second);
    Image<float> image(1, 1, 3);
    std::fill(image.data().begin(), image.data().end(), 1.0F);
    try {
        if (!file.empty()) image = loadPicture(file, std::min(4096, context.capabilities().maxTextureSize));
    } catch (const Error& error) {
        throw error.at("environment." + tag->second);
    }
    std::vector<float> texels;
    texels.reserve(4 * static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()));
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const float* pixel = image.at(x, y);
            texels.insert(texels.end(), {pixel[0], pixel[1], pixel[2], 1.0F});
        }
    }
    texture_ = gpu::Texture(context, gpu::PixelFormat::RGBA32F, {image.width(), image.height()}, "environment picture");
    texture_.upload(texels);
}

void EnvironmentPicture::bind(gpu::Kernel& kernel) const {
    if (texture_) kernel.set("environment_picture", texture_);
}

} // namespace apeiron::render
