#include "gpu/glsl_types.hpp"

#include <algorithm>
#include <set>

namespace apeiron::gpu::glsl {
namespace {

using Names = std::set<std::string, std::less<>>;

/// Components of any scalar or vector.
int sizeOf(std::string_view type) {
    if (type.empty() || isMatrix(type)) return 0;
    const char last = type.back();
    return last >= '2' && last <= '4' ? last - '0' : 1;
}

std::string boolType(int size) {
    return size <= 1 ? "bool" : "bvec" + std::to_string(size);
}

} // namespace

int floatSize(std::string_view type) {
    if (type == "float") return 1;
    if (type == "vec2") return 2;
    if (type == "vec3") return 3;
    return type == "vec4" ? 4 : 0;
}

std::string floatType(int size) {
    return size == 1 ? "float" : "vec" + std::to_string(size);
}

bool isMatrix(std::string_view type) {
    return type.starts_with("mat") && isBuiltinType(type);
}

std::vector<int> swizzle(std::string_view member) {
    if (member.size() > 4) return {};
    for (const std::string_view set : {"xyzw", "rgba", "stpq"}) {
        std::vector<int> indices;
        for (const char c : member)
            if (const std::size_t at = set.find(c); at != std::string_view::npos)
                indices.push_back(static_cast<int>(at));
        if (indices.size() == member.size()) return indices;
    }
    return {};
}

std::string binaryType(const std::string& op, const std::string& a, const std::string& b) {
    static const Names kTruths{"<", ">", "<=", ">=", "==", "!=", "&&", "||", "^^"};
    if (kTruths.contains(op)) return "bool";
    if (isMatrix(a) && isMatrix(b)) {
        if (op != "*") return a;
        const std::string columns(1, b[3]);
        const std::string rows(1, a.back());
        return columns == rows ? "mat" + columns : "mat" + columns + "x" + rows;
    }
    if (op == "*" && isMatrix(a) && floatSize(b) > 1) return floatType(a.back() - '0');
    if (op == "*" && isMatrix(b) && floatSize(a) > 1) return floatType(b[3] - '0');
    if (isMatrix(a) || isMatrix(b)) return isMatrix(a) ? a : b;
    return sizeOf(a) >= sizeOf(b) ? a : b;
}

std::string builtinType(const std::string& function, const std::vector<std::string>& arguments) {
    static const Names kLikeArguments{
        "sin",        "cos",     "tan",           "asin",        "acos",    "atan",    "sinh",        "cosh",
        "tanh",       "asinh",   "acosh",         "atanh",       "exp",     "log",     "exp2",        "log2",
        "sqrt",       "pow",     "abs",           "inversesqrt", "sign",    "floor",   "ceil",        "round",
        "trunc",      "fract",   "mod",           "min",         "max",     "clamp",   "mix",         "step",
        "smoothstep", "radians", "degrees",       "normalize",   "reflect", "refract", "faceforward", "roundEven",
        "transpose",  "inverse", "matrixCompMult"};
    static const Names kFloats{"length", "distance", "dot", "determinant", "uintBitsToFloat", "intBitsToFloat"};
    static const Names kTruths{"lessThan", "lessThanEqual", "greaterThan", "greaterThanEqual", "equal", "notEqual",
                               "not",      "isnan",         "isinf"};
    if (kFloats.contains(function)) return "float";
    if (function == "cross") return "vec3";
    if (function == "any" || function == "all") return "bool";
    if (function == "floatBitsToUint") return "uint";
    if (function == "floatBitsToInt") return "int";
    if (function.starts_with("texelFetch") || function.starts_with("texture")) return "vec4";
    if (arguments.empty()) return "";
    if (kTruths.contains(function)) return boolType(sizeOf(arguments[0]));
    if (!kLikeArguments.contains(function)) return "";
    return *std::max_element(arguments.begin(), arguments.end(), [](const std::string& a, const std::string& b) {
        return (a.starts_with("b") ? 0 : sizeOf(a)) < (b.starts_with("b") ? 0 : sizeOf(b));
    });
}

} // namespace apeiron::gpu::glsl
