#include "gpu/shader_source.hpp"

#include "core/error.hpp"
#include "core/resources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <sstream>

namespace apeiron::gpu {
namespace {

bool isIdentifierStart(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool isIdentifier(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// The identifier that starts at `i`.
std::string_view identifierAt(std::string_view text, std::size_t i) {
    std::size_t end = i;
    while (end < text.size() && isIdentifier(text[end]))
        ++end;
    return text.substr(i, end - i);
}

std::size_t skipSpace(std::string_view text, std::size_t i) {
    while (i < text.size() && std::isspace(static_cast<unsigned char>(text[i])) != 0)
        ++i;
    return i;
}

char charAt(std::string_view text, std::size_t i) {
    return i < text.size() ? text[i] : '\0';
}

/// Makes constants of uniforms. Read by hand, as all that is read whole: std::regex took most of the time between an
/// edit and the driver's compiler. @param values literals by the uniform's name
std::string withConstants(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
    constexpr std::string_view kUniform = "uniform";
    std::string out;
    std::size_t done = 0;
    for (std::size_t at = 0; (at = text.find(kUniform, at)) != std::string_view::npos;) {
        const std::size_t begin = at;
        at += kUniform.size();
        if ((begin > 0 && isIdentifier(text[begin - 1])) || isIdentifier(charAt(text, at))) continue;
        const std::size_t typeAt = skipSpace(text, at);
        std::size_t i = typeAt;
        std::string_view word = identifierAt(text, i);
        std::size_t typeEnd = typeAt;
        // Precision, type, name: the last word is the name.
        for (int words = 0; words < 3 && !word.empty(); ++words) {
            const std::size_t next = skipSpace(text, i + word.size());
            if (charAt(text, next) == ';') break;
            typeEnd = i + word.size();
            i = next;
            word = identifierAt(text, i);
        }
        const std::size_t end = skipSpace(text, i + word.size());
        const auto value = values.find(word);
        if (value == values.end() || charAt(text, end) != ';' || typeEnd == typeAt) continue;
        out += text.substr(done, begin - done);
        out += fmt::format("const {} {} = {};", text.substr(typeAt, typeEnd - typeAt), word, value->second);
        done = at = end + 1;
    }
    out += text.substr(done);
    return out;
}

} // namespace

std::string withoutComments(std::string_view text) {
    std::string out(text);
    for (std::size_t i = 0; i + 1 < out.size(); ++i) {
        if (out[i] != '/') continue;
        if (out[i + 1] == '/') {
            while (i < out.size() && out[i] != '\n')
                out[i++] = ' ';
        } else if (out[i + 1] == '*') {
            const std::size_t end = std::min(out.find("*/", i + 2), out.size() - 2) + 2;
            for (; i < end; ++i) {
                if (out[i] != '\n') out[i] = ' ';
            }
            --i;
        }
    }
    return out;
}

std::set<std::string> globalNames(std::string_view source) {
    const std::string text = withoutComments(source);
    std::set<std::string> names;
    int depth = 0;         // of all brackets
    bool declaring = true; // not in a value behind a '=' of the current global declaration
    bool naming = true;    // not in `precision highp float;`, which declares nothing
    bool lineStart = true;
    std::string previous; // the identifier before the current one
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') {
            lineStart = true;
            continue;
        }
        if (std::isspace(static_cast<unsigned char>(c)) != 0) continue;
        if (c == '#' && lineStart) {
            const std::size_t end = std::min(text.find('\n', i), text.size());
            static const std::regex kDefine(R"(^#\s*define\s+(\w+))");
            std::cmatch match;
            if (std::regex_search(text.data() + i, text.data() + end, match, kDefine,
                                  std::regex_constants::match_continuous))
                names.insert(match[1].str());
            i = end - 1;
            continue;
        }
        lineStart = false;
        if (isIdentifierStart(c)) {
            const std::string word(identifierAt(text, i));
            const std::size_t behind = skipSpace(text, i + word.size());
            const char after = charAt(text, behind);
            if (depth == 0 && word == "precision") naming = false;
            // In `const float[3] name` the word before the bracket is the type.
            const bool type =
                after == '[' && isIdentifierStart(charAt(text, skipSpace(text, text.find(']', behind) + 1)));
            if (depth == 0 && declaring && naming && !type && !previous.empty() &&
                (after == '(' || after == '=' || after == ';' || after == '[' || after == ',' ||
                 (after == '{' && previous == "struct")) &&
                word != "layout" && word != "uniform") {
                names.insert(word);
            }
            previous = word;
            i += word.size() - 1;
        } else if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
            i += identifierAt(text, i).size() - 1;
        } else if (c == '(' || c == '{' || c == '[') {
            ++depth;
        } else if (c == ')' || c == '}' || c == ']') {
            --depth;
            if (depth == 0 && c == '}') {
                declaring = true;
                previous.clear();
            }
        } else if (depth == 0 && c == '=') {
            declaring = false;
        } else if (depth == 0 && c == ',') {
            declaring = true; // another name of the same declaration
        } else if (depth == 0 && c == ';') {
            declaring = true;
            naming = true;
            previous.clear();
        }
    }
    return names;
}

std::string withPrefix(std::string_view text, const std::set<std::string>& names, const std::string& prefix) {
    std::string out;
    out.reserve(text.size() + text.size() / 8);
    char before = '\0'; // the last character that is no space
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] == '#' && (before == '\0' || before == '\n')) {
            // Directives that hold paths and words, not code.
            const std::string_view line = text.substr(i, text.find('\n', i) - i);
            if (line.find("include") != std::string_view::npos || line.find("pragma") != std::string_view::npos) {
                out += line;
                i += line.size();
                continue;
            }
        }
        if (isIdentifierStart(text[i])) {
            const std::string word(identifierAt(text, i));
            if (before != '.' && names.contains(word)) out += prefix;
            out += word;
            before = word.back();
            i += word.size();
        } else if (std::isdigit(static_cast<unsigned char>(text[i])) != 0) {
            const std::string_view number = identifierAt(text, i);
            out += number;
            before = number.back();
            i += number.size();
        } else {
            if (text[i] == '\n' || std::isspace(static_cast<unsigned char>(text[i])) == 0) before = text[i];
            out += text[i++];
        }
    }
    return out;
}

std::string glslLiteral(const parameter::Parameter& p, const parameter::Value& value) {
    const auto number = [](double v) {
        std::string text = fmt::format("{:.9g}", static_cast<float>(v));
        if (text.find_first_of(".e") == std::string::npos) text += ".0";
        return text;
    };
    switch (p.type) {
    case parameter::Type::Bool:
        return std::get<bool>(value) ? "true" : "false";
    case parameter::Type::Int:
        return fmt::format("{}", std::get<std::int64_t>(value));
    case parameter::Type::Float:
        return number(std::get<double>(value));
    case parameter::Type::Choice: {
        const auto it = std::find(p.choices.begin(), p.choices.end(), std::get<std::string>(value));
        return fmt::format("{}", it - p.choices.begin());
    }
    case parameter::Type::Vec2: {
        const auto& v = std::get<glm::dvec2>(value);
        return fmt::format("vec2({}, {})", number(v.x), number(v.y));
    }
    case parameter::Type::Vec3: {
        const auto& v = std::get<glm::dvec3>(value);
        return fmt::format("vec3({}, {}, {})", number(v.x), number(v.y), number(v.z));
    }
    case parameter::Type::Vec4: {
        const auto& v = std::get<glm::dvec4>(value);
        return fmt::format("vec4({}, {}, {}, {})", number(v.x), number(v.y), number(v.z), number(v.w));
    }
    default:
        throw Error(ErrorKind::BadInput, fmt::format("'{}' cannot be a GLSL value", p.name), p.where);
    }
}

void ShaderSource::append(const std::string& name, bool embedded, const std::string& text) {
    files_.push_back({name, embedded});
    const std::size_t file = files_.size() - 1;
    static const std::regex kInclude(R"(^\s*#\s*include\s+"([^"]+)\"\s*$)");
    static const std::regex kPragma(R"(^\s*#\s*pragma\s+apeiron\b.*)");
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::smatch match;
        if (line.find('#') != std::string::npos && std::regex_match(line, match, kInclude)) {
            const std::string path = match[1];
            if (!included_.contains(path) && !findResource(path)) {
                throw Error(ErrorKind::BadInput, fmt::format("cannot include \"{}\"", path),
                            fmt::format("{}:{}", name, number), "include paths are relative to src/");
            }
            addFile(path);
            continue;
        }
        if (line.find("pragma") != std::string::npos && std::regex_match(line, kPragma)) continue;
        text_ += line;
        text_ += '\n';
        places_.push_back({file, number});
    }
}

void ShaderSource::addFile(std::string_view path) {
    if (included_.contains(path)) return;
    const auto resource = findResource(path);
    if (!resource) throw Error(ErrorKind::BadInput, fmt::format("no embedded file '{}'", path));
    included_.emplace(path);
    append(std::string(path), true, withoutComments(resource->text));
}

void ShaderSource::addText(const std::string& name, const std::string& text) {
    append(name, true, text);
}

void ShaderSource::addModule(const parameter::GlslModule& module, const std::string& prefix,
                             const parameter::Node& node, const std::string& slot, bool specialise, Rename rename) {
    // A chosen module may be there several times, each with names of its own.
    const std::string included = rename == Rename::All ? prefix + module.file : module.file;
    if (module.embedded && !included_.insert(included).second) return;
    std::string text = withoutComments(module.source);
    std::set<std::string> names;
    if (rename != Rename::Parameters) {
        names = globalNames(text);
        if (rename == Rename::All) names.erase("kernel_main");
    } else {
        for (const parameter::Parameter& p : module.parameters)
            if (p.uniform) names.insert(p.name);
    }
    text = withPrefix(text, names, prefix);
    std::map<std::string, std::string, std::less<>> constants;
    for (const parameter::Parameter& p : module.parameters) {
        if (!p.uniform) continue; // a file's name and the like: nothing that a shader sees
        const std::string uniform = prefix + p.name;
        if (specialise || p.invalidates == parameter::Invalidates::Program) {
            constants.emplace(uniform, glslLiteral(p, node.value(p.name)));
        } else {
            bindings_.push_back({uniform, p.name, slot});
        }
    }
    text = withConstants(text, constants);
    append(module.file, module.embedded, text);
}

std::string ShaderSource::placeOf(int line) const {
    const Place& place = places_.at(static_cast<std::size_t>(line) - 1);
    return fmt::format("{}:{}", files_[place.file].name, place.line);
}

std::vector<ShaderSource::Output> ShaderSource::outputs() const {
    static const std::regex kMain(R"(\bvoid\s+kernel_main\s*\(([^)]*)\))");
    static const std::regex kOutput(R"(\bout\s+(?:highp\s+)?(\w+)\s+(\w+))");
    std::smatch match;
    std::vector<Output> outputs;
    // Looked for from nearby: a search of all of the text takes longer than everything else that is done to it.
    bool found = false;
    for (std::size_t at = 0; !found && (at = text_.find("kernel_main", at)) != std::string::npos; ++at) {
        const std::size_t start = text_.rfind("void", at);
        if (start == std::string::npos || (start > 0 && isIdentifier(text_[start - 1]))) continue;
        found = std::regex_search(text_.cbegin() + static_cast<std::ptrdiff_t>(start), text_.cend(), match, kMain,
                                  std::regex_constants::match_continuous);
    }
    if (!found) return outputs;
    const std::string parameters = match[1];
    for (std::sregex_iterator it(parameters.begin(), parameters.end(), kOutput), end; it != end; ++it) {
        outputs.push_back({(*it)[1], (*it)[2]});
    }
    return outputs;
}

std::vector<ShaderSource::Mistake> ShaderSource::parseLog(const std::string& log) const {
    // Mesa: "0:12(5): error: ...", ANGLE and glslang: "ERROR: 0:12: ...", NVIDIA: "0(12) : error C1008: ...".
    // The file's number is of no use: Mesa loses it for all but syntax errors. Hence lines of the whole text.
    static const std::regex kMesa(R"(^\d+:(\d{1,9})\(\d+\): (?:\w+ )?error: (.*)$)");
    static const std::regex kAngle(R"(^ERROR: \d+:(\d{1,9}): (.*)$)");
    static const std::regex kNvidia(R"(^\d+\((\d{1,9})\) : error (.*)$)");
    std::vector<Mistake> mistakes;
    std::istringstream lines(log);
    std::string line;
    while (std::getline(lines, line)) {
        std::smatch match;
        for (const std::regex* pattern : {&kMesa, &kAngle, &kNvidia}) {
            if (!std::regex_match(line, match, *pattern)) continue;
            const auto number = static_cast<std::size_t>(std::stoul(match[1]));
            if (number >= 1 && number <= places_.size()) mistakes.push_back({places_[number - 1], match[2]});
            break;
        }
    }
    return mistakes;
}

std::string ShaderSource::mapLog(const std::string& log) const {
    const std::vector<Mistake> mistakes = parseLog(log);
    if (mistakes.empty()) return log;
    std::string out;
    if (files_[mistakes.front().place.file].embedded) {
        for (const File& file : files_) {
            if (!file.embedded) out += file.name + " does not fit: ";
        }
    }
    for (const Mistake& mistake : mistakes) {
        out += fmt::format("{}{}:{}: {}", &mistake == mistakes.data() ? "" : "\n", files_[mistake.place.file].name,
                           mistake.place.line, mistake.message);
    }
    return out;
}

bool ShaderSource::blamesUser(const std::string& log) const {
    return !parseLog(log).empty() &&
           std::any_of(files_.begin(), files_.end(), [](const File& file) { return !file.embedded; });
}

} // namespace apeiron::gpu
