#include "core/resources.hpp"

#include <algorithm>

namespace apeiron {
namespace {

std::string_view fileName(std::string_view path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

} // namespace

std::optional<Resource> findResource(std::string_view path) {
    for (const Resource& resource : resources())
        if (resource.path == path) return resource;
    return std::nullopt;
}

std::vector<Resource> resourcesInFolder(std::string_view folder, std::string_view extension) {
    std::vector<Resource> found;
    for (const Resource& resource : resources()) {
        const std::string_view file = fileName(resource.path);
        if (file.size() == resource.path.size()) continue;
        const std::string_view parent = resource.path.substr(0, resource.path.size() - file.size() - 1);
        if (fileName(parent) == folder && file.size() > extension.size() && file.ends_with(extension))
            found.push_back(resource);
    }
    std::sort(found.begin(), found.end(),
              [](const Resource& a, const Resource& b) { return fileName(a.path) < fileName(b.path); });
    return found;
}

} // namespace apeiron
