#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

// The syntax of plain GLSL ES 3.00 as far as differentiate() needs it: functions, structs, statements, expressions.
namespace apeiron::gpu::glsl {

struct Token {
    enum class Kind { Name, Int, Uint, Float, Sign, Directive, End };
    Kind kind = Kind::End;
    std::string text;
    int line = 0; ///< from 1
};

struct Expression;
using ExpressionPtr = std::unique_ptr<Expression>;

struct Variable;

struct Expression {
    enum class Kind { Literal, Name, Unary, Postfix, Binary, Assign, Ternary, Call, Member, Index };
    Kind kind = Kind::Literal;
    std::string text; ///< a literal, name, operator, called function or type, or member
    std::vector<ExpressionPtr> parts;
    int line = 0;
    std::string arrayType; ///< of an array's constructor: "float[3]"

    // What an analysis finds out.
    std::string type;
    bool active = false;          ///< it depends on what is differentiated by
    Variable* variable = nullptr; ///< of a Name
};

struct Variable {
    std::string type; ///< "float", "vec3", "Orbit", ...; "float[]" for arrays
    std::string name;
    std::string array; ///< as it stands in the declaration: "[3]"
    ExpressionPtr value;
    bool constant = false; ///< const or uniform
    std::string direction; ///< of a parameter: "in", "out" or "inout"
    int line = 0;
    bool active = false; ///< may hold something that depends on what is differentiated by
};

struct Statement;
using StatementPtr = std::unique_ptr<Statement>;

struct Statement {
    enum class Kind { Block, Declaration, Expression, If, For, While, Do, Return, Break, Continue };
    Kind kind = Kind::Block;
    std::vector<StatementPtr> body;                   ///< of a block; then and else; a loop's body
    std::vector<std::unique_ptr<Variable>> variables; ///< of a declaration
    std::vector<ExpressionPtr> expressions;           ///< the statement's, condition or returned value; a for's steps
    StatementPtr first;                               ///< of a for: what comes before it
    ExpressionPtr condition;
    int line = 0;
};

struct Function {
    std::string type; ///< that it returns
    std::string name;
    std::vector<std::unique_ptr<Variable>> parameters;
    std::size_t bodyAt = 0; ///< the token behind its '{'
    int line = 0;
    StatementPtr body; ///< null until parseBody()
};

struct Struct {
    std::string name;
    std::vector<Variable> members;
};

/// What a text declares at global scope. Bodies of functions are parsed when they are asked for, so that what is not
/// needed may be written as it likes.
struct Unit {
    std::vector<Token> tokens;
    std::vector<Struct> structs;
    std::vector<std::unique_ptr<Function>> functions; ///< with a body
    std::vector<std::unique_ptr<Variable>> variables;

    const Struct* findStruct(std::string_view name) const;
};

/// A construct that is not understood, and the line where it stands.
struct Unsupported {
    int line;
    std::string what;
};

/// Parses text without comments. @throws Unsupported
Unit parse(const std::string& text);
/// Parses the function's body, once. @throws Unsupported
void parseBody(const Unit& unit, Function& function);

/// Whether a name is a built-in type: "vec3", "mat2x3", "int", ...
bool isBuiltinType(std::string_view name);

} // namespace apeiron::gpu::glsl
