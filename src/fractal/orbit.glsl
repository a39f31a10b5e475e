// What a formula works on. A formula is one file that declares
//
//     uniform int iterations;           annotated, as all of its parameters
//     uniform float bailout;            annotated: the orbit has escaped when |z| is larger
//     void iterate(inout Orbit orbit)   one step of the map, with its derivative
//     float estimate(Orbit orbit)       the distance that the final orbit tells
//     void start(inout Orbit orbit)     optional: changes the orbit before the first step
//     float bound()                     optional: radius of a sphere around the origin that holds everything
//     const float step_factor           optional: by how much the estimate must be shortened to be a lower bound
//
// or, instead of iterate() and estimate(), nothing but its map: the distance then follows from the map's derivative, which
// is found by dual numbers. `iterations` and `bailout` are optional then.
//
//     vec3 map(vec3 z, vec3 c)          one step: z -> f(z, c)

struct Orbit {
    vec3 z;           // the point that is iterated
    float w;          // its fourth component, for maps of quaternions and their like; 0 at first
    vec3 c;           // the constant of the map: the starting point, or the Julia constant
    float cw;         // its fourth component; 0 at first
    float derivative; // length of the running derivative
    float dc;         // derivative of c: 1, or 0 where c is a constant (Julia sets)
    float r2;         // |z| squared, of this z and w
    int i;            // iterations done
};
