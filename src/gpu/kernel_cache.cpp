#include "gpu/kernel_cache.hpp"

namespace apeiron::gpu {
namespace {

/// Drivers finish compiling at the first draw: draw nothing once, so that it is not counted as rendering.
void warmUp(const Context& context, Kernel& kernel, const std::vector<PixelFormat>& formats) {
    std::vector<Texture> textures;
    std::vector<const Texture*> pointers;
    textures.reserve(formats.size());
    for (const PixelFormat format : formats) {
        textures.emplace_back(context, format, glm::ivec2(8, 8), "warm-up");
        pointers.push_back(&textures.back());
    }
    const Targets targets(context, pointers);
    kernel.run(targets, {{0, 0}, {1, 1}}, {0, 0});
    context.finish();
}

} // namespace

std::shared_ptr<Kernel> KernelCache::get(const std::string& label, const ShaderSource& source, Stage stage,
                                         const std::vector<PixelFormat>& formats) {
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
        if (it->stage != stage || it->formats != formats || it->text != source.text()) continue;
        entries_.splice(entries_.begin(), entries_, it);
        return it->kernel;
    }
    auto kernel = std::make_shared<Kernel>(context_, label, source, stage, formats);
    warmUp(context_, *kernel, formats);
    entries_.push_front({source.text(), stage, formats, kernel});
    if (entries_.size() > kCapacity) entries_.pop_back();
    return kernel;
}

} // namespace apeiron::gpu
