// Every formula's estimate against the distance that brute force finds, in double precision. The formulas' own text is
// compiled as C++ for that (see glsl_in_double.hpp).

#include "../random_parameters.hpp"
#include "glsl_in_double.hpp"
#include "parameter/glsl_module.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <complex>
#include <tuple>

namespace apeiron::test {
namespace {

using glsl::vec3;
using parameter::Value;

/// Gives a formula's variable the value of its parameter.
void assign(const glsl::Uniform& uniform, const parameter::Parameter& parameter, const Value& value) {
    struct Assign {
        const parameter::Parameter& parameter;
        const Value& value;
        void operator()(bool* to) const { *to = std::get<bool>(value); }
        void operator()(int* to) const {
            if (const auto* label = std::get_if<std::string>(&value)) {
                const auto& all = parameter.choices;
                *to = static_cast<int>(std::find(all.begin(), all.end(), *label) - all.begin());
            } else {
                *to = static_cast<int>(std::get<std::int64_t>(value));
            }
        }
        void operator()(double* to) const { *to = std::get<double>(value); }
        void operator()(glsl::vec2* to) const {
            const auto v = std::get<glm::dvec2>(value);
            *to = {v.x, v.y};
        }
        void operator()(vec3* to) const {
            const auto v = std::get<glm::dvec3>(value);
            *to = {v.x, v.y, v.z};
        }
        void operator()(glsl::vec4* to) const {
            const auto v = std::get<glm::dvec4>(value);
            *to = {v.x, v.y, v.z, v.w};
        }
    };
    std::visit(Assign{parameter, value}, uniform);
}

/// A formula at some values of its parameters, as src/fractal/fractal.glsl runs it.
class Subject {
  public:
    explicit Subject(const glsl::Formula& formula)
        : formula_(formula), module_(parameter::loadModule("formulas", {formula.name, {}})) {
        for (const parameter::Parameter& p : module_.parameters)
            set(p, p.defaultValue);
    }

    const parameter::GlslModule& module() const { return module_; }
    void set(const parameter::Parameter& p, const Value& value) {
        assign(formula_.uniforms.at(p.name), p, value);
        if (p.name == "iterations") iterations_ = std::get<std::int64_t>(value);
        if (p.name == "bailout") bailout_ = std::get<double>(value);
    }

    double operator()(const vec3& p) const {
        glsl::Orbit o{p, 0.0, p, 0.0, 1.0, 1.0, 0.0, 0};
        formula_.start(o);
        o.r2 = dot(o.z, o.z) + o.w * o.w;
        for (int i = 0; i < iterations_; ++i) {
            if (o.r2 > bailout_ * bailout_) break;
            formula_.iterate(o);
            o.r2 = dot(o.z, o.z) + o.w * o.w;
            ++o.i;
        }
        return formula_.estimate(o) * formula_.stepFactor;
    }
    double bound() const { return formula_.bound(); }

  private:
    const glsl::Formula& formula_;
    parameter::GlslModule module_;
    std::int64_t iterations_ = 0;
    double bailout_ = 0.0;
};

vec3 randomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    for (;;) {
        const vec3 v(normal(random), normal(random), normal(random));
        if (dot(v, v) > 1e-6) return normalize(v);
    }
}

/// Along a ray from `p`, in steps of a tenth of the estimate, how far the surface is; `far` when it is farther. An
/// estimate that is up to ten times too large cannot jump over the surface.
double marched(const Subject& subject, const vec3& p, const vec3& direction, double surface, double far) {
    double t = 0.0;
    for (int i = 0; i < 600 && t < far; ++i) {
        const double d = subject(p + t * direction);
        if (d < surface) return t;
        t += std::max(0.1 * d, 0.2 * surface);
    }
    return std::min(t, far);
}

/// The distance from `p` to the nearest point whose estimate is below `surface`, by brute force: rays in all
/// directions, then ever narrower cones around the best one. Never too small.
double bruteForce(const Subject& subject, const vec3& p, double surface, double far, std::mt19937& random) {
    double best = far;
    vec3 towards;
    const auto look = [&](const vec3& direction) {
        const double t = marched(subject, p, direction, surface, best);
        if (t >= best) return;
        best = t;
        towards = direction;
    };
    for (int i = 0; i < 80; ++i)
        look(randomDirection(random));
    for (double width = 0.3; width > 0.005 && best < far; width *= 0.6) {
        for (int i = 0; i < 10; ++i)
            look(normalize(towards + width * randomDirection(random)));
    }
    return best;
}

/// Estimate / distance at many points.
class Ratios {
  public:
    void add(double ratio, const std::string& where) {
        all_.push_back(ratio);
        if (ratio > worst_) std::tie(worst_, where_) = std::tie(ratio, where);
    }
    std::size_t count() const { return all_.size(); }
    double worst() const { return worst_; }
    const std::string& where() const { return where_; }
    double quantile(double q) const {
        std::vector<double> sorted = all_;
        std::sort(sorted.begin(), sorted.end());
        return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
    }

  private:
    std::vector<double> all_;
    double worst_ = 0.0;
    std::string where_;
};

/// Adds the ratios of up to `count` random points within the bound that are not on the surface.
void measure(const Subject& subject, int count, std::mt19937& random, Ratios& ratios) {
    const double radius = subject.bound();
    const double surface = 2e-4 * radius;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    int found = 0;
    for (int tries = 0; found < count && tries < 20 * count; ++tries) {
        const vec3 p = radius * std::cbrt(unit(random)) * randomDirection(random);
        const double d = subject(p);
        if (d < 20.0 * surface) continue;
        ++found;
        // What is farther than that is a ratio below a twentieth, or misses the whole bound.
        const double truth = bruteForce(subject, p, surface, std::min(20.0 * d, 2.5 * radius), random);
        // Rays stop a little in front of where the estimate is 0.
        ratios.add(d / (truth + surface), fmt::format("({}, {}, {}): {} instead of {}", p.x, p.y, p.z, d, truth));
    }
}

/// The same over random values of all parameters; `far`: see randomValue().
void measureElsewhere(Subject& subject, double far, std::mt19937& random, Ratios& ratios) {
    for (int set = 0; set < 12; ++set) {
        for (const parameter::Parameter& p : subject.module().parameters)
            subject.set(p, randomValue(p, random, far));
        measure(subject, 5, random, ratios);
    }
}

class Estimate : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Formulas, Estimate, testing::ValuesIn(parameter::moduleNames("formulas")),
                         [](const auto& instance) { return instance.param; });

TEST_P(Estimate, is_a_lower_bound_of_the_distance_and_no_needlessly_small_one) {
    const auto formula = std::find_if(glsl::formulas().begin(), glsl::formulas().end(),
                                      [this](const glsl::Formula& f) { return f.name == GetParam(); });
    ASSERT_NE(formula, glsl::formulas().end());
    Subject subject(*formula);
    std::mt19937 random(1);
    Ratios atDefaults;
    measure(subject, 50, random, atDefaults);
    Ratios near;
    measureElsewhere(subject, 0.2, random, near);
    Ratios anywhere;
    measureElsewhere(subject, 1.0, random, anywhere);
    // A row of docs/formulas.md.
    fmt::print("| `{}` | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", formula->name, formula->stepFactor,
               atDefaults.worst(), atDefaults.quantile(0.5), near.worst(), anywhere.quantile(0.98));

    ASSERT_EQ(atDefaults.count(), 50U);
    // Two hundredths: the brute force stops at a surface of finite thickness, and its steps have a size.
    EXPECT_LE(atDefaults.worst(), 1.02) << atDefaults.where();
    EXPECT_LE(near.worst(), 1.1) << near.where();
    // In odd corners of a formula's ranges a few points may be off; step_scale is for who goes there.
    EXPECT_LE(anywhere.quantile(0.98), 1.1) << anywhere.where();
    // A march then needs a few times as many steps as with the distance itself, not ten times as many.
    EXPECT_GE(atDefaults.quantile(0.5), 0.2);
    EXPECT_GE(atDefaults.quantile(0.1), 0.05);
}

const glsl::Formula& formulaCalled(const std::string& name) {
    return *std::find_if(glsl::formulas().begin(), glsl::formulas().end(),
                         [&](const glsl::Formula& f) { return f.name == name; });
}

/// All points that differ by order and signs of the coordinates; `even`: by even permutations alone.
std::vector<vec3> variants(const vec3& v, bool even = false) {
    std::vector<vec3> all;
    std::array<double, 3> order{v.x, v.y, v.z};
    for (int turn = 0; turn < (even ? 3 : 6); ++turn) {
        for (int signs = 0; signs < 8; ++signs) {
            const vec3 p((signs & 1 ? -1.0 : 1.0) * order[0], (signs & 2 ? -1.0 : 1.0) * order[1],
                         (signs & 4 ? -1.0 : 1.0) * order[2]);
            if (std::none_of(all.begin(), all.end(), [&](const vec3& q) { return length(p - q) < 1e-9; }))
                all.push_back(p);
        }
        std::rotate(order.begin(), order.begin() + 1, order.end());
        if (turn == 2) std::swap(order[0], order[1]);
    }
    return all;
}

/// A set by its definition: smaller copies of itself at the corners of a convex solid that is given by its faces.
struct Copies {
    const char* formula;
    double scale;
    std::vector<vec3> corners;
    std::vector<vec3> faces; ///< unit normals
    double inradius;

    bool contain(const vec3& p, int level) const {
        if (level == 0) {
            return std::all_of(faces.begin(), faces.end(), [&](const vec3& n) { return dot(p, n) <= inradius; });
        }
        if (dot(p, p) > 3.01) return false;
        return std::any_of(corners.begin(), corners.end(),
                           [&](const vec3& corner) { return contain(scale * p - (scale - 1.0) * corner, level - 1); });
    }
};

std::vector<Copies> kaleidoscopic() {
    const double golden = 0.5 + std::sqrt(1.25);
    const auto unit = [](std::vector<vec3> all) {
        for (vec3& v : all)
            v = normalize(v);
        return all;
    };
    // In the orientation of the folds: a twofold axis is z, a fivefold one lies in the plane y = 0.
    const std::vector<vec3> twelve = unit(variants({1.0, 0.0, golden}, true));
    std::vector<vec3> twenty = variants({0.0, 1.0 / golden, golden}, true);
    for (const vec3& v : variants({1.0, 1.0, 1.0}))
        twenty.push_back(v);
    twenty = unit(twenty);
    const std::vector<vec3> odd{{-1.0, -1.0, -1.0}, {1.0, 1.0, -1.0}, {-1.0, 1.0, 1.0}, {1.0, -1.0, 1.0}};
    std::vector<vec3> even = odd;
    for (vec3& v : even)
        v = -v;
    std::vector<vec3> snowflake = variants({1.0, 1.0, 0.0});
    const std::vector<vec3> axes = variants({1.0, 0.0, 0.0});
    snowflake.insert(snowflake.end(), axes.begin(), axes.end());
    const double inradius = 0.794654472291766; // of icosahedra and dodecahedra with corners at 1
    return {{"sierpinski", 2.0, even, unit(odd), std::sqrt(1.0 / 3.0)},
            {"octahedron", 2.0, axes, unit(variants({1.0, 1.0, 1.0})), std::sqrt(1.0 / 3.0)},
            {"icosahedron", 1.0 + golden, twelve, twenty, inradius},
            {"dodecahedron", 2.0 + golden, twenty, twelve, inradius},
            {"mosely", 3.0, snowflake, axes, 1.0}};
}

TEST(Kaleidoscopic, formulas_are_smaller_copies_of_themselves_at_the_corners) {
    constexpr int kLevel = 3;
    for (const Copies& set : kaleidoscopic()) {
        Subject subject(formulaCalled(set.formula));
        for (const parameter::Parameter& p : subject.module().parameters) {
            if (p.name == "iterations") subject.set(p, std::int64_t{kLevel});
            if (p.name == "scale") subject.set(p, set.scale);
        }
        std::mt19937 random(3);
        std::uniform_int_distribution<std::size_t> corner(0, set.corners.size() - 1);
        int inside = 0;
        for (int i = 0; i < 400; ++i) {
            // Near one of the last solids.
            vec3 p = std::uniform_real_distribution<double>(0.2, 1.3)(random) * randomDirection(random);
            for (int level = 0; level < kLevel; ++level)
                p = (p + (set.scale - 1.0) * set.corners[corner(random)]) / set.scale;
            const bool expected = set.contain(p, kLevel);
            inside += expected;
            EXPECT_EQ(subject(p) <= 0.0, expected) << set.formula << " at " << p.x << ", " << p.y << ", " << p.z;
        }
        EXPECT_GT(inside, 20) << set.formula;
        EXPECT_LT(inside, 390) << set.formula;
    }
}

TEST(Quaternion, is_the_square_of_quaternions) {
    const Subject subject(formulaCalled("quaternion"));
    const glm::dvec4 c(-0.2, 0.6, 0.2, 0.2);
    std::mt19937 random(4);
    for (int i = 0; i < 200; ++i) {
        const vec3 p = 1.5 * randomDirection(random) * std::uniform_real_distribution<double>(0.1, 1.0)(random);
        glm::dquat q(p.x, p.y, p.z, 0.0);
        double derivative = 1.0;
        for (int n = 0; n < 12 && glm::length(q) <= 4.0; ++n) {
            derivative *= 2.0 * glm::length(q);
            q = q * q + glm::dquat(c.x, c.y, c.z, c.w);
        }
        const double r = glm::length(q);
        EXPECT_NEAR(subject(p), std::max(0.5 * r * std::log(r) / derivative, 0.0), 1e-9);
    }
}

TEST(Hypercomplex, is_the_square_of_two_complex_numbers) {
    const Subject subject(formulaCalled("hypercomplex"));
    using Complex = std::complex<double>;
    const Complex ca(-0.5 - 0.2, 0.5 + 0.15);
    const Complex cb(-0.5 + 0.2, 0.5 - 0.15);
    std::mt19937 random(5);
    for (int i = 0; i < 200; ++i) {
        const vec3 p = 1.5 * randomDirection(random) * std::uniform_real_distribution<double>(0.1, 1.0)(random);
        Complex a(p.x, p.y + p.z);
        Complex b(p.x, p.y - p.z);
        const auto size = [&] { return std::sqrt(0.5 * (std::norm(a) + std::norm(b))); };
        double derivative = 1.0;
        for (int n = 0; n < 14 && size() <= 4.0; ++n) {
            derivative *= 2.0 * std::max(std::abs(a), std::abs(b));
            a = a * a + ca;
            b = b * b + cb;
        }
        EXPECT_NEAR(subject(p), std::max(0.5 * size() * std::log(size()) / derivative, 0.0), 1e-9);
    }
}

} // namespace
} // namespace apeiron::test
