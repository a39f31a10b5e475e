// The light meter's first pass: x the mean binary logarithm of luminance in one of the picture's blocks, y the part of it that
// counts: what is transparent or black says nothing of the light.

uniform sampler2D meter_color;
uniform ivec2 meter_size;   // of the picture [px]
uniform ivec2 meter_blocks; // of the grid

void kernel_main(ivec2 pixel, out vec4 block) {
    ivec2 from = pixel * meter_size / meter_blocks;
    ivec2 to = max((pixel + 1) * meter_size / meter_blocks, from + 1);
    float sum = 0.0;
    float weight = 0.0;
    for (int y = from.y; y < to.y; ++y) {
        for (int x = from.x; x < to.x; ++x) {
            vec4 color = texelFetch(meter_color, min(ivec2(x, y), meter_size - 1), 0);
            float luminance = dot(color.rgb, vec3(0.2126, 0.7152, 0.0722));
            if (!(luminance > 1e-30 && color.a > 1e-3)) continue;
            float alpha = min(color.a, 1.0);
            // Radiance is premultiplied.
            sum += alpha * log2(min(luminance / alpha, 1e30));
            weight += alpha;
        }
    }
    float area = float((to.x - from.x) * (to.y - from.y));
    block = vec4(weight > 0.0 ? sum / weight : 0.0, weight / area, 0.0, 1.0);
}
