/// The icosahedron's fractal, kaleidoscopic: folds with the fifteen mirrors of the icosahedron, a rotation and a scaling about a corner.
/// Knighty (2010), "Kaleidoscopic (escape time) IFS"; a lower bound of the distance to the last icosahedra.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;   //! 2.618034 [1.3, 4] step 0.01 | Factor of every iteration: at 2.618, the golden ratio plus 1, the icosahedra touch
uniform float bend;    //! 0 [-90, 90] unit deg | Moves the centre of the scaling from the corner (0) towards the middle of a face (37.4) or an edge
uniform vec3 rotation; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation before the folds, about x, y and z in turn
uniform vec3 rotation_after; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation after the folds
uniform int iterations; //! 6 [1, 20] | Iterations of the map
uniform float bailout; //! 100 [10, 10000] log | Escape radius

vec3 corner() { return fold_towards(fold_axis(5), fold_axis3(5), radians(bend)); }

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    z = fold_platonic(z, 5);
    if (rotation_after != vec3(0.0)) z = fold_rotation(rotation_after) * z;
    orbit.z = scale * z - (scale - 1.0) * corner();
    orbit.derivative *= scale;
}

// An icosahedron of circumradius 1 has its faces at 0.7947.
float estimate(Orbit orbit) {
    return (dot(fold_platonic(orbit.z, 5), fold_axis3(5)) - 0.794654472) / orbit.derivative;
}

float bound() { return 1.001 + 1.0 / pow(scale, float(iterations)); }
