/// The Sierpinski tetrahedron, kaleidoscopic: folds, a rotation and a scaling about a corner.
/// Sierpinski (1915); kaleidoscopic form by Knighty (2010); a lower bound of the distance to the last tetrahedra.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform float scale;   //! 2 [1.3, 4] step 0.01 | Factor of every iteration: 2 is Sierpinski's
uniform vec3 offset;   //! (1, 1, 1) [0, 2] step 0.01 | The corner that is scaled about
uniform vec3 rotation; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation before the folds, about x, y and z in turn
uniform vec3 rotation_after; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation after the folds
uniform int iterations; //! 9 [1, 30] | Iterations of the map
uniform float bailout; //! 100 [10, 10000] log | Escape radius

void iterate(inout Orbit orbit) {
    vec3 z = orbit.z;
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    if (z.x + z.y < 0.0) z.xy = -z.yx;
    if (z.x + z.z < 0.0) z.xz = -z.zx;
    if (z.y + z.z < 0.0) z.yz = -z.zy;
    if (rotation_after != vec3(0.0)) z = fold_rotation(rotation_after) * z;
    orbit.z = scale * z - offset * (scale - 1.0);
    orbit.derivative *= scale;
}

// Folds are isometries or contractions: the distance to the last tetrahedron, scaled back, never overshoots.
float estimate(Orbit orbit) {
    vec3 z = orbit.z;
    float plane = max(max(-z.x - z.y - z.z, z.x + z.y - z.z), max(z.y + z.z - z.x, z.x + z.z - z.y));
    return (plane - 1.0) * 0.577350269 / orbit.derivative;
}

float bound() {
    // The fixed point's distance, and what the last tetrahedron sticks out after the first contraction.
    return max(length(offset), 1.7320508) * 1.001 + 1.7320508 / pow(scale, float(iterations));
}
