/// Colours of your own, at equal distances, blended in linear light.
#include "fractal/gradient.glsl"

uniform int stops;   //! 5 [2, 5] | How many of the colours are used
uniform vec3 stop_1; //! (0.02, 0.03, 0.07) [0, 1] color | Colour at the palette's start
uniform vec3 stop_2; //! (0.10, 0.24, 0.40) [0, 1] color | Second colour
uniform vec3 stop_3; //! (0.85, 0.80, 0.68) [0, 1] color | Third colour
uniform vec3 stop_4; //! (0.80, 0.36, 0.08) [0, 1] color | Fourth colour
uniform vec3 stop_5; //! (0.25, 0.03, 0.02) [0, 1] color | Fifth colour

vec3 color(float t) {
    // Of five equal distances, as many as there are between the colours in use.
    return gradient_five(clamp(t, 0.0, 1.0) * (float(stops - 1) / 4.0), stop_1, stop_2, stop_3, stop_4, stop_5);
}
