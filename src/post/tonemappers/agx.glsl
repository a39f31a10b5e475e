/// AgX (Sobotka 2022): a sigmoid of the logarithm in primaries that are drawn together, so that bright saturated light fades to
/// white gently, without the hue shifts of a curve on each channel.
#pragma apeiron invalidates present

uniform float contrast;   //! 1 [0.5, 2] step 0.05 | Power applied behind the curve: 1 is the base look, 1.35 a punchy one
uniform float saturation; //! 1 [0, 2] step 0.05 | Distance from grey behind the curve: 1 is the base look, 1.4 a punchy one

// A sigmoid of slope 2 at the pivot that passes through (0, 0) and (1, 1); each side is a scaled x / (1 + x^p)^(1/p).
float sigmoid(float x) {
    const vec2 pivot = vec2(10.0 / 16.5, 0.5);
    bool toe = x < pivot.x;
    float power = toe ? 3.0 : 3.25;
    vec2 room = toe ? pivot : 1.0 - pivot;
    float rise = 2.0 * room.x;
    // The scale at which this side reaches the end of the room.
    float scale = rise / pow(pow(rise / room.y, power) - 1.0, 1.0 / power);
    float u = 2.0 * abs(x - pivot.x) / scale;
    float y = scale * u / pow(1.0 + pow(u, power), 1.0 / power);
    return clamp(toe ? pivot.y - y : pivot.y + y, 0.0, 1.0);
}

vec3 tonemap(vec3 color) {
    // Linear sRGB into the inset primaries, and back (in the decimals of Wrensch 2023, "Minimal AgX Implementation").
    const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051, 0.0784335999999992, 0.878468636469772,
                            0.0784336, 0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438, -0.0980208811401368, 1.15190312990417,
                             -0.0980434501171241, -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    // 10 stops below and 6.5 above middle grey.
    vec3 x = clamp((log2(max(inset * max(color, 0.0), 1e-10)) + 12.47393) / 16.5, 0.0, 1.0);
    vec3 y = vec3(sigmoid(x.r), sigmoid(x.g), sigmoid(x.b));
    y = pow(max(y, 1e-10), vec3(contrast));
    float luminance = dot(y, vec3(0.2126, 0.7152, 0.0722));
    y = luminance + saturation * (y - luminance);
    // The curve's values are those of a display of exponent 2.2.
    return pow(max(outset * y, 1e-10), vec3(2.2));
}
