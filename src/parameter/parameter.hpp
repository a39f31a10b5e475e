#pragma once

#include "core/decimal.hpp"
#include "core/json.hpp"
#include "core/math.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace apeiron::parameter {

/// The types a parameter can have, in GLSL and on the host.
enum class Type {
    Bool,
    Int,
    Float,
    Vec2,
    Vec3,
    Vec4,
    Choice,    ///< one of `choices`, by label; an int (its index) in GLSL
    Text,      ///< host only
    Decimal3,  ///< a position as three decimals of any length; host only
    Module,    ///< the name of a GLSL module in `folder`, a path to one, or its source; host only
    Structure, ///< a JSON value with a form of its own, which `check` judges (a transfer function); host only
};

/// What an edit of a parameter makes stale.
enum class Invalidates {
    Nothing, ///< takes effect by itself (output names, ...)
    Present, ///< the picture is shown anew from the same samples
    Samples, ///< accumulated samples are forgotten
    Program, ///< kernels are compiled anew; in GLSL the value is a compile-time constant
};

/// A chosen GLSL module: by name or path, or with its source inside the document.
struct ModuleReference {
    std::string name;                  ///< "mandelbulb", "./mine.glsl", or a label for `source`
    std::optional<std::string> source; ///< the GLSL text itself, when it travels with the document
    bool operator==(const ModuleReference&) const = default;
};

using Decimal3 = std::array<Decimal, 3>;

/// The value of a Structure parameter. (A type of its own: a bare Json would take any value.)
struct Structure {
    Json json;
    bool operator==(const Structure&) const = default;
};

/// A parameter's value. Choice labels and texts are strings; vectors are double.
using Value = std::variant<bool, std::int64_t, double, glm::dvec2, glm::dvec3, glm::dvec4, std::string, Decimal3,
                           ModuleReference, Structure>;

/// One parameter, declared once: in an annotated GLSL uniform or in C++.
struct Parameter {
    std::string name; ///< the JSON key and the GLSL uniform's name
    Type type = Type::Float;
    Value defaultValue = 0.0;
    std::optional<double> minimum;    ///< inclusive; per component for vectors
    std::optional<double> maximum;    ///< inclusive
    std::optional<double> step;       ///< a slider's step
    std::string unit;                 ///< "deg", "EV", "px"; empty: dimensionless
    std::vector<std::string> choices; ///< labels of a Choice, index = GLSL value
    std::string folder;               ///< where a Module's candidates live ("formulas")
    Invalidates invalidates = Invalidates::Samples;
    bool color = false;       ///< a Vec3 that is a linear RGB colour
    bool logarithmic = false; ///< a slider should be logarithmic
    bool uniform = false;     ///< declared by a GLSL uniform (else host only)
    std::string doc;          ///< one sentence for people
    std::string where;        ///< "file:line" of the declaration
    bool path = false;        ///< a Text that names a file (or, without a '.' or '/', something else): relative
                              ///< ones are so to the document
    bool nonZero = false;     ///< a vector that must have a direction (an axis, a quaternion)
    /// Judges a Structure's JSON: throws Error (BadInput) with the place inside it. Required for a Structure.
    void (*check)(const Json& json) = nullptr;
    /// A Structure that is a text "x" is short for the object {shorthand: "x"}; empty: texts stand for themselves.
    /// `choices` are then the texts to choose from.
    std::string shorthand;
};

/// The GLSL-like name of a type: "float", "choice", ...
std::string_view toString(Type type);
/// "nothing", "present", "samples" or "program".
std::string_view toString(Invalidates invalidates);

/// Reads and checks a value: type, finite, range, known label.
/// @throws Error (BadInput) that says what is expected; its place is left to the caller.
Value valueFromJson(const Parameter& parameter, const Json& json);

/// The same for a command line's text: `9`, `0.1,0.2,0.3`, `(0.1, 0.2, 0.3)`, `true`, `penumbra`, or JSON.
/// Decimals keep all their digits, which a JSON number cannot: in documents, write them as strings.
Value valueFromText(const Parameter& parameter, std::string_view text);

/// As it is saved: numbers shortest round trip, vectors as arrays, decimals as strings.
Json toJson(const Value& value);

/// `value` in the alternative that the parameter's type wants where it means the same: an int as a float, a text as a
/// module's name. Other values come back as they are; validate() judges them.
Value adapted(const Parameter& parameter, Value value);

/// Checks a value made in C++. @throws Error (BadInput) as valueFromJson().
void validate(const Parameter& parameter, const Value& value);

/// The whole declaration as JSON (name, type, default, range, unit, choices, invalidates, doc).
Json toJson(const Parameter& parameter);

} // namespace apeiron::parameter
