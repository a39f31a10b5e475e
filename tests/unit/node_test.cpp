#include "core/file.hpp"
#include "parameter/node.hpp"
#include "support.hpp"

namespace apeiron::parameter {
namespace {

using test::messageOf;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// A type with one parameter of each kind that matters and a module to exchange.
class NodeTest : public testing::Test {
  protected:
    NodeTest() : node_(type()) {
        node_.set("formula", ModuleReference{"a", "uniform float power; //! 8 [2, 16]\n"
                                                  "uniform int steps; //! 5 [1, 100] invalidates program\n"
                                                  "uniform float onlyA; //! 1"});
    }

    static std::shared_ptr<const NodeType> type() {
        Parameter size;
        size.name = "size";
        size.defaultValue = 1.0;
        size.minimum = 0;
        size.maximum = 10;
        Parameter shadow;
        shadow.name = "shadow";
        shadow.type = Type::Choice;
        shadow.choices = {"hard", "soft"};
        shadow.defaultValue = "soft";
        shadow.invalidates = Invalidates::Present;
        Parameter formula;
        formula.name = "formula";
        formula.type = Type::Module;
        formula.folder = "tonemappers"; // any folder that is never empty
        formula.defaultValue = ModuleReference{"plain", "float f;"};
        return std::make_shared<const NodeType>(NodeType{"subject", "fake", "A fake", {size, shadow, formula}, {}});
    }

    static ModuleReference otherModule() {
        return {"b", "uniform float power; //! 3 [1, 10]\nuniform int steps; //! 7 [1, 10]"};
    }

    Node node_;
};

TEST_F(NodeTest, starts_at_defaults) {
    EXPECT_EQ(node_.number("size"), 1.0);
    EXPECT_EQ(node_.number("power"), 8.0);
    EXPECT_EQ(node_.integer("steps"), 5);
    EXPECT_EQ(node_.choice("shadow"), 1);
    EXPECT_THAT(node_.schema().names(), ElementsAre("size", "shadow", "formula", "power", "steps", "onlyA"));
}

TEST_F(NodeTest, set_says_what_gets_stale) {
    EXPECT_EQ(node_.set("size", 2.0), Invalidates::Samples);
    EXPECT_EQ(node_.set("size", 2.0), Invalidates::Nothing);
    EXPECT_EQ(node_.setFromText("shadow", "hard"), Invalidates::Present);
    EXPECT_EQ(node_.setFromJson("steps", 6), Invalidates::Program);
    EXPECT_EQ(node_.set("formula", otherModule()), Invalidates::Program);
    EXPECT_EQ(node_.set("formula", otherModule()), Invalidates::Nothing);
}

TEST_F(NodeTest, integer_is_welcome_where_a_float_is_meant) {
    EXPECT_EQ(node_.set("size", std::int64_t{2}), Invalidates::Samples);
    EXPECT_EQ(node_.number("size"), 2.0);
}

TEST_F(NodeTest, new_module_keeps_changed_values_and_brings_its_own_defaults) {
    node_.set("power", 9.0);
    node_.set("size", 3.0);
    node_.set("formula", otherModule());
    EXPECT_EQ(node_.number("power"), 9.0) << "was changed and is still valid";
    EXPECT_EQ(node_.integer("steps"), 7) << "was never touched";
    EXPECT_EQ(node_.number("size"), 3.0);
    EXPECT_EQ(node_.schema().find("onlyA"), nullptr);
    EXPECT_EQ(node_.module("formula").name, "b");
}

TEST_F(NodeTest, new_module_drops_values_that_are_no_longer_valid) {
    node_.set("power", 16.0);
    node_.set("formula", otherModule());
    EXPECT_EQ(node_.number("power"), 3.0);
    node_.set("formula", ModuleReference{"c", "uniform vec2 power; //! (1, 2)"});
    EXPECT_EQ(node_.get<glm::dvec2>("power"), glm::dvec2(1, 2));
}

TEST_F(NodeTest, failed_set_changes_nothing) {
    node_.set("power", 9.0);
    const Node before = node_;
    EXPECT_EQ(messageOf([&] { node_.set("power", 99.0); }), "99 is outside [2, 16]");
    EXPECT_EQ(messageOf([&] { node_.setFromText("pwoer", "1"); }), "unknown parameter 'pwoer'; did you mean 'power'?");
    EXPECT_EQ(messageOf([&] {
                  node_.set("formula", ModuleReference{"bad", "uniform float f; //! x"});
              }),
              "bad:1: unknown word \"x\"; known: step, unit, log, color, invalidates");
    EXPECT_THAT(messageOf([&] {
                    node_.set("formula", ModuleReference{"bad", "\nuniform float size; //! 1"});
                }),
                HasSubstr("bad:2: the parameter 'size' is already declared in the engine"));
    EXPECT_THAT(messageOf([&] { node_.setFromText("formula", "reinhrad"); }), HasSubstr("did you mean 'reinhard'?"));
    EXPECT_THAT(messageOf([&] { node_.set("power", std::string("9")); }), HasSubstr("expected a number"));
    EXPECT_EQ(node_, before);
    EXPECT_EQ(node_.schema().names(), before.schema().names());
    EXPECT_EQ(node_.module("formula").name, "a");
}

TEST_F(NodeTest, copies_are_independent) {
    Node copy = node_;
    copy.set("power", 3.0);
    copy.set("formula", otherModule());
    EXPECT_EQ(node_.number("power"), 8.0);
    EXPECT_NE(copy, node_);
}

TEST_F(NodeTest, json_has_the_changed_values_and_the_users_source) {
    node_.set("formula", otherModule());
    node_.set("size", 2.0);
    EXPECT_EQ(node_.toJson().dump(),
              Json({{"type", "fake"}, {"size", 2.0}, {"formula", {{"name", "b"}, {"source", *otherModule().source}}}})
                  .dump());
    EXPECT_EQ(node_.toJson(true).size(), 6U);
}

TEST_F(NodeTest, users_file_is_stored_with_its_source) {
    const TemporaryFolder folder;
    writeFile(folder / "mine.glsl", "uniform float own; //! 1");
    EXPECT_EQ(node_.setFromText("formula", "./mine.glsl", folder.path()), Invalidates::Program);
    EXPECT_EQ(node_.setFromText("formula", "./mine.glsl", folder.path()), Invalidates::Nothing);
    const Json saved = node_.toJson()["formula"];
    EXPECT_EQ(saved["source"], "uniform float own; //! 1");

    Node other(type());
    other.setFromJson("formula", saved);
    EXPECT_EQ(other, node_);

    writeFile(folder / "mine.glsl", "uniform float own; //! 2");
    EXPECT_EQ(node_.setFromText("formula", "./mine.glsl", folder.path()), Invalidates::Program) << "the file changed";
}

TEST_F(NodeTest, embedded_modules_are_saved_by_name) {
    node_.setFromText("formula", "reinhard");
    EXPECT_EQ(node_.toJson()["formula"], "reinhard");
    EXPECT_TRUE(node_.module("formula").embedded);
}

TEST_F(NodeTest, missing_own_file_is_an_error) {
    const auto broken = std::make_shared<const NodeType>(NodeType{"subject", "x", "", {}, {"no/such.glsl"}});
    EXPECT_THAT(messageOf([&] { Node node(broken); }), HasSubstr("there is no embedded file \"no/such.glsl\""));
}

} // namespace
} // namespace apeiron::parameter
