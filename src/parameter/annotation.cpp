#include "parameter/annotation.hpp"

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "parameter/fail.hpp"
#include "parameter/text.hpp"

#include <algorithm>
#include <set>

namespace apeiron::parameter {
namespace {

/// A word, or what stands inside a pair of brackets.
struct Token {
    char kind; ///< 'w' or the opening bracket
    std::string_view text;
};

std::vector<Token> tokenize(std::string_view text) {
    std::vector<Token> tokens;
    while (!(text = trimmed(text)).empty()) {
        const char first = text.front();
        if (first == '(' || first == '[' || first == '{') {
            const char closing = first == '(' ? ')' : first == '[' ? ']' : '}';
            const std::size_t end = text.find(closing);
            if (end == std::string_view::npos) fail(std::string("'") + first + "' without '" + closing + "'");
            tokens.push_back({first, trimmed(text.substr(1, end - 1))});
            text.remove_prefix(end + 1);
        } else {
            const std::size_t end = std::min(text.find_first_of(" \t([{"), text.size());
            tokens.push_back({'w', text.substr(0, end)});
            text.remove_prefix(end);
        }
    }
    return tokens;
}

Type typeOf(std::string_view glslType) {
    for (const Type type : {Type::Bool, Type::Int, Type::Float, Type::Vec2, Type::Vec3, Type::Vec4})
        if (toString(type) == glslType) return type;
    fail("a uniform of type " + std::string(glslType) + " cannot be a parameter",
         "known: bool, int, float, vec2, vec3, vec4");
}

double numberIn(std::string_view text, const char* what) {
    const std::optional<double> number = parseNumber(text);
    if (!number) fail(std::string(what) + ": expected a number, got " + inQuotes(text));
    return *number;
}

/// Collects the pieces of one annotation, in whatever order they come.
class AnnotationParser {
  public:
    AnnotationParser(std::string_view glslType, std::string name, Invalidates byDefault) {
        parameter_.name = std::move(name);
        parameter_.type = typeOf(glslType);
        parameter_.invalidates = byDefault;
        parameter_.uniform = true;
    }

    Parameter parse(std::string_view annotation) {
        const std::size_t bar = annotation.find('|');
        if (bar != std::string_view::npos) parameter_.doc = trimmed(annotation.substr(bar + 1));
        tokens_ = tokenize(annotation.substr(0, bar));
        readChoices();
        for (next_ = 0; next_ < tokens_.size();)
            readPiece(tokens_[next_++]);
        finish();
        return std::move(parameter_);
    }

  private:
    void once(const std::string& piece) {
        if (!seen_.insert(piece).second) fail("two of " + piece);
    }

    /// First of all, because a label may look like any other word of the grammar.
    void readChoices() {
        for (const Token& token : tokens_) {
            if (token.kind != '{') continue;
            once("{...}");
            if (parameter_.type != Type::Int) fail("{...} needs an int uniform");
            parameter_.type = Type::Choice;
            for (const std::string_view label : splitAtCommas(token.text)) {
                if (label.empty()) fail("an empty label in {...}");
                if (std::find(parameter_.choices.begin(), parameter_.choices.end(), label) != parameter_.choices.end())
                    fail("the label '" + std::string(label) + "' is given twice");
                parameter_.choices.emplace_back(label);
            }
            if (parameter_.choices.empty()) fail("{} without labels");
        }
    }

    void readPiece(const Token& token) {
        if (token.kind == '{') return;
        if (token.kind == '[') return readRange(token.text);
        if (token.kind == '(') return readDefault(token.text);
        const bool isLabel =
            std::find(parameter_.choices.begin(), parameter_.choices.end(), token.text) != parameter_.choices.end();
        if (isLabel && !seen_.contains("default value")) return readDefault(token.text);
        if (token.text == "step") return readStep();
        if (token.text == "unit") {
            once("unit");
            parameter_.unit = argument("unit");
        } else if (token.text == "log") {
            once("log");
            parameter_.logarithmic = true;
        } else if (token.text == "color") {
            once("color");
            parameter_.color = true;
        } else if (token.text == "invalidates") {
            once("invalidates");
            parameter_.invalidates = parseInvalidates(argument("invalidates"));
        } else {
            readWord(token.text);
        }
    }

    void readWord(std::string_view word) {
        // A misspelt keyword is more likely than a second default value.
        const bool number = std::string_view("+-.0123456789").find(word.front()) != std::string_view::npos;
        if (number || word == "true" || word == "false") return readDefault(word);
        if (parameter_.type == Type::Choice && !seen_.contains("default value")) return readDefault(word);
        static const std::vector<std::string> kWords{"step", "unit", "log", "color", "invalidates"};
        fail("unknown word " + inQuotes(word), suggestion(word, kWords));
    }

    void readDefault(std::string_view text) {
        once("default value");
        default_ = text;
    }

    void readRange(std::string_view text) {
        once("[min, max]");
        const std::vector<std::string_view> ends = splitAtCommas(text);
        if (ends.size() != 2) fail("expected [min, max], got [" + std::string(text) + "]");
        parameter_.minimum = numberIn(ends[0], "min");
        parameter_.maximum = numberIn(ends[1], "max");
        if (*parameter_.minimum > *parameter_.maximum) fail("min is above max in [" + std::string(text) + "]");
    }

    void readStep() {
        once("step");
        parameter_.step = numberIn(argument("step"), "step");
        if (*parameter_.step <= 0) fail("step must be above 0");
    }

    std::string_view argument(const char* word) {
        if (next_ == tokens_.size() || tokens_[next_].kind != 'w') fail(std::string(word) + " needs a value");
        return tokens_[next_++].text;
    }

    void finish() {
        const bool numeric = parameter_.type != Type::Bool && parameter_.type != Type::Choice;
        if (!numeric && (parameter_.minimum || parameter_.step || parameter_.logarithmic))
            fail("a " + std::string(toString(parameter_.type)) + " has no [min, max], step or log");
        if (parameter_.color && parameter_.type != Type::Vec3) fail("only a vec3 can be a color");
        if (!seen_.contains("default value")) fail("no default value", "write it after //!");
        try {
            parameter_.defaultValue = valueFromText(parameter_, default_);
        } catch (const Error& error) {
            throw error.at("default value");
        }
    }

    Parameter parameter_;
    std::vector<Token> tokens_;
    std::size_t next_ = 0;
    std::string_view default_;
    std::set<std::string> seen_;
};

} // namespace

Invalidates parseInvalidates(std::string_view text) {
    std::vector<std::string> known;
    for (const Invalidates i :
         {Invalidates::Nothing, Invalidates::Present, Invalidates::Samples, Invalidates::Program}) {
        if (toString(i) == text) return i;
        known.emplace_back(toString(i));
    }
    fail("unknown value " + inQuotes(text) + " of invalidates", suggestion(text, known));
}

Parameter parseAnnotation(std::string_view glslType, std::string name, std::string_view annotation,
                          Invalidates byDefault) {
    return AnnotationParser(glslType, std::move(name), byDefault).parse(annotation);
}

} // namespace apeiron::parameter
