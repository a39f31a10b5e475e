#include "gpu/glsl_syntax.hpp"

#include <array>
#include <cctype>
#include <set>

namespace apeiron::gpu::glsl {
namespace {

using Kind = Token::Kind;

bool isWordCharacter(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

class Lexer {
  public:
    explicit Lexer(const std::string& text) : text_(text) {}

    std::vector<Token> run() {
        while (at_ < text_.size())
            next();
        tokens_.push_back({Kind::End, "", line_});
        return std::move(tokens_);
    }

  private:
    void next() {
        const char c = text_[at_];
        if (c == '\n') {
            ++line_;
            lineStart_ = true;
            ++at_;
        } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
            ++at_;
        } else if (c == '#' && lineStart_) {
            directive();
        } else {
            lineStart_ = false;
            if (std::isdigit(static_cast<unsigned char>(c)) != 0 ||
                (c == '.' && at_ + 1 < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_ + 1])) != 0))
                number();
            else if (isWordCharacter(c))
                word();
            else
                sign();
        }
    }

    void push(Kind kind, std::string text) { tokens_.push_back({kind, std::move(text), line_}); }

    void number() {
        const std::size_t start = at_;
        bool real = false;
        const bool hex =
            text_[at_] == '0' && at_ + 1 < text_.size() && (text_[at_ + 1] == 'x' || text_[at_ + 1] == 'X');
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '.') {
                real = true;
            } else if (!hex && (c == 'e' || c == 'E')) {
                real = true;
                if (at_ + 1 < text_.size() && (text_[at_ + 1] == '+' || text_[at_ + 1] == '-')) ++at_;
            } else if (!isWordCharacter(c)) {
                break;
            }
        }
        std::string text = text_.substr(start, at_ - start);
        const char last = text.back();
        if (!hex && (last == 'f' || last == 'F')) real = true;
        const Kind kind = real ? Kind::Float : (last == 'u' || last == 'U' ? Kind::Uint : Kind::Int);
        push(kind, std::move(text));
    }

    void word() {
        const std::size_t start = at_;
        while (at_ < text_.size() && isWordCharacter(text_[at_]))
            ++at_;
        const std::string name = text_.substr(start, at_ - start);
        const auto macro = macros_.find(name);
        if (macro == macros_.end()) return push(Kind::Name, name);
        for (Token token : macro->second) {
            token.line = line_;
            tokens_.push_back(std::move(token));
        }
    }

    void sign() {
        static constexpr std::array kLong{"<<=", ">>=", "++", "--", "<=", ">=", "==", "!=", "&&", "||", "^^",
                                          "+=",  "-=",  "*=", "/=", "%=", "<<", ">>", "&=", "|=", "^="};
        for (const std::string_view candidate : kLong) {
            if (text_.compare(at_, candidate.size(), candidate) != 0) continue;
            push(Kind::Sign, std::string(candidate));
            at_ += candidate.size();
            return;
        }
        push(Kind::Sign, std::string(1, text_[at_++]));
    }

    /// Constants by macros are replaced; other directives stay as tokens, for whoever stumbles over them.
    void directive() {
        const int line = line_;
        std::string whole;
        for (; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
            if (text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') {
                ++line_;
                ++at_;
                continue;
            }
            whole += text_[at_];
        }
        std::vector<Token> parts = Lexer(whole.substr(1)).run();
        const bool define = parts.size() > 2 && parts[0].text == "define";
        const std::size_t nameEnd =
            define ? whole.find(parts[1].text, whole.find("define") + 6) + parts[1].text.size() : 0;
        if (define && whole.substr(nameEnd, 1) != "(") {
            macros_[parts[1].text] = expanded({parts.begin() + 2, parts.end() - 1});
        } else {
            tokens_.push_back({Kind::Directive, whole, line});
        }
    }

    std::vector<Token> expanded(const std::vector<Token>& tokens) const {
        std::vector<Token> all;
        for (const Token& token : tokens) {
            const auto macro = macros_.find(token.text);
            if (macro == macros_.end())
                all.push_back(token);
            else
                all.insert(all.end(), macro->second.begin(), macro->second.end());
        }
        return all;
    }

    const std::string& text_;
    std::size_t at_ = 0;
    int line_ = 1;
    bool lineStart_ = true;
    std::vector<Token> tokens_;
    std::map<std::string, std::vector<Token>> macros_;
};

/// Precedence of binary operators; higher binds tighter.
int precedence(const std::string& op) {
    static const std::map<std::string, int> kLevels{
        {"*", 12}, {"/", 12}, {"%", 12}, {"+", 11}, {"-", 11}, {"<<", 10}, {">>", 10}, {"<", 9},  {">", 9}, {"<=", 9},
        {">=", 9}, {"==", 8}, {"!=", 8}, {"&", 7},  {"^", 6},  {"|", 5},   {"&&", 4},  {"^^", 3}, {"||", 2}};
    const auto level = kLevels.find(op);
    return level != kLevels.end() ? level->second : 0;
}

class Parser {
  public:
    Parser(const Unit& unit, std::size_t at) : unit_(unit), at_(at) {
        for (const Struct& s : unit.structs)
            types_.insert(s.name);
    }

    void parseGlobals(Unit& unit) {
        while (peek().kind != Kind::End) {
            if (peek().kind == Kind::Directive || accept(";")) {
                if (peek().kind == Kind::Directive) ++at_;
            } else if (peek().text == "precision" || peek().text == "layout") {
                skipPast(";");
            } else if (peek().text == "struct") {
                parseStruct(unit);
            } else {
                parseGlobal(unit);
            }
        }
    }

    StatementPtr block() {
        auto result = statementOf(Statement::Kind::Block);
        while (!accept("}"))
            result->body.push_back(statement());
        return result;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const { throw Unsupported{peek().line, what}; }

    const Token& peek(std::size_t ahead = 0) const {
        return unit_.tokens[std::min(at_ + ahead, unit_.tokens.size() - 1)];
    }
    bool is(std::string_view text, std::size_t ahead = 0) const { return peek(ahead).text == text; }
    bool accept(std::string_view text) {
        if (!is(text)) return false;
        ++at_;
        return true;
    }
    void expect(std::string_view text) {
        if (!accept(text)) fail("'" + peek().text + "' where '" + std::string(text) + "' is expected");
    }
    std::string name() {
        if (peek().kind != Kind::Name) fail("'" + peek().text + "' where a name is expected");
        return unit_.tokens[at_++].text;
    }
    void skipPast(std::string_view text) {
        while (peek().kind != Kind::End && !accept(text))
            ++at_;
    }
    void skipBraces() {
        for (int depth = 1; depth > 0 && peek().kind != Kind::End; ++at_) {
            if (is("{")) ++depth;
            if (is("}")) --depth;
        }
    }
    bool isType(std::string_view text) const { return isBuiltinType(text) || types_.contains(text); }

    StatementPtr statementOf(Statement::Kind kind) const {
        auto result = std::make_unique<Statement>();
        result->kind = kind;
        result->line = peek().line;
        return result;
    }

    std::string array() {
        std::string text;
        while (accept("[")) {
            text += "[";
            while (!accept("]"))
                text += unit_.tokens[at_++].text;
            text += "]";
        }
        return text;
    }

    /// Qualifiers in front of a type; whether they make a constant of it.
    bool qualifiers(std::string* direction = nullptr) {
        static const std::set<std::string, std::less<>> kQualifiers{"const",    "uniform",   "in",     "out",  "inout",
                                                                    "highp",    "mediump",   "lowp",   "flat", "smooth",
                                                                    "centroid", "invariant", "precise"};
        bool constant = false;
        while (kQualifiers.contains(peek().text)) {
            if (is("const") || is("uniform")) constant = true;
            if (direction != nullptr && (is("in") || is("out") || is("inout"))) *direction = peek().text;
            ++at_;
        }
        return constant;
    }

    void parseStruct(Unit& unit) {
        ++at_;
        Struct result;
        result.name = name();
        expect("{");
        while (!accept("}")) {
            qualifiers();
            const std::string type = name();
            do {
                Variable member;
                member.type = type;
                member.line = peek().line;
                member.name = name();
                member.array = array();
                result.members.push_back(std::move(member));
            } while (accept(","));
            expect(";");
        }
        types_.insert(result.name);
        unit.structs.push_back(std::move(result));
        skipPast(";");
    }

    void parseGlobal(Unit& unit) {
        const int line = peek().line;
        const bool constant = qualifiers();
        const std::string type = name() + array();
        if (accept(";")) return;
        const std::string first = name();
        if (accept("(")) {
            auto function = std::make_unique<Function>();
            function->type = type;
            function->name = first;
            function->line = line;
            parameters(*function);
            if (accept(";")) return; // a prototype
            expect("{");
            function->bodyAt = at_;
            skipBraces();
            unit.functions.push_back(std::move(function));
            return;
        }
        --at_;
        do {
            auto variable = std::make_unique<Variable>();
            variable->line = peek().line;
            variable->name = name();
            variable->array = array();
            variable->type = type + (variable->array.empty() ? "" : "[]");
            variable->constant = constant;
            unit.variables.push_back(std::move(variable));
            // Its value stays where it is.
            int depth = 0;
            while (peek().kind != Kind::End && (depth > 0 || (!is(",") && !is(";")))) {
                if (is("(") || is("{") || is("[")) ++depth;
                if (is(")") || is("}") || is("]")) --depth;
                ++at_;
            }
        } while (accept(","));
        expect(";");
    }

    void parameters(Function& function) {
        if (is("void") && is(")", 1)) ++at_;
        if (accept(")")) return;
        do {
            auto parameter = std::make_unique<Variable>();
            parameter->direction = "in";
            parameter->line = peek().line;
            qualifiers(&parameter->direction);
            parameter->type = name() + array();
            if (peek().kind == Kind::Name) parameter->name = name();
            parameter->array = array();
            if (!parameter->array.empty()) parameter->type += "[]";
            function.parameters.push_back(std::move(parameter));
        } while (accept(","));
        expect(")");
    }

    StatementPtr statement() {
        if (peek().kind == Kind::Directive) fail("a preprocessor directive inside a function");
        if (peek().kind == Kind::End) fail("a function without its '}'");
        if (accept("{")) return block();
        if (is("if")) return ifStatement();
        if (is("for")) return forStatement();
        if (is("while")) {
            auto result = statementOf(Statement::Kind::While);
            ++at_;
            expect("(");
            result->condition = expression();
            expect(")");
            result->body.push_back(statement());
            return result;
        }
        if (is("do")) {
            auto result = statementOf(Statement::Kind::Do);
            ++at_;
            result->body.push_back(statement());
            expect("while");
            expect("(");
            result->condition = expression();
            expect(")");
            expect(";");
            return result;
        }
        if (is("return")) {
            auto result = statementOf(Statement::Kind::Return);
            ++at_;
            if (!is(";")) result->expressions.push_back(expression());
            expect(";");
            return result;
        }
        if (is("break") || is("continue")) {
            auto result = statementOf(is("break") ? Statement::Kind::Break : Statement::Kind::Continue);
            ++at_;
            expect(";");
            return result;
        }
        if (is("switch") || is("discard") || is("struct")) fail("'" + peek().text + "' inside a function");
        auto result = simple();
        expect(";");
        return result;
    }

    /// A declaration or an expression, without its ';'.
    StatementPtr simple() {
        if (is(";")) return statementOf(Statement::Kind::Block);
        const bool declares = is("const") || is("highp") || is("mediump") || is("lowp") ||
                              (peek().kind == Kind::Name && isType(peek().text) && !is("(", 1) && !constructsArray());
        if (!declares) {
            auto result = statementOf(Statement::Kind::Expression);
            do
                result->expressions.push_back(expression());
            while (accept(","));
            return result;
        }
        auto result = statementOf(Statement::Kind::Declaration);
        const bool constant = qualifiers();
        const std::string type = name();
        const std::string common = array();
        do {
            auto variable = std::make_unique<Variable>();
            variable->line = peek().line;
            variable->name = name();
            variable->array = common + array();
            variable->type = type + (variable->array.empty() ? "" : "[]");
            variable->constant = constant;
            if (accept("=")) variable->value = expression();
            result->variables.push_back(std::move(variable));
        } while (accept(","));
        return result;
    }

    /// Whether `float[3](...)` follows, not a declaration `float[3] x`.
    bool constructsArray() const {
        std::size_t ahead = 1;
        if (!is("[", ahead)) return false;
        while (!is("]", ahead) && peek(ahead).kind != Kind::End)
            ++ahead;
        return is("(", ahead + 1);
    }

    StatementPtr ifStatement() {
        auto result = statementOf(Statement::Kind::If);
        ++at_;
        expect("(");
        result->condition = expression();
        expect(")");
        result->body.push_back(statement());
        if (accept("else")) result->body.push_back(statement());
        return result;
    }

    StatementPtr forStatement() {
        auto result = statementOf(Statement::Kind::For);
        ++at_;
        expect("(");
        result->first = simple();
        expect(";");
        if (!is(";")) result->condition = expression();
        expect(";");
        if (!is(")")) {
            do
                result->expressions.push_back(expression());
            while (accept(","));
        }
        expect(")");
        result->body.push_back(statement());
        return result;
    }

    ExpressionPtr make(Expression::Kind kind, std::string text) const {
        auto result = std::make_unique<Expression>();
        result->kind = kind;
        result->text = std::move(text);
        result->line = peek().line;
        return result;
    }

    ExpressionPtr expression() {
        ExpressionPtr left = ternary();
        static const std::set<std::string, std::less<>> kAssignments{
            "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="};
        if (peek().kind != Kind::Sign || !kAssignments.contains(peek().text)) return left;
        auto result = make(Expression::Kind::Assign, unit_.tokens[at_++].text);
        result->parts.push_back(std::move(left));
        result->parts.push_back(expression());
        return result;
    }

    ExpressionPtr ternary() {
        ExpressionPtr condition = binary(1);
        if (!accept("?")) return condition;
        auto result = make(Expression::Kind::Ternary, "?");
        result->parts.push_back(std::move(condition));
        result->parts.push_back(expression());
        expect(":");
        result->parts.push_back(ternary());
        return result;
    }

    ExpressionPtr binary(int least) {
        ExpressionPtr left = unary();
        while (peek().kind == Kind::Sign) {
            const int level = precedence(peek().text);
            if (level == 0 || level < least) break;
            auto result = make(Expression::Kind::Binary, unit_.tokens[at_++].text);
            result->parts.push_back(std::move(left));
            result->parts.push_back(binary(level + 1));
            left = std::move(result);
        }
        return left;
    }

    ExpressionPtr unary() {
        for (const char* op : {"++", "--", "+", "-", "!", "~"}) {
            if (!is(op)) continue;
            auto result = make(Expression::Kind::Unary, op);
            ++at_;
            result->parts.push_back(unary());
            return result;
        }
        return postfix(primary());
    }

    ExpressionPtr primary() {
        const Token token = peek();
        if (accept("(")) {
            ExpressionPtr inside = expression();
            expect(")");
            return inside;
        }
        if (token.kind == Kind::Int || token.kind == Kind::Uint || token.kind == Kind::Float) {
            auto result = make(Expression::Kind::Literal, token.text);
            result->type = token.kind == Kind::Float ? "float" : (token.kind == Kind::Int ? "int" : "uint");
            ++at_;
            return result;
        }
        if (token.kind != Kind::Name) fail("'" + token.text + "' where a value is expected");
        if (token.text == "true" || token.text == "false") {
            auto result = make(Expression::Kind::Literal, token.text);
            result->type = "bool";
            ++at_;
            return result;
        }
        if (isType(token.text) && is("[", 1)) {
            auto result = make(Expression::Kind::Call, token.text);
            ++at_;
            result->arrayType = token.text + array();
            arguments(*result);
            return result;
        }
        if (is("(", 1)) {
            auto result = make(Expression::Kind::Call, token.text);
            ++at_;
            arguments(*result);
            return result;
        }
        auto result = make(Expression::Kind::Name, token.text);
        ++at_;
        return result;
    }

    void arguments(Expression& call) {
        expect("(");
        if (is("void") && is(")", 1)) ++at_;
        if (accept(")")) return;
        do
            call.parts.push_back(expression());
        while (accept(","));
        expect(")");
    }

    ExpressionPtr postfix(ExpressionPtr base) {
        for (;;) {
            ExpressionPtr outer;
            if (is("[")) {
                outer = make(Expression::Kind::Index, "[]");
                ++at_;
                outer->parts.push_back(std::move(base));
                outer->parts.push_back(expression());
                expect("]");
            } else if (is(".")) {
                outer = make(Expression::Kind::Member, "");
                ++at_;
                outer->text = name();
                outer->parts.push_back(std::move(base));
                if (is("(")) fail("." + outer->text + "()");
            } else if (is("++") || is("--")) {
                outer = make(Expression::Kind::Postfix, unit_.tokens[at_++].text);
                outer->parts.push_back(std::move(base));
            } else {
                return base;
            }
            base = std::move(outer);
        }
    }

    const Unit& unit_;
    std::size_t at_;
    std::set<std::string, std::less<>> types_;
};

} // namespace

bool isBuiltinType(std::string_view name) {
    static const std::set<std::string, std::less<>> kTypes{
        "void",   "bool",   "int",       "uint",       "float",      "vec2",      "vec3",       "vec4",   "ivec2",
        "ivec3",  "ivec4",  "uvec2",     "uvec3",      "uvec4",      "bvec2",     "bvec3",      "bvec4",  "mat2",
        "mat3",   "mat4",   "mat2x2",    "mat2x3",     "mat2x4",     "mat3x2",    "mat3x3",     "mat3x4", "mat4x2",
        "mat4x3", "mat4x4", "sampler2D", "isampler2D", "usampler2D", "sampler3D", "samplerCube"};
    return kTypes.contains(name);
}

const Struct* Unit::findStruct(std::string_view name) const {
    for (const Struct& candidate : structs)
        if (candidate.name == name) return &candidate;
    return nullptr;
}

Unit parse(const std::string& text) {
    Unit unit;
    unit.tokens = Lexer(text).run();
    Parser(unit, 0).parseGlobals(unit);
    return unit;
}

void parseBody(const Unit& unit, Function& function) {
    if (!function.body) function.body = Parser(unit, function.bodyAt).block();
}

} // namespace apeiron::gpu::glsl
