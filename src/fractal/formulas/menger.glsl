/// The Menger sponge, as folds and a scaling about a corner.
/// Menger (1926); kaleidoscopic form after Knighty (2010), with the exact distance to the last cube.
#include "fractal/fold.glsl"
#pragma apeiron julia none
#include "fractal/orbit.glsl"

uniform float scale;    //! 3 [1.5, 4] step 0.01 | Factor of every iteration: 3 is Menger's
uniform vec3 offset;    //! (1, 1, 1) [0, 2] step 0.01 | The corner that is scaled about
uniform vec3 rotation;  //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation between folds, about x, y and z in turn
uniform int iterations; //! 6 [1, 20] | Iterations of the map
uniform float bailout;  //! 100 [10, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = fold_sorted(orbit.z);
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    vec3 shift = offset * (scale - 1.0);
    z = scale * z - shift;
    // The smallest coordinate is mirrored about the middle of the hole instead.
    if (z.z < -0.5 * shift.z) z.z += shift.z;
    orbit.z = z;
    orbit.derivative *= scale;
}

float estimate(Orbit orbit) {
    vec3 q = abs(orbit.z) - 1.0;
    float outside = length(max(q, 0.0));
    return (outside + min(max(q.x, max(q.y, q.z)), 0.0)) / orbit.derivative;
}

float bound() { return 1.7320508 * max(max(offset.x, max(offset.y, offset.z)), 1.0) * (scale < 2.0 ? 2.5 : 1.001); }
