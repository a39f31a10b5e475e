// The end of the chain: exposure, tone mapper, display encoding.

uniform sampler2D effect_color;
uniform float display_exposure;   // factor
uniform bool display_metered;     // there is one more factor ...
uniform sampler2D display_meter;  // ... of one texel
uniform float display_dither;     // size of one output step; 0: none
uniform bool display_flip;        // the target's first row is the bottom one
uniform int display_height;       // [px]
uniform vec3 display_background;  // what shows through where the picture is transparent (linear)
uniform bool display_opaque;

vec3 tonemapper_tonemap(vec3 color);

// IEC 61966-2-1.
vec3 display_srgb(vec3 c) {
    return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-9)), vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(c, vec3(0.0031308))));
}

float display_noise(ivec2 p, uint channel) {
    uint x = uint(p.x) * 0x9e3779b9u ^ uint(p.y) * 0x85ebca6bu ^ channel * 0xc2b2ae35u;
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return float(x >> 8) * (1.0 / 16777216.0) - 0.5;
}

void kernel_main(ivec2 pixel, out vec4 color) {
    ivec2 from = display_flip ? ivec2(pixel.x, display_height - 1 - pixel.y) : pixel;
    vec4 source = texelFetch(effect_color, from, 0);
    float alpha = clamp(source.a, 0.0, 1.0);
    // Radiance is premultiplied; tone curves are not linear, so they see the colour without its coverage.
    vec3 hdr = alpha > 0.0 ? source.rgb / alpha : vec3(0.0);
    float exposure = display_exposure;
    if (display_metered) exposure *= texelFetch(display_meter, ivec2(0), 0).x;
    vec3 ldr = tonemapper_tonemap(exposure * hdr);
    if (display_opaque) ldr = mix(display_background, ldr, alpha);
    vec3 encoded = display_srgb(clamp(ldr, 0.0, 1.0));
    encoded += display_dither * vec3(display_noise(from, 0u), display_noise(from, 1u), display_noise(from, 2u));
    color = vec4(clamp(encoded, 0.0, 1.0), display_opaque ? 1.0 : alpha);
}
