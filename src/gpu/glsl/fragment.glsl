// The fragment stage: a full-screen triangle whose fragments are the kernel's pixels.

#if APEIRON_OUTPUTS > 0
layout(location = 0) out APEIRON_TYPE_0 apeiron_output_0;
#endif
#if APEIRON_OUTPUTS > 1
layout(location = 1) out APEIRON_TYPE_1 apeiron_output_1;
#endif
#if APEIRON_OUTPUTS > 2
layout(location = 2) out APEIRON_TYPE_2 apeiron_output_2;
#endif
#if APEIRON_OUTPUTS > 3
layout(location = 3) out APEIRON_TYPE_3 apeiron_output_3;
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 pixel = (texel - apeiron_map.xy) * apeiron_stride + apeiron_map.zw;
#if APEIRON_OUTPUTS == 1
    apeiron_output_0 = APEIRON_TYPE_0(0);
    if (any(greaterThanEqual(pixel, apeiron_size))) return;
    kernel_main(pixel, apeiron_output_0);
#elif APEIRON_OUTPUTS == 2
    apeiron_output_0 = APEIRON_TYPE_0(0);
    apeiron_output_1 = APEIRON_TYPE_1(0);
    if (any(greaterThanEqual(pixel, apeiron_size))) return;
    kernel_main(pixel, apeiron_output_0, apeiron_output_1);
#elif APEIRON_OUTPUTS == 3
    apeiron_output_0 = APEIRON_TYPE_0(0);
    apeiron_output_1 = APEIRON_TYPE_1(0);
    apeiron_output_2 = APEIRON_TYPE_2(0);
    if (any(greaterThanEqual(pixel, apeiron_size))) return;
    kernel_main(pixel, apeiron_output_0, apeiron_output_1, apeiron_output_2);
#else
    apeiron_output_0 = APEIRON_TYPE_0(0);
    apeiron_output_1 = APEIRON_TYPE_1(0);
    apeiron_output_2 = APEIRON_TYPE_2(0);
    apeiron_output_3 = APEIRON_TYPE_3(0);
    if (any(greaterThanEqual(pixel, apeiron_size))) return;
    kernel_main(pixel, apeiron_output_0, apeiron_output_1, apeiron_output_2, apeiron_output_3);
#endif
}
