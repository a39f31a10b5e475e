#include "gpu/kernel_cache.hpp"

namespace apeiron::gpu {

std::shared_ptr<Kernel> KernelCache::get(const std::string& label, const ShaderSource& source, Stage stage,
                                         const std::vector<PixelFormat>& formats) {
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
        if (it->stage != stage || it->formats != formats || it->text != source.text()) continue;
        entries_.splice(entries_.begin(), entries_, it);
        return it->kernel;
    }
    auto kernel = std::make_shared<Kernel>(context_, label, source, stage, formats);
    entries_.push_front({source.text(), stage, formats, kernel});
    if (entries_.size() > kCapacity) entries_.pop_back();
    return kernel;
}

} // namespace apeiron::gpu
