// Every formula's estimate against the distance that brute force finds, in double precision. The formulas' own text is
// compiled as C++ for that (see glsl_in_double.hpp).

#include "../random_parameters.hpp"
#include "glsl_in_double.hpp"
#include "parameter/glsl_module.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
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

} // namespace
} // namespace apeiron::test
