/// The octahedron's fractal, kaleidoscopic: folds with all mirrors of the cube, a rotation and a scaling about a corner.
/// Knighty (2010), "Kaleidoscopic (escape time) IFS"; a lower bound of the distance to the last octahedra.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;   //! 2 [1.3, 4] step 0.01 | Factor of every iteration: at 2 the octahedra touch at their corners
uniform vec3 offset;   //! (1, 0, 0) [0, 2] step 0.01 | The corner that is scaled about
uniform vec3 rotation; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation before the folds, about x, y and z in turn
uniform vec3 rotation_after; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation after the folds
uniform int iterations; //! 8 [1, 30] | Iterations of the map
uniform float bailout; //! 100 [10, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    z = fold_sorted(z);
    if (rotation_after != vec3(0.0)) z = fold_rotation(rotation_after) * z;
    orbit.z = scale * z - offset * (scale - 1.0);
    orbit.derivative *= scale;
}

float estimate(Orbit orbit) {
    vec3 z = abs(orbit.z);
    return (z.x + z.y + z.z - 1.0) * 0.577350269 / orbit.derivative;
}

float bound() { return max(length(offset), 1.0) * 1.001 + 1.0 / pow(scale, float(iterations)); }
