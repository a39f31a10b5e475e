/// The curve of Hejl & Burgess-Dawson (2010, "Filmic Tonemapping for Real-time Rendering"): a fit of Kodak's film, with hard blacks.
#pragma apeiron invalidates present

vec3 tonemap(vec3 color) {
    // Beyond 1e6 all is white, and squares stay what a float can hold.
    vec3 x = clamp(color - 0.004, 0.0, 1e6);
    vec3 encoded = x * (6.2 * x + 0.5) / (x * (6.2 * x + 1.7) + 0.06);
    return pow(encoded, vec3(2.2)); // it is made for displays of gamma 2.2; what follows here encodes for them again
}
