#include "fractal/orbit.glsl"

// A slot of a hybrid: how often its formula's turn comes, and what happens to the point before each of its steps.

uniform int repeat;          //! 1 [1, 40] | Steps of this formula before the next slot's turn comes; without slots it means nothing
uniform int pre_fold;        //! none {none, abs, abs_x, abs_y, abs_z, box, diagonal} invalidates program | Fold before each step: mirrors at the coordinate planes, at the faces of the cube of half width 1, or at the planes where two coordinates are equal
uniform vec3 pre_rotation;   //! (0, 0, 0) [-180, 180] unit deg step 1 | Rotation before each step, behind the fold: about x, y and z in turn
uniform float pre_scale;     //! 1 [0.1, 4] step 0.01 | Factor before each step, behind the rotation
uniform vec3 pre_offset;     //! (0, 0, 0) [-4, 4] step 0.01 | Shift before each step, behind the factor

vec3 fold(vec3 z) {
    if (pre_fold == 1) return abs(z);
    if (pre_fold == 2) return vec3(abs(z.x), z.yz);
    if (pre_fold == 3) return vec3(z.x, abs(z.y), z.z);
    if (pre_fold == 4) return vec3(z.xy, abs(z.z));
    if (pre_fold == 5) return clamp(z, -1.0, 1.0) * 2.0 - z;
    // The three mirrors sort the coordinates: the largest first.
    z.xy = vec2(max(z.x, z.y), min(z.x, z.y));
    z.xz = vec2(max(z.x, z.z), min(z.x, z.z));
    z.yz = vec2(max(z.y, z.z), min(z.y, z.z));
    return z;
}

mat3 turn() {
    vec3 a = radians(pre_rotation);
    vec3 c = cos(a);
    vec3 s = sin(a);
    mat3 x = mat3(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x);
    mat3 y = mat3(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y);
    mat3 z = mat3(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
    return z * y * x;
}

bool moves() { return pre_rotation != vec3(0.0) || pre_scale != 1.0 || pre_offset != vec3(0.0); }

bool changes() { return pre_fold != 0 || moves(); }

void prepare(inout Orbit orbit) {
    if (pre_fold != 0) orbit.z = fold(orbit.z);
    if (moves()) {
        orbit.z = pre_scale * (turn() * orbit.z) + pre_offset;
        orbit.w *= pre_scale;
        orbit.derivative *= pre_scale;
    }
    if (changes()) orbit.r2 = dot(orbit.z, orbit.z) + orbit.w * orbit.w;
}
