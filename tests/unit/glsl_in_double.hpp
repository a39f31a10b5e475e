#pragma once

#include <cmath>
#include <map>
#include <string>
#include <variant>
#include <vector>

/// The part of GLSL that formulas are written in, in double precision: the very text of a formula compiles as C++
/// (cmake/formulas_in_double.cmake), and tests compare it with the truth.
namespace glsl {

struct vec2;
struct vec3;

/// Some components of a vector in some order (`z.yx`): reads and writes through to the vector it is part of.
template <class Vector, int... kAt> struct Swizzle {
    double all[4];
    operator Vector() const { return Vector(all[kAt]...); }
    Vector operator=(const Vector& v) {
        const double* from = &v.x;
        ((all[kAt] = *from++), ...);
        return v;
    }
    Vector operator=(const Swizzle& other) { return *this = static_cast<Vector>(other); }
    Vector operator-() const { return -static_cast<Vector>(*this); }
    void operator-=(const Vector& v) { *this = static_cast<Vector>(*this) - v; }
    void operator+=(const Vector& v) { *this = static_cast<Vector>(*this) + v; }
    void operator*=(double s) { *this = static_cast<Vector>(*this) * s; }
};

struct vec2 {
    union {
        struct {
            double x, y;
        };
        Swizzle<vec2, 1, 0> yx;
    };
    vec2() : vec2(0.0) {}
    explicit vec2(double s) : vec2(s, s) {}
    vec2(double a, double b) : x(a), y(b) {}
    vec2(const vec2& v) : vec2(v.x, v.y) {}
    vec2& operator=(const vec2& v) { return x = v.x, y = v.y, *this; }
};

struct vec3 {
    union {
        struct {
            double x, y, z;
        };
        Swizzle<vec2, 0, 1> xy;
        Swizzle<vec2, 1, 0> yx;
        Swizzle<vec2, 0, 2> xz;
        Swizzle<vec2, 2, 0> zx;
        Swizzle<vec2, 1, 2> yz;
        Swizzle<vec2, 2, 1> zy;
    };
    vec3() : vec3(0.0) {}
    explicit vec3(double s) : vec3(s, s, s) {}
    vec3(double a, double b, double c) : x(a), y(b), z(c) {}
    vec3(const vec2& v, double c) : vec3(v.x, v.y, c) {}
    vec3(double a, const vec2& v) : vec3(a, v.x, v.y) {}
    vec3(const vec3& v) : vec3(v.x, v.y, v.z) {}
    vec3& operator=(const vec3& v) { return x = v.x, y = v.y, z = v.z, *this; }
};

struct vec4 {
    union {
        struct {
            double x, y, z, w;
        };
        Swizzle<vec3, 0, 1, 2> xyz;
    };
    vec4() : vec4(0.0, 0.0, 0.0, 0.0) {}
    vec4(double a, double b, double c, double d) : x(a), y(b), z(c), w(d) {}
    vec4(const vec4& v) : vec4(v.x, v.y, v.z, v.w) {}
    vec4& operator=(const vec4& v) { return x = v.x, y = v.y, z = v.z, w = v.w, *this; }
};

// Component by component.
template <class F> vec2 each(const F& f, const vec2& a) {
    return {f(a.x), f(a.y)};
}
template <class F> vec3 each(const F& f, const vec3& a) {
    return {f(a.x), f(a.y), f(a.z)};
}
template <class F> vec2 each(const F& f, const vec2& a, const vec2& b) {
    return {f(a.x, b.x), f(a.y, b.y)};
}
template <class F> vec3 each(const F& f, const vec3& a, const vec3& b) {
    return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)};
}

inline double min(double a, double b) {
    return b < a ? b : a;
}
inline double max(double a, double b) {
    return a < b ? b : a;
}
inline double abs(double a) {
    return std::fabs(a);
}
inline double floor(double a) {
    return std::floor(a);
}
inline double fract(double a) {
    return a - std::floor(a);
}
inline double sign(double a) {
    return a > 0.0 ? 1.0 : (a < 0.0 ? -1.0 : 0.0);
}
inline double sqrt(double a) {
    return std::sqrt(a);
}
inline double sin(double a) {
    return std::sin(a);
}
inline double cos(double a) {
    return std::cos(a);
}
inline double exp(double a) {
    return std::exp(a);
}
inline double log(double a) {
    return std::log(a);
}
inline double pow(double a, double b) {
    return std::pow(a, b);
}
inline double atan(double y, double x) {
    return std::atan2(y, x);
}
inline double radians(double a) {
    return a * 0.017453292519943295;
}
inline double clamp(double a, double low, double high) {
    return min(max(a, low), high);
}
inline double mix(double a, double b, double t) {
    return a + t * (b - a);
}

#define APEIRON_OPERATOR(V, op)                                                                                        \
    inline V operator op(const V& a, const V& b) {                                                                     \
        return each([](double x, double y) { return x op y; }, a, b);                                                  \
    }                                                                                                                  \
    inline V operator op(const V& a, double b) {                                                                       \
        return a op V(b);                                                                                              \
    }                                                                                                                  \
    inline V operator op(double a, const V& b) {                                                                       \
        return V(a) op b;                                                                                              \
    }                                                                                                                  \
    inline V& operator op##=(V& a, const V& b) {                                                                       \
        return a = a op b;                                                                                             \
    }                                                                                                                  \
    inline V& operator op##=(V& a, double b) {                                                                         \
        return a = a op b;                                                                                             \
    }
#define APEIRON_FUNCTION(V, name)                                                                                      \
    inline V name(const V& a) {                                                                                        \
        return each([](double x) { return name(x); }, a);                                                              \
    }
#define APEIRON_VECTOR(V)                                                                                              \
    APEIRON_OPERATOR(V, +)                                                                                             \
    APEIRON_OPERATOR(V, -)                                                                                             \
    APEIRON_OPERATOR(V, *)                                                                                             \
    APEIRON_OPERATOR(V, /)                                                                                             \
    APEIRON_FUNCTION(V, abs)                                                                                           \
    APEIRON_FUNCTION(V, floor)                                                                                         \
    APEIRON_FUNCTION(V, fract)                                                                                         \
    APEIRON_FUNCTION(V, sin)                                                                                           \
    APEIRON_FUNCTION(V, cos)                                                                                           \
    APEIRON_FUNCTION(V, radians)                                                                                       \
    inline V operator-(const V& a) {                                                                                   \
        return a * -1.0;                                                                                               \
    }                                                                                                                  \
    inline V min(const V& a, const V& b) {                                                                             \
        return each([](double x, double y) { return min(x, y); }, a, b);                                               \
    }                                                                                                                  \
    inline V max(const V& a, const V& b) {                                                                             \
        return each([](double x, double y) { return max(x, y); }, a, b);                                               \
    }                                                                                                                  \
    inline V max(const V& a, double b) {                                                                               \
        return max(a, V(b));                                                                                           \
    }                                                                                                                  \
    inline V clamp(const V& a, const V& low, const V& high) {                                                          \
        return min(max(a, low), high);                                                                                 \
    }                                                                                                                  \
    inline V clamp(const V& a, double low, double high) {                                                              \
        return clamp(a, V(low), V(high));                                                                              \
    }                                                                                                                  \
    inline V mix(const V& a, const V& b, double t) {                                                                   \
        return a + t * (b - a);                                                                                        \
    }                                                                                                                  \
    inline double length(const V& a) {                                                                                 \
        return std::sqrt(dot(a, a));                                                                                   \
    }                                                                                                                  \
    inline V normalize(const V& a) {                                                                                   \
        return a / length(a);                                                                                          \
    }

inline double dot(const vec2& a, const vec2& b) {
    return a.x * b.x + a.y * b.y;
}
inline double dot(const vec3& a, const vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double dot(const vec4& a, const vec4& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
inline double length(const vec4& a) {
    return std::sqrt(dot(a, a));
}
APEIRON_VECTOR(vec2)
APEIRON_VECTOR(vec3)
#undef APEIRON_VECTOR
#undef APEIRON_FUNCTION
#undef APEIRON_OPERATOR
inline bool operator==(const vec3& a, const vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
inline vec3 cross(const vec3& a, const vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct mat3 {
    vec3 column[3];
    mat3(double a, double b, double c, double d, double e, double f, double g, double h, double i)
        : column{{a, b, c}, {d, e, f}, {g, h, i}} {}
};
inline vec3 operator*(const mat3& m, const vec3& v) {
    return m.column[0] * v.x + m.column[1] * v.y + m.column[2] * v.z;
}
inline mat3 operator*(const mat3& a, const mat3& b) {
    const vec3 x = a * b.column[0];
    const vec3 y = a * b.column[1];
    const vec3 z = a * b.column[2];
    return {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
}

struct Orbit;

/// A formula's parameter, as the variable that its text reads.
using Uniform = std::variant<bool*, int*, double*, vec2*, vec3*, vec4*>;

/// A formula, compiled from its text. Its parameters are zero at first.
struct Formula {
    std::string name;
    std::map<std::string, Uniform> uniforms;
    void (*start)(Orbit&);
    void (*iterate)(Orbit&);
    double (*estimate)(Orbit);
    double (*bound)();
    double stepFactor;
};

const std::vector<Formula>& formulas();

// What src/fractal/orbit.glsl declares, for those who do not include it as text.
struct Orbit {
    vec3 z;
    double w;
    vec3 c;
    double cw;
    double derivative;
    double dc;
    double r2;
    int i;
};

} // namespace glsl
