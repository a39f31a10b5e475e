/// The Mosely snowflake: of the 27 parts of a cube all but the corners and the middle stay, as folds and a scaling.
/// Mosely (2006); kaleidoscopic form after Knighty (2010); a lower bound of the distance to the last cubes.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;    //! 3 [1.7, 4] step 0.01 | Factor of every iteration: 3 is Mosely's
uniform vec2 offset;    //! (1, 1) [0, 2] step 0.01 | The middle of an edge, which is scaled about
uniform vec3 rotation;  //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation between folds, about x, y and z in turn
uniform int iterations; //! 6 [1, 20] | Iterations of the map
uniform float bailout;  //! 100 [10, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = fold_sorted(orbit.z);
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    vec2 shift = offset * (scale - 1.0);
    // The part in the middle of a face is the mirror image of the part at its edge.
    float wall = 0.5 * shift.y / scale;
    z.y = abs(z.y - wall) + wall;
    orbit.z = scale * z - vec3(shift, 0.0);
    orbit.derivative *= scale;
}

float estimate(Orbit orbit) {
    vec3 q = abs(orbit.z) - 1.0;
    float outside = length(max(q, 0.0));
    return (outside + min(max(q.x, max(q.y, q.z)), 0.0)) / orbit.derivative;
}

float bound() { return max(length(offset), 1.7320508) * (scale < 2.0 ? 2.5 : 1.01); }
