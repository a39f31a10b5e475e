/// The filmic curve of Hable (2010, "Filmic Tonemapping for Real-time Rendering"), with his constants: a toe that keeps blacks
/// deep, and a long shoulder.
#pragma apeiron invalidates present

uniform float white; //! 11.2 [1, 1000] log | Smallest radiance that is shown as white

vec3 curve(vec3 x) { return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3; }

// Twice the light goes in, as he does: middle grey then stays about where it is.
vec3 tonemap(vec3 color) {
    // Beyond the white point everything is white: there, squares could no longer be held by a float.
    return clamp(curve(2.0 * clamp(color, 0.0, white)) / curve(vec3(2.0 * white)), 0.0, 1.0);
}
