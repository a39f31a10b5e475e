#include "parameter/glsl_module.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "core/resources.hpp"
#include "core/suggest.hpp"
#include "parameter/annotation.hpp"
#include "parameter/fail.hpp"
#include "parameter/glsl_lines.hpp"
#include "parameter/text.hpp"

#include <algorithm>

namespace apeiron::parameter {
namespace {

constexpr std::string_view kExtension = ".glsl";

bool isIdentifierCharacter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool isIdentifier(std::string_view text) {
    return !text.empty() && !(text.front() >= '0' && text.front() <= '9') &&
           std::all_of(text.begin(), text.end(), isIdentifierCharacter);
}

/// Cuts the first word, up to white space, off a text.
std::string_view takeWord(std::string_view& text) {
    text = trimmed(text);
    const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
    const std::string_view word = text.substr(0, end);
    text = trimmed(text.substr(end));
    return word;
}

struct UniformDeclaration {
    std::string_view type;
    std::string_view name;
};

/// `uniform [highp] TYPE NAME;` and nothing else.
UniformDeclaration parseUniform(std::string_view code) {
    if (takeWord(code) != "uniform") fail("an annotation (//!) without a uniform on its line");
    if (!code.ends_with(';')) fail("an annotated uniform must stand on one line, with its ';'");
    code = trimmed(code.substr(0, code.size() - 1));
    UniformDeclaration uniform;
    uniform.type = takeWord(code);
    for (const std::string_view precision : {"highp", "mediump", "lowp"})
        if (uniform.type == precision) {
            uniform.type = takeWord(code);
            break;
        }
    uniform.name = code;
    if (!isIdentifier(uniform.type) || !isIdentifier(uniform.name))
        fail("cannot read this annotated uniform", "write 'uniform TYPE NAME; //! ...'");
    if (uniform.name.starts_with("gl_") || uniform.name.find("__") != std::string_view::npos)
        fail("the name '" + std::string(uniform.name) + "' is reserved in GLSL", "give it another name");
    if (uniform.name == "type") fail("a parameter cannot be called 'type'", "scenes use that key for something else");
    return uniform;
}

/// KEY and VALUE of `#pragma apeiron KEY VALUE...`; an empty key for other code.
std::pair<std::string, std::string> parsePragma(std::string_view code) {
    if (!code.starts_with('#')) return {};
    code.remove_prefix(1);
    if (takeWord(code) != "pragma" || takeWord(code) != "apeiron") return {};
    const std::string_view key = takeWord(code);
    if (key.empty()) fail("#pragma apeiron needs a key");
    return {std::string(key), std::string(code)};
}

std::string leadingDoc(const std::vector<GlslLine>& lines) {
    std::string doc;
    bool started = false;
    for (const GlslLine& line : lines) {
        const bool isDoc = line.code.empty() && line.hasComment && line.comment.starts_with('/');
        if (!isDoc && (started || !line.code.empty())) break;
        if (!isDoc) continue; // blank lines and a licence may come first
        std::string_view text = line.comment.substr(1);
        if (text.starts_with(' ')) text.remove_prefix(1);
        if (started) doc += '\n';
        doc += text.substr(0, text.find_last_not_of(" \t") + 1);
        started = true;
    }
    return doc;
}

class ModuleParser {
  public:
    explicit ModuleParser(GlslModule& module) : module_(module), lines_(splitGlslLines(module.source)) {}

    void parse() {
        if (module_.source.find('\0') != std::string::npos)
            throw Error(ErrorKind::BadInput, "is not a text file", module_.file);
        // A user's module is saved inside the scene's JSON.
        if (!isUtf8(module_.source) || !isUtf8(module_.name))
            throw Error(ErrorKind::BadInput, "is not in UTF-8", module_.file, "save it as UTF-8");
        module_.doc = leadingDoc(lines_);
        // Tags first: they set defaults for uniforms anywhere in the file.
        forEachLine([&] { readTag(); });
        if (const auto tag = module_.tags.find("invalidates"); tag != module_.tags.end())
            byDefault_ = parseInvalidates(tag->second); // checked where it stands, by readTag()
        forEachLine([&] { readUniform(); });
        if (const auto tag = module_.tags.find("picture"); tag != module_.tags.end()) addPicture(tag->second);
    }

  private:
    std::string place() const { return module_.file + ":" + std::to_string(index_ + 1); }

    template <class F> void forEachLine(const F& read) {
        for (index_ = 0; index_ < lines_.size(); ++index_) {
            const std::string where = place();
            try {
                read();
            } catch (const Error& error) {
                throw error.at(where);
            }
        }
    }

    void readTag() {
        const auto [key, value] = parsePragma(lines_[index_].code);
        if (key.empty()) return;
        std::string& tag = module_.tags[key];
        tag += (tag.empty() ? "" : " ") + value;
        if (key == "invalidates") parseInvalidates(tag);
    }

    /// The file of the picture that the module is made of.
    void addPicture(const std::string& name) {
        if (!isIdentifier(name)) throw Error(ErrorKind::BadInput, "#pragma apeiron picture needs a name", module_.file);
        Parameter parameter;
        parameter.name = name;
        parameter.type = Type::Text;
        parameter.defaultValue = std::string();
        parameter.path = true;
        parameter.invalidates = Invalidates::Program; // everything that can fail is made anew aside
        parameter.doc = "The picture's file, relative to the document";
        parameter.where = module_.file;
        module_.parameters.push_back(std::move(parameter));
    }

    static bool isAnnotated(const GlslLine& line) { return line.hasComment && line.comment.starts_with('!'); }

    void readUniform() {
        const GlslLine& line = lines_[index_];
        if (!isAnnotated(line)) return;
        const std::string where = place();
        const UniformDeclaration uniform = parseUniform(line.code);
        std::string annotation(line.comment.substr(1));
        while (index_ + 1 < lines_.size() && lines_[index_ + 1].code.empty() && isAnnotated(lines_[index_ + 1])) {
            annotation += ' ';
            annotation += trimmed(lines_[++index_].comment.substr(1));
        }

        Parameter parameter = parseAnnotation(uniform.type, std::string(uniform.name), annotation, byDefault_);
        parameter.where = where;
        for (const Parameter& other : module_.parameters)
            if (other.name == parameter.name)
                fail("the parameter '" + parameter.name + "' is already declared in " + other.where);
        module_.parameters.push_back(std::move(parameter));
    }

    GlslModule& module_;
    std::vector<GlslLine> lines_;
    std::size_t index_ = 0;
    Invalidates byDefault_ = Invalidates::Samples;
};

bool looksLikePath(std::string_view name) {
    return name.find('/') != std::string_view::npos || name.ends_with(kExtension);
}

/// "mandelbulb" of "fractal/formulas/mandelbulb.glsl"
std::string nameOf(std::string_view path) {
    path.remove_prefix(path.rfind('/') + 1); // npos + 1 is 0
    path.remove_suffix(kExtension.size());
    return std::string(path);
}

} // namespace

GlslModule parseModule(std::string name, std::string file, std::string source) {
    GlslModule module;
    module.name = std::move(name);
    module.file = std::move(file);
    module.source = std::move(source);
    ModuleParser(module).parse();
    return module;
}

GlslModule loadModule(std::string_view folder, const ModuleReference& reference, const std::filesystem::path& base) {
    if (reference.source) {
        GlslModule module = parseModule(reference.name, reference.name, *reference.source);
        module.embedded = false;
        return module;
    }
    if (looksLikePath(reference.name)) {
        const std::filesystem::path path = base / reference.name;
        GlslModule module = parseModule(reference.name, path.string(), readFile(path));
        module.embedded = false;
        return module;
    }
    for (const Resource& resource : resourcesInFolder(folder, kExtension))
        if (nameOf(resource.path) == reference.name)
            return parseModule(reference.name, std::string(resource.path), std::string(resource.text));
    fail("unknown module " + inQuotes(reference.name) + " of " + std::string(folder),
         suggestion(reference.name, moduleNames(folder)));
}

std::vector<std::string> moduleNames(std::string_view folder) {
    std::vector<std::string> names;
    for (const Resource& resource : resourcesInFolder(folder, kExtension))
        names.push_back(nameOf(resource.path));
    return names;
}

} // namespace apeiron::parameter
