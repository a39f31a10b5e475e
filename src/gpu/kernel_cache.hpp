#pragma once

#include "gpu/kernel.hpp"

#include <list>
#include <memory>

namespace apeiron::gpu {

/// Keeps the last compiled kernels, so that going back to an earlier choice costs nothing.
class KernelCache {
  public:
    explicit KernelCache(const Context& context) : context_(context) {}

    /// The kernel of that source, stage and formats; compiled if it is not there yet.
    /// @throws as Kernel's constructor.
    std::shared_ptr<Kernel> get(const std::string& label, const ShaderSource& source, Stage stage,
                                const std::vector<PixelFormat>& formats);

    static constexpr std::size_t kCapacity = 48;

  private:
    struct Entry {
        std::string text; ///< the whole source: a hash alone could collide
        Stage stage;
        std::vector<PixelFormat> formats;
        std::shared_ptr<Kernel> kernel;
    };
    const Context& context_;
    std::list<Entry> entries_; ///< most recently used first
};

} // namespace apeiron::gpu
