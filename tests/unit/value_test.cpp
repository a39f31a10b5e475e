#include "parameter/schema.hpp"
#include "support.hpp"

#include <limits>

namespace apeiron::parameter {
namespace {

using test::messageOf;
using testing::HasSubstr;

Parameter make(Type type, Value defaultValue = 0.0) {
    Parameter parameter;
    parameter.name = "p";
    parameter.type = type;
    parameter.defaultValue = std::move(defaultValue);
    return parameter;
}

Parameter ranged(Type type, double minimum, double maximum) {
    Parameter parameter = make(type);
    parameter.minimum = minimum;
    parameter.maximum = maximum;
    return parameter;
}

Value json(const Parameter& parameter, const char* text) {
    return valueFromJson(parameter, Json::parse(text));
}
std::string jsonError(const Parameter& parameter, const char* text) {
    return messageOf([&] { json(parameter, text); });
}
std::string textError(const Parameter& parameter, const char* text) {
    return messageOf([&] { valueFromText(parameter, text); });
}

TEST(ValueTest, range_errors_show_value_and_range) {
    EXPECT_EQ(jsonError(ranged(Type::Float, 2, 16), "99"), "99 is outside [2, 16]");
    EXPECT_EQ(textError(ranged(Type::Int, 2, 16), "1"), "1 is outside [2, 16]");
    EXPECT_EQ(jsonError(ranged(Type::Vec3, 0, 1), "[0, 0.5, 1.5]"), "1.5 is outside [0, 1]");
    EXPECT_NO_THROW(json(ranged(Type::Float, 2, 16), "16"));
    Parameter open = make(Type::Float);
    open.minimum = 0;
    EXPECT_EQ(jsonError(open, "-0.1"), "-0.1 is below 0");
}

TEST(ValueTest, type_errors_show_what_is_expected) {
    EXPECT_EQ(jsonError(make(Type::Float), "\"abc\""), "expected a number, got \"abc\"");
    EXPECT_EQ(textError(make(Type::Float), "abc"), "expected a number, got \"abc\"");
    EXPECT_EQ(jsonError(make(Type::Bool), "1"), "expected true or false, got 1");
    EXPECT_EQ(textError(make(Type::Bool), "yes"), "expected true or false, got \"yes\"");
    EXPECT_EQ(jsonError(make(Type::Float), "null"), "expected a number, got null");
    EXPECT_THAT(jsonError(make(Type::Text), "{\"a\": 1}"), HasSubstr("expected a text, got {\"a\":1}"));
}

TEST(ValueTest, integers_may_be_written_as_whole_doubles) {
    EXPECT_EQ(std::get<std::int64_t>(json(make(Type::Int), "12")), 12);
    EXPECT_EQ(std::get<std::int64_t>(json(make(Type::Int), "12.0")), 12);
    EXPECT_EQ(std::get<std::int64_t>(valueFromText(make(Type::Int), "1e3")), 1000);
    EXPECT_EQ(jsonError(make(Type::Int), "12.5"), "expected a whole number, got 12.5");
    EXPECT_THAT(jsonError(make(Type::Int), "1e300"), HasSubstr("expected a whole number"));
    EXPECT_THAT(jsonError(make(Type::Int), "18446744073709551615"), HasSubstr("expected a whole number"));
    EXPECT_EQ(std::get<double>(json(make(Type::Float), "12")), 12.0);
}

TEST(ValueTest, not_finite_is_refused) {
    for (const char* text : {"nan", "inf", "-inf", "1e999"})
        EXPECT_THAT(textError(make(Type::Float), text), HasSubstr("expected a number"));
    EXPECT_EQ(messageOf([] { validate(make(Type::Float), std::numeric_limits<double>::quiet_NaN()); }),
              "expected a finite number");
    EXPECT_EQ(messageOf([] { validate(make(Type::Vec2), glm::dvec2(0, std::numeric_limits<double>::infinity())); }),
              "expected a finite number");
}

TEST(ValueTest, vectors_are_read_from_several_spellings) {
    const glm::dvec3 expected(0.1, 0.2, 0.3);
    for (const char* text : {"0.1,0.2,0.3", "(0.1, 0.2, 0.3)", "[0.1, 0.2, 0.3]", " 0.1 , .2 , 3e-1 "})
        EXPECT_EQ(std::get<glm::dvec3>(valueFromText(make(Type::Vec3), text)), expected) << text;
    EXPECT_EQ(std::get<glm::dvec3>(json(make(Type::Vec3), "[0.1, 0.2, 0.3]")), expected);
    for (const char* text : {"1", "1,2", "1,2,3,4", "(1,2,3", "1,,3", "1,2,", "", "1 2 3", "[1,2,x]"})
        EXPECT_THAT(textError(make(Type::Vec3), text), HasSubstr("expected 3 numbers")) << text;
    for (const char* text : {"1", "[1]", "[1,2,\"3\"]", "{\"x\": 1}"})
        EXPECT_THAT(jsonError(make(Type::Vec3), text), HasSubstr("expected 3 numbers")) << text;
}

TEST(ValueTest, zero_vector_is_refused_where_a_direction_is_needed) {
    Parameter axis = make(Type::Vec4);
    axis.nonZero = true;
    EXPECT_EQ(textError(axis, "0,0,0,0"), "expected a vector that is not zero");
    EXPECT_NO_THROW(valueFromText(axis, "0,0,0,1e-9"));
}

TEST(ValueTest, decimals_keep_all_digits) {
    const std::string digits = "0.1234567890123456789012345678901234567890123";
    const Decimal3 expected{Decimal::parse(digits), Decimal::parse("-2"), Decimal::parse("0.5")};
    for (const std::string& text :
         {digits + ",-2,.5", "[\"" + digits + "\", -2, \"0.5\"]", "(" + digits + ", -2, 5e-1)"})
        EXPECT_EQ(std::get<Decimal3>(valueFromText(make(Type::Decimal3), text)), expected) << text;
    const Value value = valueFromJson(make(Type::Decimal3), Json::array({digits, -2, 0.5}));
    EXPECT_EQ(std::get<Decimal3>(value), expected);
    EXPECT_EQ(toJson(value).dump(), "[\"" + digits + "\",\"-2\",\"0.5\"]");
    EXPECT_EQ(jsonError(make(Type::Decimal3), "[\"1\", \"x\", 0]"), "expected a number, got \"x\"");
    EXPECT_THAT(jsonError(make(Type::Decimal3), "[1, 2]"), HasSubstr("expected 3 decimal numbers"));
    EXPECT_THAT(textError(make(Type::Decimal3), "1"), HasSubstr("expected 3 decimal numbers"));
}

TEST(ValueTest, unknown_label_gets_a_suggestion) {
    Parameter choice = make(Type::Choice);
    choice.choices = {"hard", "penumbra"};
    EXPECT_EQ(std::get<std::string>(valueFromText(choice, "penumbra")), "penumbra");
    EXPECT_EQ(std::get<std::string>(valueFromText(choice, "\"hard\"")), "hard");
    EXPECT_EQ(textError(choice, "penumbar"), "unknown value \"penumbar\"; did you mean 'penumbra'?");
    EXPECT_EQ(jsonError(choice, "1"), "expected a label, got 1; known: hard, penumbra");
}

TEST(ValueTest, text_stands_for_itself) {
    EXPECT_EQ(std::get<std::string>(valueFromText(make(Type::Text), "two words ")), "two words ");
    EXPECT_EQ(std::get<std::string>(valueFromText(make(Type::Text), "\"a\\nb\"")), "a\nb");
    EXPECT_EQ(std::get<std::string>(valueFromText(make(Type::Text), "\"half")), "\"half");
    EXPECT_EQ(textError(make(Type::Text), "caf\xE9"), "expected a text in UTF-8") << "it could not be saved";
}

TEST(ValueTest, modules_are_names_or_carry_their_source) {
    EXPECT_EQ(std::get<ModuleReference>(valueFromText(make(Type::Module), "mandelbulb")),
              (ModuleReference{"mandelbulb", {}}));
    const Value value = json(make(Type::Module), R"({"name": "mine", "source": "x"})");
    EXPECT_EQ(std::get<ModuleReference>(value), (ModuleReference{"mine", "x"}));
    EXPECT_EQ(toJson(value).dump(), R"({"name":"mine","source":"x"})");
    EXPECT_EQ(jsonError(make(Type::Module), R"({"name": "mine", "src": "x"})"),
              "unknown key \"src\"; known: name, source");
    EXPECT_EQ(jsonError(make(Type::Module), R"({"name": "mine", "source": 1})"), "source: expected a text, got 1");
    EXPECT_THAT(jsonError(make(Type::Module), "\"\""), HasSubstr("expected the name of a module"));
}

TEST(ValueTest, saved_numbers_read_back_exactly) {
    const double value = 0.1 + 0.2;
    EXPECT_EQ(Json::parse(toJson(Value(value)).dump()).get<double>(), value);
}

TEST(SchemaTest, unknown_name_gets_a_suggestion) {
    Schema schema;
    schema.add(make(Type::Float));
    Parameter power = make(Type::Float);
    power.name = "power";
    schema.add(power);
    EXPECT_EQ(messageOf([&] { schema.at("pwoer"); }), "unknown parameter 'pwoer'; did you mean 'power'?");
    EXPECT_EQ(schema.find("nothing"), nullptr);
    EXPECT_THAT(schema.names(), testing::ElementsAre("p", "power"));
}

TEST(SchemaTest, taken_name_is_an_error_that_names_both_places) {
    Parameter one = make(Type::Float);
    one.where = "a.glsl:1";
    Parameter two = make(Type::Float);
    two.where = "b.glsl:2";
    Schema schema;
    schema.add(one);
    EXPECT_THAT(messageOf([&] { schema.add(two); }),
                HasSubstr("b.glsl:2: the parameter 'p' is already declared in a.glsl:1"));
    EXPECT_EQ(schema.size(), 1U);
}

TEST(SchemaTest, default_that_is_not_valid_is_refused) {
    Parameter parameter = ranged(Type::Float, 0, 1);
    parameter.defaultValue = 2.0;
    EXPECT_THAT(messageOf([&] { Schema().add(parameter); }), HasSubstr("default of 'p': 2 is outside [0, 1]"));
}

TEST(SchemaTest, declaration_is_described_in_full) {
    Parameter parameter = ranged(Type::Float, 0, 1);
    parameter.unit = "px";
    parameter.doc = "A doc";
    EXPECT_EQ(toJson(parameter).dump(), R"({"name":"p","type":"float","default":0.0,"min":0.0,"max":1.0,"unit":"px",)"
                                        R"("invalidates":"samples","doc":"A doc"})");
}

} // namespace
} // namespace apeiron::parameter
