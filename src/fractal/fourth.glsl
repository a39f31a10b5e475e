// How orbits of four-dimensional numbers begin: in the slice of space whose fourth coordinate is `slice`. A Julia set has one
// constant; a Mandelbrot set's constant is the point itself.
#include "fractal/orbit.glsl"

void fourth_start(inout Orbit orbit, bool julia, vec4 constant, float slice) {
    orbit.w = slice;
    orbit.cw = slice;
    if (julia || orbit.dc == 0.0) {
        // A Julia constant of the subject's own takes the place of the first three components.
        if (orbit.dc != 0.0) orbit.c = constant.xyz;
        orbit.cw = constant.w;
        orbit.dc = 0.0;
    }
}
