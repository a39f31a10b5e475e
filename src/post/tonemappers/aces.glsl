/// The look of the Academy Color Encoding System: Hill's fit of its reference rendering and sRGB output transforms (2016). High
/// contrast, and bright colours that turn towards white.
#pragma apeiron invalidates present

vec3 tonemap(vec3 color) {
    // From linear sRGB to the primaries that the transforms work in, and back.
    const mat3 to = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 from = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    vec3 v = to * max(color, 0.0);
    v = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return clamp(from * max(v, 0.0), 0.0, 1.0);
}
