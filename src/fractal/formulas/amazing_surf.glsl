/// The Amazing Surf: a Mandelbox whose box fold leaves the vertical axis alone, so that plains and towns grow instead of a cube.
/// Kali & DarkBeam (2012, fractalforums.com), after Lowe (2010); distance estimate r / |dr|.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;      //! 1.5 [1.05, 3] step 0.01 | Factor of every iteration
uniform vec2 fold;        //! (1, 1) [0.2, 2] step 0.01 | Where x and y are reflected
uniform float min_radius; //! 0.5 [0.05, 1] step 0.01 | Inside this radius the ball fold scales by a constant
uniform float fixed_radius; //! 1 [0.2, 2] step 0.01 | Inside this radius the ball fold inverts
uniform int ball;         //! sphere {sphere, cylinder} invalidates program | What the ball fold inverts in: a ball, or a cylinder about the vertical axis
uniform vec3 rotation;    //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation of every iteration, about x, y and z in turn
uniform vec3 shift;       //! (1, 1, 1) [-2, 2] step 0.01 | Factors of the point that every iteration adds
uniform int iterations;   //! 14 [1, 40] | Most iterations of the map
uniform float bailout;   //! 100 [100, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    z.xy = clamp(z.xy, -fold, fold) * 2.0 - z.xy;
    float r2 = ball == 0 ? dot(z, z) : dot(z.xy, z.xy);
    float fixed2 = fixed_radius * fixed_radius;
    float k = scale * max(fixed2 / clamp(r2, min_radius * min_radius, fixed2), 1.0);
    z *= k;
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    orbit.z = z + shift * orbit.c;
    orbit.derivative = orbit.derivative * k + orbit.dc * max(abs(shift.x), max(abs(shift.y), abs(shift.z)));
}

float estimate(Orbit orbit) { return sqrt(orbit.r2) / orbit.derivative; }

// Along an axis the orbit that alternates between both folds is the farthest one that stays: 2 f s (s + 1) / ((s - 1) (s + 1 - h)).
float bound() {
    vec2 half_width = 2.0 * fold * scale * (scale + 1.0) / ((scale - 1.0) * max(vec2(scale + 1.0) - shift.xy, 0.1));
    return min(1.2 * length(half_width) + 2.0, 60.0);
}
