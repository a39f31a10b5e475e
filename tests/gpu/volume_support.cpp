#include "volume_support.hpp"

#include "volume/source.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace apeiron::test {

std::shared_ptr<const volume::Volume> provide(const std::string& name, int size,
                                              const std::function<double(glm::dvec3, int)>& value, int channels) {
    volume::Volume made = volume::makeVolume(glm::ivec3(size), volume::VoxelType::Float32, channels);
    volume::centre(made, glm::dvec3(1.0));
    made.name = name;
    std::size_t i = 0;
    for (int channel = 0; channel < channels; ++channel) {
        for (int z = 0; z < size; ++z) {
            for (int y = 0; y < size; ++y) {
                for (int x = 0; x < size; ++x, ++i) {
                    const auto number =
                        static_cast<float>(value(glm::dvec3(x, y, z) + 0.5 - 0.5 * static_cast<double>(size), channel));
                    std::memcpy(&made.voxels[4 * i], &number, sizeof number);
                }
            }
        }
    }
    auto shared = std::make_shared<const volume::Volume>(std::move(made));
    volume::provideVolume(name, shared);
    return shared;
}

scene::Scene volumeScene(const std::string& source, double extent, glm::ivec2 size) {
    const double fov = glm::degrees(2.0 * std::atan(extent / 200.0));
    return sceneOf(fmt::format(
        R"({{"apeiron": 1,
        "camera": {{"position": ["0", "-100", "0"], "projection": "orthographic", "fov": {}, "filter": "box"}},
        "subject": {{"type": "volume", "source": "{}", "transfer": {}}},
        "renderer": {{"type": "mcm"}}, "lights": [],
        "environment": {{"type": "constant", "color": [0, 0, 0]}}, "post": {{"tonemapper": "linear"}},
        "output": {{"width": {}, "height": {}, "samples": 16}}}})",
        fov, source, uniformTransfer(1.0), size.x, size.y));
}

std::string uniformTransfer(double color) {
    return fmt::format(
        R"({{"window": "none", "space": "linear", "points": [{{"value": 0, "color": [{0}, {0}, {0}], "opacity": 1}}]}})",
        color);
}

MeanOf meanOf(const scene::Scene& scene) {
    const render::Accumulation a = rendered(scene)->accumulation();
    EXPECT_TRUE(allFinite(a.mean));
    MeanOf mean;
    const double pixels = static_cast<double>(a.mean.data().size() / 4);
    for (std::size_t i = 0; i < a.mean.data().size(); i += 4) {
        const double n = a.mean.data()[i + 3];
        mean.value += a.mean.data()[i + 1] / pixels;
        // Stratified samples err less than independent ones, of which this is the variance.
        if (n > 1.0) mean.variance += a.spread.data()[i + 1] / n / (n - 1.0) / (pixels * pixels);
    }
    return mean;
}

} // namespace apeiron::test
