#include "parameter/json_source.hpp"
#include "support.hpp"

namespace apeiron::parameter {
namespace {

using test::messageOf;
using testing::HasSubstr;
using testing::StartsWith;

JsonSource parse(const std::string& text) {
    return JsonSource::parse("a.json", text);
}
std::string errorOf(const std::string& text) {
    return messageOf([&] { parse(text); });
}

TEST(JsonSourceTest, values_know_their_line) {
    const JsonSource source = parse("{\n  \"camera\": {\n    \"fov\": 3,\n    \"list\": [1,\n 2]\n  }\n}");
    EXPECT_EQ(source.where("/camera/fov"), "a.json:3 (/camera/fov)");
    EXPECT_EQ(source.where("/camera/list/1"), "a.json:5 (/camera/list/1)");
    EXPECT_EQ(source.where("/camera/nothing/here"), "a.json:2 (/camera)");
    EXPECT_EQ(source.where(""), "a.json:1");
    EXPECT_EQ(source.where("/nothing"), "a.json:1");
}

TEST(JsonSourceTest, every_kind_of_value_is_read) {
    const Json root =
        parse("\xEF\xBB\xBF{\"a\": [true, false, null, -1.5e3, 12, \"x\\n\\u00e4\"], \"b\": {}, \"c\": []}").root();
    EXPECT_EQ(root.dump(), "{\"a\":[true,false,null,-1500.0,12,\"x\\n\xC3\xA4\"],\"b\":{},\"c\":[]}");
    EXPECT_EQ(parse("18446744073709551615").root().get<std::uint64_t>(), 18446744073709551615U);
}

TEST(JsonSourceTest, key_order_is_kept) {
    EXPECT_EQ(parse("{\"z\":1,\"a\":2}").root().dump(), "{\"z\":1,\"a\":2}");
}

TEST(JsonSourceTest, comments_are_space) {
    EXPECT_EQ(parse("// one\n{ /* two\n\n */ \"a\": 1 // three\n}").root().dump(), "{\"a\":1}");
    EXPECT_EQ(parse("{ /* two\n\n */ \"a\": 1}").where("/a"), "a.json:3 (/a)");
    EXPECT_EQ(parse("{\"a\": \"// no /* comment */\"}").root()["a"], "// no /* comment */");
}

TEST(JsonSourceTest, broken_text_is_one_clear_line_with_its_place) {
    EXPECT_EQ(errorOf("{\"a\": 1,\n \"b\" 2}"), "a.json:2:6: expected ':' after the key, got \"2\"");
    EXPECT_EQ(errorOf("{\"a\": 1\n \"b\": 2}"), "a.json:2:2: expected ',' or '}', got '\"'");
    EXPECT_EQ(errorOf("[1, 2,]"), "a.json:1:7: a ',' too many before ']'");
    EXPECT_EQ(errorOf("{\"a\": 1,}"), "a.json:1:9: a ',' too many before '}'");
    EXPECT_EQ(errorOf("{\"a\": orbit}"), "a.json:1:7: expected a value, got \"orbit\"; texts need double quotes");
    EXPECT_EQ(errorOf("{a: 1}"), "a.json:1:2: expected a key in double quotes, got \"a\"");
    EXPECT_EQ(errorOf("{\"a\": \"b"), "a.json:1:7: this string has no end");
    EXPECT_EQ(errorOf("{\"\xC3\xA4\": .5}"), "a.json:1:7: expected a value, got \".5\"; texts need double quotes");
    EXPECT_EQ(errorOf("{"), "a.json:1:2: expected a key in double quotes, got end of file");
    EXPECT_EQ(errorOf("{\"a\":"), "a.json:1:6: expected a value, got end of file");
    EXPECT_EQ(errorOf(" \n"), "a.json:2:1: the document is empty");
    EXPECT_EQ(errorOf("{} x"), "a.json:1:4: unexpected \"x\" after the end of the document");
    EXPECT_EQ(errorOf("[01]"), "a.json:1:2: bad number \"01\"");
    EXPECT_EQ(errorOf("[1.]"), "a.json:1:2: bad number \"1.\"");
    EXPECT_EQ(errorOf("[-]"), "a.json:1:2: bad number \"-\"");
    EXPECT_EQ(errorOf("{ /* x"), "a.json:1:3: this comment has no end");
}

TEST(JsonSourceTest, key_given_twice_is_an_error_that_names_both_lines) {
    EXPECT_EQ(errorOf("{\"a\": 1,\n \"b\": 2,\n \"a\": 3}"),
              "a.json:3:2: the key \"a\" is given twice; first in line 1");
    EXPECT_EQ(errorOf("{\"a\": 1, \"\\u0061\": 3}"), "a.json:1:10: the key \"a\" is given twice; first in line 1");
}

TEST(JsonSourceTest, keys_with_slashes_have_pointers_of_their_own) {
    const JsonSource source = parse("{\"a\": {\"b\": 1},\n \"a/b\": 2,\n \"~\": 3}");
    EXPECT_EQ(source.where("/a/b"), "a.json:1 (/a/b)");
    EXPECT_EQ(source.where(JsonSource::child("", "a/b")), "a.json:2 (/a~1b)");
    EXPECT_EQ(source.where(JsonSource::child("", "~")), "a.json:3 (/~0)");
}

TEST(JsonSourceTest, hostile_text_is_refused_without_harm) {
    EXPECT_THAT(errorOf(std::string(1'000'000, '[')), HasSubstr("nested deeper than 200 levels"));
    EXPECT_EQ(errorOf("[1e999]"), "a.json:1:2: this number is too large");
    EXPECT_THAT(errorOf(std::string("{\0}", 3)),
                HasSubstr("a.json:1:2: expected a key in double quotes, got character 0x00"));
    EXPECT_THAT(errorOf(std::string("[\"a\0b\"]", 7)), HasSubstr("a control character in a string"));
    EXPECT_THAT(errorOf("[\"\xFF\"]"), HasSubstr("bad UTF-8"));
    EXPECT_THAT(errorOf("[\"\\x\"]"), HasSubstr("bad escape"));
    EXPECT_THAT(errorOf("[\"\\ud800\"]"), HasSubstr("bad escape"));
    EXPECT_THAT(errorOf("[\"\\"), HasSubstr("no end"));
    EXPECT_THAT(errorOf("[NaN]"), StartsWith("a.json:1:2: expected a value"));
}

TEST(JsonSourceTest, every_prefix_of_a_document_is_refused_or_read_without_harm) {
    const std::string text = "{\"a\": [1.5e3, \"x\\u00e4\", {\"b\": null}], /* c */ \"d\": true} // e";
    for (std::size_t length = 0; length < text.size(); ++length) {
        const std::string message = errorOf(text.substr(0, length));
        EXPECT_THAT(message, testing::AnyOf("no error", StartsWith("a.json:1:"))) << length;
    }
}

} // namespace
} // namespace apeiron::parameter
