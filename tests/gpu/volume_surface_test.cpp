// Isosurfaces as surfaces: what renderers of surfaces ask of them, against closed forms.

#include "volume_support.hpp"

#include <cmath>

namespace apeiron::test {
namespace {

constexpr double kAlbedo = 0.5;

/// Red of a pixel that is (x, y) mm from the middle of a picture that shows `extent` mm.
double at(const Image<float>& radiance, double extent, double x, double y) {
    const int size = radiance.width();
    const auto pixel = [&](double offset) { return static_cast<int>((offset / extent + 0.5) * size); };
    return radiance.data()[4 * (static_cast<std::size_t>(pixel(y)) * static_cast<std::size_t>(size) +
                                static_cast<std::size_t>(pixel(x)))];
}

/// The surface where `value` [mm] is 0, a white diffuser in a white sky but for its albedo, with occlusion by rays.
Image<float> lit(const std::string& name, int size, const std::function<double(glm::dvec3)>& value, double extent) {
    provide(name, size, [&](glm::dvec3 p, int) { return value(p); });
    scene::Scene scene = volumeScene(name, extent);
    scene.set("subject.transfer", Json::parse(uniformTransfer(kAlbedo)));
    scene.set("renderer.type", std::string_view("raymarch"));
    setAll(scene, {{"environment.color", "1,1,1"},
                   {"subject.isovalue", "0"},
                   {"subject.iso_units", "value"},
                   {"renderer.brdf", "lambert"},
                   {"renderer.ambient_occlusion", "sampled"},
                   {"renderer.occlusion_rays", "64"},
                   {"output.samples", "4"}});
    return rendered(scene)->layers().radiance;
}

TEST(VolumeSurface, that_is_convex_sees_the_whole_sky) {
    const Image<float> picture = lit(
        "ball", 32, [](glm::dvec3 p) { return 12.0 - glm::length(p); }, 32.0);
    ASSERT_TRUE(allFinite(picture));
    for (const double x : {-9.0, -5.0, 0.0, 5.0, 9.0})
        for (const double y : {-5.0, 0.5, 5.0})
            EXPECT_NEAR(at(picture, 32.0, x, y), kAlbedo, 1e-3) << x << ", " << y;
    EXPECT_NEAR(at(picture, 32.0, 14.0, 14.0), 1.0, 1e-3) << "the sky beside it";
}

TEST(VolumeSurface, in_a_hemispherical_bowl_sees_half_of_the_sky) {
    // From every place of a sphere, a cap of the same sphere has the form factor area of the cap / area of the sphere.
    constexpr double kRadius = 24.0;
    const auto bowl = [](glm::dvec3 p) { return std::min(p.y, glm::length(p) - kRadius); };
    const Image<float> picture = lit("bowl", 72, bowl, 64.0);
    ASSERT_TRUE(allFinite(picture));
    double sum = 0.0;
    int count = 0;
    for (double x = -17.0; x <= 17.0; x += 2.0) {
        for (double y = -17.0; y <= 17.0; y += 2.0) {
            if (std::hypot(x, y) > 18.0) continue;
            const double value = at(picture, 64.0, x, y);
            // 256 stratified directions of which half are free: 3 standard errors of independent ones are 9 % of the
            // half; the rim takes up to 2 % more.
            EXPECT_NEAR(value, 0.5 * kAlbedo, 0.5 * 0.11 * kAlbedo) << x << ", " << y;
            sum += value;
            ++count;
        }
    }
    ASSERT_GT(count, 200);
    // The mean has no noise to speak of. Interpolation rounds the rim off by up to half a voxel, as if the bowl were so
    // much less deep: the part that is free grows by 0.5 / kRadius of itself.
    EXPECT_GT(sum / count, 0.5 * kAlbedo * 0.995);
    EXPECT_LT(sum / count, 0.5 * kAlbedo * (1.005 + 0.5 / kRadius));
}

} // namespace
} // namespace apeiron::test
