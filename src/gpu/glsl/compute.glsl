// The compute stage: one invocation a pixel, stores to images.

layout(local_size_x = 8, local_size_y = 8) in;
uniform ivec4 apeiron_region; // first texel and size

#if APEIRON_OUTPUTS > 0
layout(APEIRON_FORMAT_0, binding = 0) writeonly uniform highp APEIRON_IMAGE_0 apeiron_image_0;
#endif
#if APEIRON_OUTPUTS > 1
layout(APEIRON_FORMAT_1, binding = 1) writeonly uniform highp APEIRON_IMAGE_1 apeiron_image_1;
#endif
#if APEIRON_OUTPUTS > 2
layout(APEIRON_FORMAT_2, binding = 2) writeonly uniform highp APEIRON_IMAGE_2 apeiron_image_2;
#endif
#if APEIRON_OUTPUTS > 3
layout(APEIRON_FORMAT_3, binding = 3) writeonly uniform highp APEIRON_IMAGE_3 apeiron_image_3;
#endif

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), apeiron_region.zw))) return;
    ivec2 texel = apeiron_region.xy + ivec2(gl_GlobalInvocationID.xy);
    ivec2 pixel = (texel - apeiron_map.xy) * apeiron_stride + apeiron_map.zw;
    bool inside = all(lessThan(pixel, apeiron_size));
    APEIRON_TYPE_0 output_0 = APEIRON_TYPE_0(0);
#if APEIRON_OUTPUTS > 1
    APEIRON_TYPE_1 output_1 = APEIRON_TYPE_1(0);
#endif
#if APEIRON_OUTPUTS > 2
    APEIRON_TYPE_2 output_2 = APEIRON_TYPE_2(0);
#endif
#if APEIRON_OUTPUTS > 3
    APEIRON_TYPE_3 output_3 = APEIRON_TYPE_3(0);
#endif
#if APEIRON_OUTPUTS == 1
    if (inside) kernel_main(pixel, output_0);
#elif APEIRON_OUTPUTS == 2
    if (inside) kernel_main(pixel, output_0, output_1);
#elif APEIRON_OUTPUTS == 3
    if (inside) kernel_main(pixel, output_0, output_1, output_2);
#else
    if (inside) kernel_main(pixel, output_0, output_1, output_2, output_3);
#endif
    imageStore(apeiron_image_0, texel, output_0);
#if APEIRON_OUTPUTS > 1
    imageStore(apeiron_image_1, texel, output_1);
#endif
#if APEIRON_OUTPUTS > 2
    imageStore(apeiron_image_2, texel, output_2);
#endif
#if APEIRON_OUTPUTS > 3
    imageStore(apeiron_image_3, texel, output_3);
#endif
}
