// Dual numbers (Clifford 1873; forward-mode differentiation after Wengert 1964): a value, and for each of its components
// the gradient with respect to a point in space. gpu::differentiate() writes code that calls these.

struct Dual { float v; vec3 g; };
struct Dual2 { vec2 v; mat2x3 g; }; // g[i] is the gradient of component i
struct Dual3 { vec3 v; mat3 g; };
struct Dual4 { vec4 v; mat4x3 g; };

// Each component's gradient times that component.
vec3 dual_scaled(vec3 g, float s) { return g * s; }
mat2x3 dual_scaled(mat2x3 g, vec2 s) { return mat2x3(g[0] * s.x, g[1] * s.y); }
mat3 dual_scaled(mat3 g, vec3 s) { return mat3(g[0] * s.x, g[1] * s.y, g[2] * s.z); }
mat4x3 dual_scaled(mat4x3 g, vec4 s) { return mat4x3(g[0] * s.x, g[1] * s.y, g[2] * s.z, g[3] * s.w); }

// Gradients of `a` where it is the smaller one, else of `b`.
vec3 dual_smaller(float x, float y, vec3 a, vec3 b) { return x < y ? a : b; }
mat2x3 dual_smaller(vec2 x, vec2 y, mat2x3 a, mat2x3 b) {
    return mat2x3(x.x < y.x ? a[0] : b[0], x.y < y.y ? a[1] : b[1]);
}
mat3 dual_smaller(vec3 x, vec3 y, mat3 a, mat3 b) {
    return mat3(x.x < y.x ? a[0] : b[0], x.y < y.y ? a[1] : b[1], x.z < y.z ? a[2] : b[2]);
}
mat4x3 dual_smaller(vec4 x, vec4 y, mat4x3 a, mat4x3 b) {
    return mat4x3(x.x < y.x ? a[0] : b[0], x.y < y.y ? a[1] : b[1], x.z < y.z ? a[2] : b[2], x.w < y.w ? a[3] : b[3]);
}

// Slopes that are infinite somewhere are cut off there: a product of infinity and 0 would make the whole gradient NaN.
const float dual_tiny = 1e-18;

#define DUAL_OF_EVERY_SIZE(D, V, G) \
    D dual(V a) { return D(a, G(0.0)); } \
    V dual_value(D a) { return a.v; } \
    D dual_select(bool c, D a, D b) { return D(c ? a.v : b.v, c ? a.g : b.g); } \
    D dual_neg(D a) { return D(-a.v, -a.g); } \
    D dual_add(D a, D b) { return D(a.v + b.v, a.g + b.g); } \
    D dual_add(D a, V b) { return D(a.v + b, a.g); } \
    D dual_add(V a, D b) { return D(a + b.v, b.g); } \
    D dual_sub(D a, D b) { return D(a.v - b.v, a.g - b.g); } \
    D dual_sub(D a, V b) { return D(a.v - b, a.g); } \
    D dual_sub(V a, D b) { return D(a - b.v, -b.g); } \
    D dual_mul(D a, D b) { return D(a.v * b.v, dual_scaled(a.g, b.v) + dual_scaled(b.g, a.v)); } \
    D dual_mul(D a, V b) { return D(a.v * b, dual_scaled(a.g, b)); } \
    D dual_mul(V a, D b) { return D(a * b.v, dual_scaled(b.g, a)); } \
    D dual_div(D a, V b) { return D(a.v / b, dual_scaled(a.g, 1.0 / b)); } \
    D dual_div(D a, D b) { V q = a.v / b.v; return D(q, dual_scaled(a.g - dual_scaled(b.g, q), 1.0 / b.v)); } \
    D dual_div(V a, D b) { V q = a / b.v; return D(q, dual_scaled(b.g, -q / b.v)); } \
    D dual_min(D a, D b) { return D(min(a.v, b.v), dual_smaller(a.v, b.v, a.g, b.g)); } \
    D dual_max(D a, D b) { return D(max(a.v, b.v), dual_smaller(b.v, a.v, a.g, b.g)); } \
    D dual_abs(D a) { return D(abs(a.v), dual_scaled(a.g, sign(a.v))); } \
    D dual_fract(D a) { return D(fract(a.v), a.g); } \
    D dual_mod(D a, V b) { return D(mod(a.v, b), a.g); } \
    D dual_mod(D a, D b) { return dual_sub(a, dual_mul(b, floor(a.v / b.v))); } \
    D dual_sqrt(D a) { V r = sqrt(a.v); return D(r, dual_scaled(a.g, 0.5 / max(r, dual_tiny))); } \
    D dual_inversesqrt(D a) { V r = inversesqrt(a.v); return D(r, dual_scaled(a.g, -0.5 * r / a.v)); } \
    D dual_exp(D a) { V e = exp(a.v); return D(e, dual_scaled(a.g, e)); } \
    D dual_exp2(D a) { V e = exp2(a.v); return D(e, dual_scaled(a.g, 0.69314718 * e)); } \
    D dual_log(D a) { return D(log(a.v), dual_scaled(a.g, 1.0 / a.v)); } \
    D dual_log2(D a) { return D(log2(a.v), dual_scaled(a.g, 1.44269504 / a.v)); } \
    D dual_pow(D a, V n) { return D(pow(a.v, n), dual_scaled(a.g, n * pow(max(a.v, V(dual_tiny)), n - 1.0))); } \
    D dual_pow(D a, D n) { return dual_exp(dual_mul(n, dual_log(D(max(a.v, V(dual_tiny)), a.g)))); } \
    D dual_sin(D a) { return D(sin(a.v), dual_scaled(a.g, cos(a.v))); } \
    D dual_cos(D a) { return D(cos(a.v), dual_scaled(a.g, -sin(a.v))); } \
    D dual_tan(D a) { V t = tan(a.v); return D(t, dual_scaled(a.g, 1.0 + t * t)); } \
    D dual_asin(D a) { return D(asin(a.v), dual_scaled(a.g, inversesqrt(max(1.0 - a.v * a.v, V(1e-12))))); } \
    D dual_acos(D a) { return D(acos(a.v), dual_scaled(a.g, -inversesqrt(max(1.0 - a.v * a.v, V(1e-12))))); } \
    D dual_atan(D a) { return D(atan(a.v), dual_scaled(a.g, 1.0 / (1.0 + a.v * a.v))); } \
    D dual_atan(D y, D x) { \
        V w = 1.0 / max(x.v * x.v + y.v * y.v, V(dual_tiny)); \
        return D(atan(y.v, x.v), dual_scaled(y.g, x.v * w) - dual_scaled(x.g, y.v * w)); \
    } \
    D dual_sinh(D a) { return D(sinh(a.v), dual_scaled(a.g, cosh(a.v))); } \
    D dual_cosh(D a) { return D(cosh(a.v), dual_scaled(a.g, sinh(a.v))); } \
    D dual_tanh(D a) { V t = tanh(a.v); return D(t, dual_scaled(a.g, 1.0 - t * t)); } \
    D dual_radians(D a) { return D(radians(a.v), 0.0174532925 * a.g); } \
    D dual_degrees(D a) { return D(degrees(a.v), 57.2957795 * a.g); } \
    D dual_smoothstep(D from, D to, D x) { \
        D t = dual_div(dual_sub(x, from), dual_sub(to, from)); \
        t = dual_min(dual_max(t, dual(V(0.0))), dual(V(1.0))); \
        return dual_mul(dual_mul(t, t), dual_sub(V(3.0), dual_add(t, t))); \
    }

DUAL_OF_EVERY_SIZE(Dual, float, vec3)
DUAL_OF_EVERY_SIZE(Dual2, vec2, mat2x3)
DUAL_OF_EVERY_SIZE(Dual3, vec3, mat3)
DUAL_OF_EVERY_SIZE(Dual4, vec4, mat4x3)

#define DUAL_VECTOR(D, V, M) \
    D dual_mul(Dual a, D b) { return D(a.v * b.v, a.v * b.g + outerProduct(a.g, b.v)); } \
    D dual_mul(D a, Dual b) { return D(a.v * b.v, b.v * a.g + outerProduct(b.g, a.v)); } \
    D dual_mul(Dual a, V b) { return D(a.v * b, outerProduct(a.g, b)); } \
    D dual_mul(V a, Dual b) { return D(a * b.v, outerProduct(b.g, a)); } \
    D dual_mul(float a, D b) { return D(a * b.v, a * b.g); } \
    D dual_mul(D a, float b) { return D(a.v * b, b * a.g); } \
    D dual_mul(M m, D a) { return D(m * a.v, a.g * transpose(m)); } \
    D dual_mul(D a, M m) { return D(a.v * m, a.g * m); } \
    D dual_div(D a, Dual b) { return dual_mul(a, dual_div(1.0, b)); } \
    D dual_div(V a, Dual b) { return dual_mul(a, dual_div(1.0, b)); } \
    D dual_div(D a, float b) { return dual_mul(a, 1.0 / b); } \
    Dual dual_dot(D a, D b) { return Dual(dot(a.v, b.v), a.g * b.v + b.g * a.v); } \
    Dual dual_length(D a) { float r = length(a.v); return Dual(r, a.g * (a.v / max(r, dual_tiny))); } \
    D dual_normalize(D a) { return dual_div(a, dual_length(a)); } \
    D dual_reflect(D i, D n) { return dual_sub(i, dual_mul(dual_mul(dual_dot(n, i), 2.0), n)); } \
    Dual dual_at(D a, int i) { return Dual(a.v[i], a.g[i]); } \
    void dual_set_at(inout D a, int i, Dual b) { a.v[i] = b.v; a.g[i] = b.g; }

DUAL_VECTOR(Dual2, vec2, mat2)
DUAL_VECTOR(Dual3, vec3, mat3)
DUAL_VECTOR(Dual4, vec4, mat4)

Dual dual_length(Dual a) { return dual_abs(a); }
Dual dual_dot(Dual a, Dual b) { return dual_mul(a, b); }

Dual3 dual_cross(Dual3 a, Dual3 b) {
    // Each column of the gradients is turned into how all components change along one axis, and back.
    mat3 p = transpose(a.g);
    mat3 q = transpose(b.g);
    return Dual3(cross(a.v, b.v), transpose(mat3(cross(p[0], b.v) + cross(a.v, q[0]), cross(p[1], b.v) + cross(a.v, q[1]),
                                                 cross(p[2], b.v) + cross(a.v, q[2]))));
}

Dual2 dual_vec2(Dual a) { return Dual2(vec2(a.v), mat2x3(a.g, a.g)); }
Dual2 dual_vec2(Dual a, Dual b) { return Dual2(vec2(a.v, b.v), mat2x3(a.g, b.g)); }
Dual2 dual_vec2(Dual2 a) { return a; }
Dual2 dual_vec2(Dual3 a) { return Dual2(a.v.xy, mat2x3(a.g[0], a.g[1])); }
Dual2 dual_vec2(Dual4 a) { return Dual2(a.v.xy, mat2x3(a.g[0], a.g[1])); }
Dual3 dual_vec3(Dual a) { return Dual3(vec3(a.v), mat3(a.g, a.g, a.g)); }
Dual3 dual_vec3(Dual a, Dual b, Dual c) { return Dual3(vec3(a.v, b.v, c.v), mat3(a.g, b.g, c.g)); }
Dual3 dual_vec3(Dual2 a, Dual b) { return Dual3(vec3(a.v, b.v), mat3(a.g[0], a.g[1], b.g)); }
Dual3 dual_vec3(Dual a, Dual2 b) { return Dual3(vec3(a.v, b.v), mat3(a.g, b.g[0], b.g[1])); }
Dual3 dual_vec3(Dual3 a) { return a; }
Dual3 dual_vec3(Dual4 a) { return Dual3(a.v.xyz, mat3(a.g[0], a.g[1], a.g[2])); }
Dual4 dual_vec4(Dual a) { return Dual4(vec4(a.v), mat4x3(a.g, a.g, a.g, a.g)); }
Dual4 dual_vec4(Dual a, Dual b, Dual c, Dual d) { return Dual4(vec4(a.v, b.v, c.v, d.v), mat4x3(a.g, b.g, c.g, d.g)); }
Dual4 dual_vec4(Dual2 a, Dual2 b) { return Dual4(vec4(a.v, b.v), mat4x3(a.g[0], a.g[1], b.g[0], b.g[1])); }
Dual4 dual_vec4(Dual2 a, Dual b, Dual c) { return dual_vec4(a, dual_vec2(b, c)); }
Dual4 dual_vec4(Dual a, Dual b, Dual2 c) { return dual_vec4(dual_vec2(a, b), c); }
Dual4 dual_vec4(Dual a, Dual2 b, Dual c) { return Dual4(vec4(a.v, b.v, c.v), mat4x3(a.g, b.g[0], b.g[1], c.g)); }
Dual4 dual_vec4(Dual3 a, Dual b) { return Dual4(vec4(a.v, b.v), mat4x3(a.g[0], a.g[1], a.g[2], b.g)); }
Dual4 dual_vec4(Dual a, Dual3 b) { return Dual4(vec4(a.v, b.v), mat4x3(a.g, b.g[0], b.g[1], b.g[2])); }
Dual4 dual_vec4(Dual4 a) { return a; }
