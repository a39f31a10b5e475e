/// Fold-and-cut polyhedra: one vertex anywhere in the wedge of a mirror group makes a uniform or near-uniform polyhedron, as a solid or
/// as a frame of rods and balls; more iterations put a smaller one onto every vertex.
/// Knighty (2012), "Fold and cut polyhedra", after Wythoff's construction (Coxeter 1935); a lower bound of the distance.
#include "fractal/fold.glsl"
#include "fractal/orbit.glsl"

uniform int symmetry;  //! icosahedral {tetrahedral, octahedral, icosahedral} invalidates program | The mirror group
uniform vec3 weights;  //! (0, 1, 0.6) [0, 1] step 0.01 | Where the vertex is: weights of the axes of twofold, highest and threefold symmetry
uniform int shape;     //! frame {solid, frame, both} invalidates program | Faces, or rods and balls, or faces set back behind rods
uniform float rod;     //! 0.035 [0.002, 0.3] step 0.001 | Radius of the rods
uniform float ball;    //! 0.075 [0, 0.4] step 0.001 | Radius of the balls
uniform float scale;   //! 3 [1.5, 6] step 0.01 | Factor of every further iteration
uniform vec3 rotation; //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation of every further iteration, about x, y and z in turn
uniform int iterations; //! 1 [1, 10] | Generations of polyhedra
uniform float bailout; //! 1000 [10, 10000] log | Not used: all generations count

int order() { return symmetry + 3; }

// On the unit sphere; weights of nothing at all are those of the middle.
vec3 vertex() {
    vec3 w = dot(weights, weights) > 1e-6 ? weights : vec3(1.0);
    return normalize(w.x * fold_axis2() + w.y * fold_axis(order()) + w.z * fold_axis3(order()));
}

// To the half rod from `v` to the mirror with that normal.
float to_rod(vec3 p, vec3 v, vec3 normal) {
    vec3 from = p - v;
    return length(from - min(dot(from, normal), 0.0) * normal);
}

float one(vec3 p) {
    vec3 z = fold_platonic(p, order());
    vec3 v = vertex();
    // The faces: around each of the three axes, through the vertex.
    vec3 from = z - v;
    float solid = max(dot(from, fold_axis2()), max(dot(from, fold_axis(order())), dot(from, fold_axis3(order()))));
    if (shape == 0) return solid;
    vec3 mirror = fold_mirror(order());
    float rods = min(to_rod(z, v, vec3(1.0, 0.0, 0.0)), min(to_rod(z, v, vec3(0.0, 1.0, 0.0)), to_rod(z, v, mirror)));
    float frame = min(rods - rod, length(from) - ball);
    return shape == 1 ? frame : min(frame, solid + 0.5 * rod);
}

// The constant of the map is not needed: `cw` keeps the distance to the generations so far.
void start(inout Orbit orbit) { orbit.cw = one(orbit.z); }

void iterate(inout Orbit orbit) {
    if (orbit.i + 1 >= iterations) return;
    vec3 z = fold_platonic(orbit.z, order()) - vertex();
    if (rotation != vec3(0.0)) z = fold_rotation(rotation) * z;
    orbit.z = scale * z;
    orbit.derivative *= scale;
    orbit.cw = min(orbit.cw, one(orbit.z) / orbit.derivative);
}

float estimate(Orbit orbit) { return orbit.cw; }

float bound() { return 1.0 + (iterations > 1 ? 1.0 / (scale - 1.0) : 0.0) + max(rod, ball) + 0.01; }
