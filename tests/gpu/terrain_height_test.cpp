// The GLSL of the heights against the C++: every bit of a million vertices.

#include "gpu_support.hpp"

#include "terrain/tile_kernel.hpp"

#include <chrono>
#include <iostream>
#include <random>

namespace apeiron::test {
namespace {

using terrain::Kernel;
using terrain::Shape;
using terrain::VertexHeights;

constexpr int kLevels = 7;
constexpr int kSide = (1 << kLevels) + 3; // with a margin of 1

gpu::ShaderSource heightSource() {
    gpu::ShaderSource source;
    terrain::addHeightSource(source);
    // Halves of 16 bits: exact as floats.
    source.addText("test", R"(void kernel_main(ivec2 pixel, out vec4 heights) {
    ivec2 h = terrain_height(pixel - 1);
    heights = vec4(h >> 16, h & 0xffff).xzyw;
}
)");
    return source;
}

VertexHeights fromHalves(const float* halves) {
    const auto join = [](float high, float low) {
        return static_cast<std::int32_t>((static_cast<std::uint32_t>(static_cast<std::int32_t>(high)) << 16U) |
                                         static_cast<std::uint32_t>(low));
    };
    return {join(halves[0], halves[1]), join(halves[2], halves[3])};
}

/// Cells at the end of random paths, level 0 to 10,000: on the way down of few long ones.
std::vector<terrain::Cell> cellsOf(const Shape& shape, int count) {
    std::mt19937 random(shape.seed);
    std::vector<terrain::Cell> cells;
    terrain::Cell cell = terrain::rootCell(shape);
    for (int i = 0; i < count; ++i) {
        const auto level = static_cast<std::int64_t>(10'000) * i / (count - 1);
        while (cell.level < level)
            cell = terrain::childCell(shape, cell, static_cast<int>(random() % 4));
        cells.push_back(cell);
    }
    return cells;
}

TEST(TerrainGpu, heights_of_a_million_vertices_are_those_of_the_cpu_in_every_bit) {
    gpu::Kernel kernel(context(), "heights", heightSource(), gpu::Stage::Fragment, {gpu::PixelFormat::RGBA32F});
    const gpu::Texture texture(context(), gpu::PixelFormat::RGBA32F, {kSide, kSide}, "heights");
    const gpu::Targets targets(context(), {&texture});
    std::int64_t compared = 0;
    std::int64_t mismatches = 0;
    for (const Shape& shape : {Shape{Kernel::BSpline, 0xdecade, 1000}, Shape{Kernel::Bilinear, 77, 1000},
                               Shape{Kernel::BSpline, 0xffffffff, 800}, Shape{Kernel::Bilinear, 5, 415}}) {
        std::vector<VertexHeights> expected(static_cast<std::size_t>(kSide) * kSide);
        for (const terrain::Cell& cell : cellsOf(shape, 15)) {
            terrain::tileHeights(shape, cell, kLevels, 1, expected);
            terrain::setTile(kernel, shape, cell, kLevels);
            kernel.run(targets);
            context().finish();
            const Image<float> image = texture.download();
            for (std::size_t i = 0; i < expected.size(); ++i)
                mismatches += fromHalves(&image.data()[4 * i]) != expected[i] ? 1 : 0;
            compared += static_cast<std::int64_t>(expected.size());
        }
    }
    std::cout << compared << " vertices of levels 7 to 10,007 compared on " << context().capabilities().renderer << ", "
              << mismatches << " mismatches\n";
    EXPECT_EQ(mismatches, 0);
    EXPECT_GE(compared, 1'000'000);
}

TEST(TerrainGpu, both_stages_and_all_tile_sizes_give_the_same_heights) {
    const Shape shape{Kernel::BSpline, 31, 900};
    const terrain::Cell cell = cellsOf(shape, 30)[3];
    for (int levels = 1; levels <= terrain::kMaxTileLevels; ++levels) {
        const int side = (1 << levels) + 3;
        std::vector<VertexHeights> expected(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
        terrain::tileHeights(shape, cell, levels, 1, expected);
        for (const gpu::Stage stage : {gpu::Stage::Fragment, gpu::Stage::Compute}) {
            const Image<float> image = runKernel(heightSource(), stage, {side, side}, 1, [&](gpu::Kernel& kernel) {
                                           terrain::setTile(kernel, shape, cell, levels);
                                       }).front();
            std::int64_t mismatches = 0;
            for (std::size_t i = 0; i < expected.size(); ++i)
                mismatches += fromHalves(&image.data()[4 * i]) != expected[i] ? 1 : 0;
            EXPECT_EQ(mismatches, 0) << levels << " " << gpu::toString(stage);
        }
    }
}

} // namespace
} // namespace apeiron::test
