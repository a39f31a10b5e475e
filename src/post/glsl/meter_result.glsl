// The last pass, one pixel: the factor that brings the log-average luminance to the key (Reinhard et al. 2002, eq. 1 and 2),
// between two percentiles of the histogram, so that neither lamps nor deep shadows decide.

uniform sampler2D meter_histogram;
uniform int meter_bins;
uniform float meter_key;
uniform vec2 meter_percentiles; // 0..1

void kernel_main(ivec2 pixel, out vec4 factor) {
    float total = 0.0;
    for (int i = 0; i < meter_bins; ++i)
        total += texelFetch(meter_histogram, ivec2(i, 0), 0).x;
    vec2 range = meter_percentiles * total;
    float below = 0.0;
    float sum = 0.0;
    float weight = 0.0;
    for (int i = 0; i < meter_bins; ++i) {
        vec4 bin = texelFetch(meter_histogram, ivec2(i, 0), 0);
        float part = max(min(below + bin.x, range.y) - max(below, range.x), 0.0);
        sum += part * bin.y;
        weight += part;
        below += bin.x;
    }
    factor = vec4(weight > 0.0 ? exp2(clamp(log2(meter_key) - sum / weight, -100.0, 100.0)) : 1.0);
}
