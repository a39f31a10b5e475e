#include "gpu/differentiate.hpp"

#include "core/error.hpp"
#include "gpu/glsl_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>

namespace apeiron::gpu {
namespace {

using namespace glsl;

using ExpressionKind = Expression::Kind;
using StatementKind = Statement::Kind;

[[noreturn]] void fail(int line, const std::string& what) {
    throw Unsupported{line, what};
}

/// Finds types, and what depends on the arguments: a variable is active once anything active may be assigned to it.
class Analysis {
  public:
    explicit Analysis(Unit& unit) : unit_(unit) {
        for (const auto& variable : unit.variables)
            globals_[variable->name] = variable.get();
    }

    /// Whether values of the type have gradients.
    bool isDual(const std::string& type) const {
        if (floatSize(type) > 0) return true;
        const Struct* s = unit_.findStruct(type);
        return s != nullptr && std::any_of(s->members.begin(), s->members.end(),
                                           [&](const Variable& m) { return m.array.empty() && isDual(m.type); });
    }

    void run(Function& function) {
        parseBody(unit_, function);
        do {
            changed_ = false;
            scopes_.assign(1, {});
            for (const auto& parameter : function.parameters) {
                parameter->active = isDual(parameter->type);
                scopes_.back()[parameter->name] = parameter.get();
            }
            visit(*function.body);
        } while (changed_);
    }

    /// The function that a call means; null for GLSL's own and constructors.
    Function* called(const Expression& call) const {
        Function* found = nullptr;
        for (const auto& function : unit_.functions) {
            if (function->name != call.text || function->parameters.size() != call.parts.size()) continue;
            const bool fits = std::equal(function->parameters.begin(), function->parameters.end(), call.parts.begin(),
                                         [](const auto& p, const auto& e) { return p->type == e->type; });
            if (fits) return function.get();
            found = function.get();
        }
        if (found != nullptr) fail(call.line, fmt::format("a call of '{}' whose arguments do not fit", call.text));
        return nullptr;
    }

    const Unit& unit() const { return unit_; }

  private:
    void activate(Variable& variable) {
        if (variable.active || !isDual(variable.type)) return;
        variable.active = true;
        changed_ = true;
    }

    void visit(Statement& s) {
        const bool scope = s.kind == StatementKind::Block || s.kind == StatementKind::For;
        if (scope) scopes_.emplace_back();
        if (s.first) visit(*s.first);
        if (s.condition) visit(*s.condition);
        for (const auto& variable : s.variables) {
            if (variable->value) {
                visit(*variable->value);
                if (variable->value->active) {
                    if (!variable->array.empty()) fail(variable->line, "an array that depends on the position");
                    activate(*variable);
                }
            }
            scopes_.back()[variable->name] = variable.get();
        }
        for (const auto& expression : s.expressions)
            visit(*expression);
        for (const auto& inner : s.body)
            visit(*inner);
        if (scope) scopes_.pop_back();
    }

    void visit(Expression& e) {
        for (const auto& part : e.parts)
            visit(*part);
        switch (e.kind) {
        case ExpressionKind::Literal:
            break;
        case ExpressionKind::Name:
            visitName(e);
            break;
        case ExpressionKind::Unary:
        case ExpressionKind::Postfix:
            e.type = e.text == "!" ? "bool" : e.parts[0]->type;
            e.active = e.parts[0]->active && isDual(e.type);
            break;
        case ExpressionKind::Binary:
            e.type = binaryType(e.text, e.parts[0]->type, e.parts[1]->type);
            e.active = e.type != "bool" && (e.parts[0]->active || e.parts[1]->active);
            if (e.active && isMatrix(e.type)) fail(e.line, "a matrix that depends on the position");
            break;
        case ExpressionKind::Assign:
            e.type = e.parts[0]->type;
            e.active = isDual(e.type) && (e.parts[0]->active || e.parts[1]->active);
            if (e.active && e.parts[1]->active) assign(*e.parts[0]);
            break;
        case ExpressionKind::Ternary:
            e.type = e.parts[1]->type;
            e.active = e.parts[1]->active || e.parts[2]->active;
            break;
        case ExpressionKind::Call:
            visitCall(e);
            break;
        case ExpressionKind::Member:
            visitMember(e);
            break;
        case ExpressionKind::Index:
            visitIndex(e);
            break;
        }
    }

    void visitName(Expression& e) {
        e.variable = nullptr;
        for (auto scope = scopes_.rbegin(); scope != scopes_.rend() && e.variable == nullptr; ++scope)
            if (const auto found = scope->find(e.text); found != scope->end()) e.variable = found->second;
        if (e.variable == nullptr) {
            const auto global = globals_.find(e.text);
            if (global == globals_.end()) fail(e.line, fmt::format("'{}', which is declared nowhere", e.text));
            if (!global->second->constant) fail(e.line, fmt::format("the global variable '{}'", e.text));
            e.variable = global->second;
        }
        e.type = e.variable->type;
        e.active = e.variable->active;
    }

    /// Something active goes into this place.
    void assign(Expression& place) {
        Expression* root = &place;
        while (root->kind == ExpressionKind::Member || root->kind == ExpressionKind::Index)
            root = root->parts[0].get();
        if (root->kind != ExpressionKind::Name) fail(place.line, "an assignment to something that is no variable");
        if (root->type.ends_with("[]")) fail(place.line, "an array that depends on the position");
        if (isMatrix(root->type)) fail(place.line, "a matrix that depends on the position");
        activate(*root->variable);
    }

    void visitCall(Expression& e) {
        const bool any = std::any_of(e.parts.begin(), e.parts.end(), [](const auto& part) { return part->active; });
        std::vector<std::string> types;
        for (const auto& part : e.parts)
            types.push_back(part->type);
        if (!e.arrayType.empty()) {
            e.type = e.text + "[]";
            if (any) fail(e.line, "an array that depends on the position");
            return;
        }
        if (isBuiltinType(e.text) || unit_.findStruct(e.text) != nullptr) {
            e.type = e.text;
            e.active = any && isDual(e.type);
            if (any && isMatrix(e.type)) fail(e.line, "a matrix that depends on the position");
            return;
        }
        if (Function* function = called(e)) {
            e.type = function->type;
            e.active = any && isDual(e.type);
            if (!any) return;
            for (std::size_t i = 0; i < e.parts.size(); ++i)
                if (function->parameters[i]->direction != "in" && isDual(e.parts[i]->type)) assign(*e.parts[i]);
            return;
        }
        e.type = builtinType(e.text, types);
        if (e.type.empty()) fail(e.line, fmt::format("the function '{}'", e.text));
        static const std::set<std::string, std::less<>> kFlat{"floor", "ceil", "round", "roundEven",
                                                              "trunc", "sign", "step"};
        e.active = any && isDual(e.type) && !kFlat.contains(e.text);
    }

    void visitMember(Expression& e) {
        const Expression& base = *e.parts[0];
        if (const Struct* s = unit_.findStruct(base.type)) {
            const auto member =
                std::find_if(s->members.begin(), s->members.end(), [&](const Variable& m) { return m.name == e.text; });
            if (member == s->members.end()) fail(e.line, fmt::format("'.{}', which {} does not have", e.text, s->name));
            e.type = member->type + (member->array.empty() ? "" : "[]");
            e.active = base.active && isDual(e.type);
            return;
        }
        const std::string& whole = base.type;
        const char last = whole.back();
        const std::vector<int> indices = swizzle(e.text);
        const std::size_t size = indices.size();
        if (size == 0 || *std::max_element(indices.begin(), indices.end()) >= last - '0')
            fail(e.line, fmt::format("'.{}' of a {}", e.text, whole));
        const std::string stem =
            last >= '2' && last <= '4' ? whole.substr(0, whole.size() - 1) : whole; // "vec", "ivec"
        const std::map<std::string, std::string> scalars{
            {"vec", "float"}, {"ivec", "int"}, {"uvec", "uint"}, {"bvec", "bool"}};
        const auto scalar = scalars.find(stem);
        if (scalar == scalars.end()) fail(e.line, fmt::format("'.{}' of a {}", e.text, whole));
        e.type = size == 1 ? scalar->second : stem + std::to_string(size);
        e.active = base.active && isDual(e.type);
    }

    void visitIndex(Expression& e) {
        const Expression& base = *e.parts[0];
        if (base.type.ends_with("[]"))
            e.type = base.type.substr(0, base.type.size() - 2);
        else if (isMatrix(base.type))
            e.type = floatType(base.type.back() - '0');
        else if (floatSize(base.type) > 1)
            e.type = "float";
        else
            e.type = base.type.starts_with("i") ? "int" : (base.type.starts_with("u") ? "uint" : "bool");
        e.active = base.active && isDual(e.type);
    }

    Unit& unit_;
    std::map<std::string, Variable*> globals_;
    std::vector<std::map<std::string, Variable*>> scopes_;
    bool changed_ = false;
};

/// Writes functions anew, on dual numbers.
class Writer {
  public:
    explicit Writer(Analysis& analysis) : analysis_(analysis) {}

    std::string run(const std::vector<std::string>& roots) {
        for (const std::string& root : roots) {
            const std::size_t before = wanted_.size();
            for (const auto& function : analysis_.unit().functions)
                if (function->name == root) want(*function);
            if (wanted_.size() == before) fail(1, fmt::format("'{}', which is not there", root));
        }
        std::string bodies;
        while (!wanted_.empty()) {
            Function& function = *wanted_.front();
            wanted_.pop_front();
            analysis_.run(function);
            prototypes_ += signature(function) + ";\n";
            out_.clear();
            function_ = &function;
            line(signature(function) + " {");
            block(*function.body);
            line("}");
            bodies += out_;
        }
        std::string text;
        for (const Struct& s : analysis_.unit().structs)
            if (structs_.contains(s.name)) text += structText(s);
        for (const auto& [name, helper] : helpers_)
            text += helper;
        return text + prototypes_ + bodies;
    }

  private:
    void want(Function& function) {
        if (seen_.insert(&function).second) wanted_.push_back(&function);
    }

    std::string dualType(const std::string& type) {
        if (const int size = floatSize(type); size > 0) return size == 1 ? "Dual" : fmt::format("Dual{}", size);
        if (!analysis_.isDual(type)) return type;
        if (structs_.insert(type).second)
            for (const Variable& member : analysis_.unit().findStruct(type)->members)
                if (member.array.empty()) dualType(member.type);
        return "Dual" + type;
    }

    /// A struct's counterpart, and the ways to and fro.
    std::string structText(const Struct& s) {
        const auto wrapped = [](bool wrap, const char* function, const std::string& member) {
            return wrap ? fmt::format("{}(a.{})", function, member) : "a." + member;
        };
        std::string members;
        std::string there;
        std::string back;
        for (const Variable& m : s.members) {
            const bool isDual = m.array.empty() && analysis_.isDual(m.type);
            members += fmt::format(" {} {}{};", isDual ? dualType(m.type) : m.type, m.name, m.array);
            const char* comma = there.empty() ? "" : ", ";
            there += fmt::format("{}{}", comma, wrapped(isDual, "dual", m.name));
            back += fmt::format("{}{}", comma, wrapped(isDual, "dual_value", m.name));
        }
        return fmt::format("struct Dual{0} {{{1} }};\nDual{0} dual({0} a) {{ return Dual{0}({2}); }}\n"
                           "{0} dual_value(Dual{0} a) {{ return {0}({3}); }}\n"
                           "Dual{0} dual_select(bool c, Dual{0} a, Dual{0} b) {{ if (c) return a; return b; }}\n",
                           s.name, members, there, back);
    }

    std::string signature(const Function& f) {
        std::string parameters;
        for (const auto& p : f.parameters)
            parameters += fmt::format("{}{}{} {}{}", parameters.empty() ? "" : ", ",
                                      p->direction == "in" ? "" : p->direction + " ", typeOf(*p), p->name, p->array);
        return fmt::format("{} {}({})", dualType(f.type), f.name, parameters);
    }

    std::string typeOf(const Variable& v) {
        const std::string base = v.array.empty() ? v.type : v.type.substr(0, v.type.size() - 2);
        return v.active ? dualType(base) : base;
    }

    // Statements

    void line(const std::string& text) { out_ += std::string(4 * depth_, ' ') + text + "\n"; }

    void block(const Statement& s) {
        ++depth_;
        for (const auto& inner : s.body)
            statement(*inner);
        --depth_;
    }

    /// A branch or a loop's body, in braces whatever it is.
    void body(const Statement& s) {
        if (s.kind == StatementKind::Block) return block(s);
        ++depth_;
        statement(s);
        --depth_;
    }

    void statement(const Statement& s) {
        switch (s.kind) {
        case StatementKind::Block:
            line("{");
            block(s);
            line("}");
            break;
        case StatementKind::Declaration:
            for (const auto& variable : s.variables)
                line(declaration(*variable) + ";");
            break;
        case StatementKind::Expression:
            for (const auto& expression : s.expressions)
                line(action(*expression) + ";");
            break;
        case StatementKind::If:
            line(fmt::format("if ({}) {{", value(*s.condition)));
            body(*s.body[0]);
            if (s.body.size() > 1) {
                line("} else {");
                body(*s.body[1]);
            }
            line("}");
            break;
        case StatementKind::For:
            forStatement(s);
            break;
        case StatementKind::While:
            line(fmt::format("while ({}) {{", value(*s.condition)));
            body(*s.body[0]);
            line("}");
            break;
        case StatementKind::Do:
            line("do {");
            body(*s.body[0]);
            line(fmt::format("}} while ({});", value(*s.condition)));
            break;
        case StatementKind::Return:
            if (s.expressions.empty())
                line("return;");
            else
                line(fmt::format("return {};", as(*s.expressions[0], analysis_.isDual(function_->type))));
            break;
        case StatementKind::Break:
            line("break;");
            break;
        case StatementKind::Continue:
            line("continue;");
            break;
        }
    }

    std::string declaration(const Variable& v) {
        std::string text =
            fmt::format("{}{} {}{}", v.constant && !v.active ? "const " : "", typeOf(v), v.name, v.array);
        if (v.value) text += " = " + as(*v.value, v.active);
        return text;
    }

    void forStatement(const Statement& s) {
        std::string first;
        if (s.first->kind == StatementKind::Declaration) {
            // A declaration names one type only.
            for (const auto& v : s.first->variables)
                if (typeOf(*v) != typeOf(*s.first->variables[0]))
                    fail(s.line, "a for loop over variables of several kinds");
            for (const auto& v : s.first->variables)
                first += first.empty()
                             ? declaration(*v)
                             : fmt::format(", {}{}", v->name, v->value ? " = " + as(*v->value, v->active) : "");
        } else {
            for (const auto& e : s.first->expressions)
                first += (first.empty() ? "" : ", ") + action(*e);
        }
        std::string steps;
        for (const auto& e : s.expressions)
            steps += (steps.empty() ? "" : ", ") + action(*e);
        line(fmt::format("for ({}; {}; {}) {{", first, s.condition ? value(*s.condition) : "", steps));
        body(*s.body[0]);
        line("}");
    }

    /// An expression that stands for what it does.
    std::string action(const Expression& e) {
        if (e.kind == ExpressionKind::Assign) {
            const Expression& place = *e.parts[0];
            if (!place.active) return fmt::format("{} {} {}", plain(place), e.text, value(*e.parts[1]));
            if (e.text == "=") return store(place, dual(*e.parts[1]));
            return store(place, arithmetic(e.text.substr(0, e.text.size() - 1), place, *e.parts[1]));
        }
        if ((e.kind == ExpressionKind::Unary || e.kind == ExpressionKind::Postfix) &&
            (e.text == "++" || e.text == "--")) {
            if (!e.active) return plain(e);
            return store(*e.parts[0], fmt::format("{}({}, {}(1.0))", e.text == "++" ? "dual_add" : "dual_sub",
                                                  dual(*e.parts[0]), e.type));
        }
        if (e.kind == ExpressionKind::Call) return callStatement(e);
        return e.active ? dual(e) : plain(e);
    }

    /// A call whose results may go into parts of vectors.
    std::string callStatement(const Expression& e) {
        const Function* function = userFunction(e);
        if (function == nullptr || !anyActive(e)) return e.active ? dual(e) : plain(e);
        want(*analysis_.called(e));
        std::string before;
        std::string behind;
        std::string arguments;
        for (std::size_t i = 0; i < e.parts.size(); ++i) {
            const Expression& part = *e.parts[i];
            std::string argument = this->argument(*function, i, part);
            if (function->parameters[i]->direction != "in" && part.active && isPartOfVector(part)) {
                const std::string name = fmt::format("dual_part_{}", parts_++);
                before += fmt::format("{} {} = {}; ", dualType(part.type), name, dual(part));
                behind += "; " + store(part, name);
                argument = name;
            }
            arguments += (arguments.empty() ? "" : ", ") + argument;
        }
        return fmt::format("{}{}({}){}", before, e.text, arguments, behind);
    }

    std::string argument(const Function& function, std::size_t i, const Expression& part) {
        const Variable& parameter = *function.parameters[i];
        const bool dualParameter = analysis_.isDual(parameter.type);
        return as(part, dualParameter);
    }

    static bool isPartOfVector(const Expression& e) {
        return e.kind == ExpressionKind::Index || (e.kind == ExpressionKind::Member && floatSize(e.parts[0]->type) > 0);
    }

    /// Puts a dual number into a place.
    std::string store(const Expression& place, const std::string& what) {
        if (place.kind == ExpressionKind::Index)
            return fmt::format("dual_set_at({}, {}, {})", dual(*place.parts[0]), value(*place.parts[1]), what);
        if (!isPartOfVector(place)) return fmt::format("{} = {}", dual(place), what);
        if (isPartOfVector(*place.parts[0])) fail(place.line, "an assignment to a part of a part of a vector");
        const std::string type = dualType(place.parts[0]->type);
        const std::vector<int> indices = swizzle(place.text);
        std::string& helper = helpers_["set " + place.text + type];
        if (helper.empty()) {
            helper = fmt::format("void dual_set_{}(inout {} a, {} b) {{", place.text, type, dualType(place.type));
            if (indices.size() == 1) helper += fmt::format(" a.v[{0}] = b.v; a.g[{0}] = b.g;", indices[0]);
            for (std::size_t i = 0; indices.size() > 1 && i < indices.size(); ++i)
                helper += fmt::format(" a.v[{0}] = b.v[{1}]; a.g[{0}] = b.g[{1}];", indices[i], i);
            helper += " }\n";
        }
        return fmt::format("dual_set_{}({}, {})", place.text, dual(*place.parts[0]), what);
    }

    // Expressions

    static bool anyActive(const Expression& e) {
        return std::any_of(e.parts.begin(), e.parts.end(), [](const auto& part) { return part->active; });
    }

    std::string as(const Expression& e, bool wantDual) { return wantDual ? dual(e) : value(e); }

    /// Without gradients.
    std::string value(const Expression& e) {
        if (!e.active) return plain(e);
        return floatSize(e.type) > 0 ? dual(e) + ".v" : fmt::format("dual_value({})", dual(e));
    }

    /// What does not depend on the arguments, or only in steps: as it was.
    std::string plain(const Expression& e) {
        switch (e.kind) {
        case ExpressionKind::Literal:
        case ExpressionKind::Name:
            return e.text;
        case ExpressionKind::Unary:
            return fmt::format("({}{})", e.text, value(*e.parts[0]));
        case ExpressionKind::Postfix:
            return value(*e.parts[0]) + e.text;
        case ExpressionKind::Binary:
            return fmt::format("({} {} {})", value(*e.parts[0]), e.text, value(*e.parts[1]));
        case ExpressionKind::Assign:
            if (e.active) fail(e.line, "an assignment inside an expression");
            return fmt::format("({} {} {})", plain(*e.parts[0]), e.text, value(*e.parts[1]));
        case ExpressionKind::Ternary:
            return fmt::format("({} ? {} : {})", value(*e.parts[0]), value(*e.parts[1]), value(*e.parts[2]));
        case ExpressionKind::Call: {
            std::string arguments;
            const Function* function = userFunction(e);
            const bool dualCall = function != nullptr && anyActive(e); // of another type, such as bool
            for (std::size_t i = 0; i < e.parts.size(); ++i)
                arguments +=
                    (i == 0 ? "" : ", ") + (dualCall ? argument(*function, i, *e.parts[i]) : value(*e.parts[i]));
            if (dualCall) want(*analysis_.called(e));
            return fmt::format("{}({})", e.arrayType.empty() ? e.text : e.arrayType, arguments);
        }
        case ExpressionKind::Member:
            return fmt::format("{}.{}", e.parts[0]->active ? dual(*e.parts[0]) : plain(*e.parts[0]), e.text);
        case ExpressionKind::Index:
            return fmt::format("{}[{}]", value(*e.parts[0]), value(*e.parts[1]));
        }
        return {};
    }

    const Function* userFunction(const Expression& e) const {
        const bool constructor = isBuiltinType(e.text) || analysis_.unit().findStruct(e.text) != nullptr;
        return constructor || !e.arrayType.empty() ? nullptr : analysis_.called(e);
    }

    /// Whether it does more than to give a value.
    bool hasEffects(const Expression& e) const {
        if (e.kind == ExpressionKind::Assign || e.kind == ExpressionKind::Postfix) return true;
        if (e.kind == ExpressionKind::Unary && e.text.size() == 2) return true;
        const Function* function = e.kind == ExpressionKind::Call ? userFunction(e) : nullptr;
        return (function != nullptr && std::any_of(function->parameters.begin(), function->parameters.end(),
                                                   [](const auto& p) { return p->direction != "in"; })) ||
               std::any_of(e.parts.begin(), e.parts.end(), [&](const auto& part) { return hasEffects(*part); });
    }

    /// With gradients.
    std::string dual(const Expression& e) {
        if (!e.active) {
            dualType(e.type); // its struct, if it is one
            return fmt::format("dual({})", plain(e));
        }
        switch (e.kind) {
        case ExpressionKind::Name:
            return e.text;
        case ExpressionKind::Unary:
            if (e.text == "-") return fmt::format("dual_neg({})", dual(*e.parts[0]));
            if (e.text == "+") return dual(*e.parts[0]);
            break;
        case ExpressionKind::Binary:
            return arithmetic(e.text, *e.parts[0], *e.parts[1]);
        case ExpressionKind::Ternary:
            // WebGL has no `? :` of structs.
            if (hasEffects(*e.parts[1]) || hasEffects(*e.parts[2]))
                fail(e.line, "a '?' between things that do more than to give a value");
            return fmt::format("dual_select({}, {}, {})", value(*e.parts[0]), dual(*e.parts[1]), dual(*e.parts[2]));
        case ExpressionKind::Call:
            return call(e);
        case ExpressionKind::Member:
            return member(e);
        case ExpressionKind::Index:
            return fmt::format("dual_at({}, {})", dual(*e.parts[0]), value(*e.parts[1]));
        default:
            break;
        }
        fail(e.line, e.kind == ExpressionKind::Assign ? "an assignment inside an expression"
                                                      : fmt::format("'{}' inside an expression", e.text));
    }

    std::string arithmetic(const std::string& op, const Expression& a, const Expression& b) {
        static const std::map<std::string, std::string> kNames{
            {"+", "dual_add"}, {"-", "dual_sub"}, {"*", "dual_mul"}, {"/", "dual_div"}};
        const auto name = kNames.find(op);
        if (name == kNames.end()) fail(a.line, fmt::format("the operator '{}' on floats", op));
        const int size = std::max(floatSize(a.type), floatSize(b.type));
        const bool sum = op == "+" || op == "-";
        // Sums need the same number of components, and so does a scalar by a vector.
        const auto operand = [&](const Expression& e, bool widen) {
            std::string text = e.active ? dual(e) : plain(e);
            if (!widen || isMatrix(e.type) || floatSize(e.type) == size) return text;
            return e.active ? fmt::format("dual_vec{}({})", size, text) : fmt::format("vec{}({})", size, text);
        };
        return fmt::format("{}({}, {})", name->second, operand(a, sum || op == "/"), operand(b, sum));
    }

    std::string member(const Expression& e) {
        const Expression& base = *e.parts[0];
        if (floatSize(base.type) == 0) return fmt::format("{}.{}", dual(base), e.text);
        const std::string type = dualType(base.type);
        std::string& helper = helpers_["get " + e.text + type];
        if (helper.empty()) {
            const std::vector<int> indices = swizzle(e.text);
            std::string gradients;
            for (const int i : indices)
                gradients += fmt::format("{}a.g[{}]", gradients.empty() ? "" : ", ", i);
            const std::string all =
                indices.size() == 1
                    ? gradients
                    : fmt::format("{}({})", indices.size() == 3 ? "mat3" : fmt::format("mat{}x3", indices.size()),
                                  gradients);
            helper = fmt::format("{0} dual_get_{1}({2} a) {{ return {0}(a.v.{1}, {3}); }}\n", dualType(e.type), e.text,
                                 type, all);
        }
        return fmt::format("dual_get_{}({})", e.text, dual(base));
    }

    std::string call(const Expression& e) {
        if (const Struct* s = analysis_.unit().findStruct(e.text)) {
            std::string arguments;
            for (std::size_t i = 0; i < e.parts.size() && i < s->members.size(); ++i)
                arguments += (i == 0 ? "" : ", ") +
                             as(*e.parts[i], s->members[i].array.empty() && analysis_.isDual(s->members[i].type));
            return fmt::format("{}({})", dualType(e.text), arguments);
        }
        if (floatSize(e.text) > 0) return constructor(e);
        if (Function* function = analysis_.called(e)) {
            want(*function);
            std::string arguments;
            for (std::size_t i = 0; i < e.parts.size(); ++i) {
                if (function->parameters[i]->direction != "in" && isPartOfVector(*e.parts[i]))
                    fail(e.line, "an out argument that is a part of a vector, inside an expression");
                arguments += (i == 0 ? "" : ", ") + argument(*function, i, *e.parts[i]);
            }
            return fmt::format("{}({})", e.text, arguments);
        }
        return builtin(e);
    }

    std::string constructor(const Expression& e) {
        const int size = floatSize(e.text);
        if (size == 1) {
            const Expression& only = *e.parts[0];
            return floatSize(only.type) == 1 ? dual(only) : fmt::format("dual_at({}, 0)", dual(only));
        }
        std::string arguments;
        for (const auto& part : e.parts) {
            // An int among them is no float yet.
            const std::string argument = part->active                ? dual(*part)
                                         : floatSize(part->type) > 0 ? dual(*part)
                                                                     : fmt::format("dual(float({}))", plain(*part));
            arguments += (arguments.empty() ? "" : ", ") + argument;
        }
        return fmt::format("dual_{}({})", e.text, arguments);
    }

    std::string builtin(const Expression& e) {
        static const std::set<std::string, std::less<>> kKnown{
            "sin",         "cos",     "tan",     "asin",       "acos", "atan",   "sinh",      "cosh",  "tanh",   "exp",
            "log",         "exp2",    "log2",    "sqrt",       "pow",  "abs",    "min",       "max",   "fract",  "mod",
            "inversesqrt", "radians", "degrees", "smoothstep", "dot",  "length", "normalize", "cross", "reflect"};
        const int size = [&] {
            int most = 1;
            for (const auto& part : e.parts)
                most = std::max(most, floatSize(part->type));
            return most;
        }();
        const auto wide = [&](const Expression& part) {
            const std::string text = dual(part);
            return floatSize(part.type) == size ? text : fmt::format("dual_vec{}({})", size, text);
        };
        const auto& p = e.parts;
        if (e.text == "clamp")
            return fmt::format("dual_min(dual_max({}, {}), {})", wide(*p[0]), wide(*p[1]), wide(*p[2]));
        if (e.text == "distance") return fmt::format("dual_length(dual_sub({}, {}))", dual(*p[0]), dual(*p[1]));
        if (e.text == "mix") {
            if (floatSize(p[2]->type) == 0) fail(e.line, "mix() by truths");
            return fmt::format("dual_add(dual_mul({0}, dual_sub({2}(1.0), {3})), dual_mul({1}, {3}))", wide(*p[0]),
                               wide(*p[1]), p[2]->type, dual(*p[2]));
        }
        // A constant exponent or divisor has a cheaper rule.
        if ((e.text == "pow" || e.text == "mod") && !p[1]->active)
            return fmt::format("dual_{}({}, {}({}))", e.text, wide(*p[0]), floatType(size), plain(*p[1]));
        if (!kKnown.contains(e.text)) fail(e.line, fmt::format("the function '{}'", e.text));
        std::string arguments;
        for (const auto& part : p)
            arguments += (arguments.empty() ? "" : ", ") + wide(*part);
        return fmt::format("dual_{}({})", e.text, arguments);
    }

    Analysis& analysis_;
    std::deque<Function*> wanted_;
    std::set<const Function*> seen_;
    std::set<std::string> structs_;
    std::map<std::string, std::string> helpers_; ///< reading and writing parts of vectors
    std::string prototypes_;
    std::string out_;
    std::size_t depth_ = 0;
    int parts_ = 0;
    const Function* function_ = nullptr;
};

} // namespace

std::string differentiate(const std::string& text, const std::vector<std::string>& roots,
                          const std::function<std::string(int line)>& where) {
    try {
        Unit unit = parse(text);
        Analysis analysis(unit);
        return Writer(analysis).run(roots);
    } catch (const Unsupported& problem) {
        throw Error(ErrorKind::BadInput, fmt::format("cannot differentiate {}", problem.what), where(problem.line));
    }
}

} // namespace apeiron::gpu
