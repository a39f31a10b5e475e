// Values between voxels, however the device reads them: devices that are software have a copy of bytes and half floats
// in which one texel holds all that is interpolated (values_corners.glsl). Single floats are interpolated by the device
// itself.

#include "volume_support.hpp"

#include "volume/source.hpp"

#include <cstring>

namespace apeiron::test {
namespace {

/// A small volume of odd sizes, whose voxels are as different from each other as their type allows.
template <class Word> std::shared_ptr<const volume::Volume> scattered(volume::VoxelType type, int low, int range) {
    volume::Volume made = volume::makeVolume(glm::ivec3(7, 5, 6), type, 1);
    volume::centre(made, glm::dvec3(1.0));
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < volume::voxelsPerChannel(made); ++i) {
        state = state * 1664525U + 1013904223U;
        const auto word = static_cast<Word>(low + static_cast<int>((state >> 8) % static_cast<std::uint32_t>(range)));
        std::memcpy(&made.voxels[i * sizeof(Word)], &word, sizeof word);
    }
    auto shared = std::make_shared<const volume::Volume>(std::move(made));
    return shared;
}

template <class Word> Image<float> picture(volume::VoxelType type, int low, int range, const char* renderer) {
    volume::provideVolume("scattered", scattered<Word>(type, low, range));
    scene::Scene scene = volumeScene("scattered", 12.0, {48, 48});
    scene.set("subject.transfer", Json::parse(R"({"window": "data", "space": "linear", "points": [
        {"value": 0, "color": [1, 0, 0], "opacity": 0}, {"value": 1, "color": [0, 1, 1], "opacity": 1}]})"));
    setAll(scene, {{"environment.color", "1,1,1"}, {"output.samples", "1"}, {"subject.density", "3"}});
    scene.set("renderer.type", std::string_view(renderer));
    return rendered(scene)->layers().radiance;
}

TEST(VolumeValues, are_the_same_in_all_types_of_voxels) {
    const auto compare = [](const Image<float>& a, const Image<float>& b, const char* what) {
        ASSERT_TRUE(allFinite(a));
        double spread = 0.0;
        for (std::size_t i = 0; i < a.data().size(); ++i) {
            spread = std::max(spread, static_cast<double>(std::abs(b.data()[i] - b.data()[0])));
            // Entries of the transfer function are 1/1023 apart; along the way through six voxels a few of them round
            // differently.
            ASSERT_NEAR(a.data()[i], b.data()[i], 2e-3) << what << ", value " << i;
        }
        EXPECT_GT(spread, 0.2) << what << ": there was nothing to compare";
    };
    using volume::VoxelType;
    for (const char* renderer : {"mip", "eam"}) {
        compare(picture<std::uint8_t>(VoxelType::UInt8, 0, 256, renderer),
                picture<float>(VoxelType::Float32, 0, 256, renderer), "bytes");
        compare(picture<std::int8_t>(VoxelType::Int8, -128, 256, renderer),
                picture<float>(VoxelType::Float32, -128, 256, renderer), "bytes with a sign");
        compare(picture<std::int16_t>(VoxelType::Int16, -1000, 3000, renderer),
                picture<float>(VoxelType::Float32, -1000, 3000, renderer), "half floats");
    }
}

} // namespace
} // namespace apeiron::test
