// The second pass: a histogram of the blocks. Pixel i is a bin of a quarter of a stop: x how much falls into it, y its mean logarithm.

uniform sampler2D meter_grid;
uniform ivec2 meter_blocks;
uniform int meter_bins;

void kernel_main(ivec2 pixel, out vec4 bin) {
    float sum = 0.0;
    float weight = 0.0;
    for (int y = 0; y < meter_blocks.y; ++y) {
        for (int x = 0; x < meter_blocks.x; ++x) {
            vec4 block = texelFetch(meter_grid, ivec2(x, y), 0);
            int place = clamp(int(floor(4.0 * block.x)) + meter_bins / 2, 0, meter_bins - 1);
            if (place != pixel.x) continue;
            sum += block.x * block.y;
            weight += block.y;
        }
    }
    bin = vec4(weight, weight > 0.0 ? sum / weight : 0.0, 0.0, 1.0);
}
