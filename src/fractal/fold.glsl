// Folds that kaleidoscopic formulas have in common: isometries that map space onto a part of it, piece by piece.

// Rotation about x, y and z in turn. Of constants, it is a constant.
mat3 fold_rotation(vec3 degrees) {
    vec3 a = radians(degrees);
    vec3 c = cos(a);
    vec3 s = sin(a);
    return mat3(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x) * mat3(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y) *
           mat3(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
}

// Onto the positive side of the plane through the origin with that unit normal.
vec3 fold_plane(vec3 p, vec3 normal) { return p - 2.0 * min(dot(p, normal), 0.0) * normal; }

// Into the wedge x >= y >= z >= 0: all mirrors of the cube.
vec3 fold_sorted(vec3 p) {
    p = abs(p);
    if (p.x < p.y) p.xy = p.yx;
    if (p.x < p.z) p.xz = p.zx;
    if (p.y < p.z) p.yz = p.zy;
    return p;
}

// The mirror groups of the Platonic solids (Coxeter 1934) as folds (Knighty 2010): the mirrors are x = 0, y = 0 and a third one at
// pi / order with y = 0 and pi / 3 with x = 0. Everything is mirrored into the wedge between the three.
vec3 fold_mirror(int order) {
    float c = cos(3.141592654 / float(order));
    return vec3(-0.5, -c, sqrt(max(0.75 - c * c, 0.0)));
}

vec3 fold_platonic(vec3 p, int order) {
    vec3 mirror = fold_mirror(order);
    for (int i = 0; i < order; ++i) {
        p.xy = abs(p.xy);
        p = fold_plane(p, mirror);
    }
    return vec3(abs(p.xy), p.z);
}

// The wedge's edges, of unit length: the axes of twofold, `order`-fold and threefold symmetry.
vec3 fold_axis2() { return vec3(0.0, 0.0, 1.0); }
vec3 fold_axis(int order) {
    vec3 m = fold_mirror(order);
    return normalize(vec3(m.z, 0.0, 0.5));
}
vec3 fold_axis3(int order) {
    vec3 m = fold_mirror(order);
    return normalize(vec3(0.0, m.z, -m.y));
}

// The unit vector at that angle from `from` [rad], along the great circle to `to`.
vec3 fold_towards(vec3 from, vec3 to, float angle) {
    vec3 across = normalize(to - dot(to, from) * from);
    return cos(angle) * from + sin(angle) * across;
}
