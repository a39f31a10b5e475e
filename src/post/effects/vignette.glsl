/// Darkens the corners, as a lens does: natural vignetting, cos^4 of the field angle (Kingslake 1992).
#pragma apeiron invalidates present
#include "post/effect.glsl"

uniform float strength; //! 0.5 [0, 1] step 0.01 | 0: none; 1: as a lens that sees 90 degrees from corner to corner

void kernel_main(ivec2 pixel, out vec4 color) {
    vec2 p = (vec2(pixel) + 0.5 - 0.5 * vec2(effect_size)) / (0.5 * length(vec2(effect_size)));
    float cos2 = 1.0 / (1.0 + strength * dot(p, p));
    color = effect_at(pixel);
    color.rgb *= cos2 * cos2;
}
