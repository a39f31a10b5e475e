#include "scene_support.hpp"

namespace apeiron::scene {
namespace {

using parameter::Invalidates;
using test::catalogueWithFakes;
using test::messageOf;
using testing::HasSubstr;

class ScenePathTest : public testing::Test {
  protected:
    Invalidates set(std::string_view path, std::string_view text) { return scene_.set(path, text); }

    /// The error, after a check that it left the scene alone.
    std::string errorOf(std::string_view path, std::string_view text) {
        const Scene before = scene_;
        const std::string message = messageOf([&] { set(path, text); });
        EXPECT_EQ(scene_, before) << message;
        return message;
    }

    Scene scene_{catalogueWithFakes()};
};

TEST_F(ScenePathTest, every_part_can_be_reached) {
    EXPECT_EQ(set("title", "Hello there"), Invalidates::Nothing);
    EXPECT_EQ(scene_.title, "Hello there");
    EXPECT_EQ(set("camera.fov", "30"), Invalidates::Samples);
    EXPECT_EQ(set("camera.projection", "orthographic"), Invalidates::Samples);
    EXPECT_EQ(set("camera.position", "1e-40,2,3"), Invalidates::Samples);
    EXPECT_EQ(set("subject.power", "9"), Invalidates::Samples);
    EXPECT_EQ(set("lights.0.intensity", "5"), Invalidates::Samples);
    EXPECT_EQ(set("lights[0].color", "(1, 0, 0)"), Invalidates::Samples);
    EXPECT_EQ(scene_.lights[0].vec3("color"), glm::dvec3(1, 0, 0));
    EXPECT_EQ(set("environment.rotation", "90"), Invalidates::Samples);
    EXPECT_EQ(set("post.exposure", "1"), Invalidates::Present);
    EXPECT_EQ(set("post.exposure", "1"), Invalidates::Nothing);
    EXPECT_EQ(set("output.samples", "1000"), Invalidates::Nothing);
    EXPECT_EQ(set("output.width", "100"), Invalidates::Samples);
}

TEST_F(ScenePathTest, strings_are_text_and_not_json) {
    EXPECT_EQ(scene_.set("camera.fov", "30"), Invalidates::Samples);
    EXPECT_EQ(scene_.set("camera.fov", std::string("31")), Invalidates::Samples);
    EXPECT_EQ(scene_.set("camera.fov", 32), Invalidates::Samples);
    EXPECT_EQ(scene_.camera.number("fov"), 32);
}

TEST_F(ScenePathTest, json_values_are_taken_as_well) {
    EXPECT_EQ(scene_.set("camera.fov", Json(30)), Invalidates::Samples);
    EXPECT_EQ(scene_.set("title", Json("x")), Invalidates::Nothing);
    EXPECT_EQ(scene_.set("lights.0.color", Json::array({0, 1, 0})), Invalidates::Samples);
    EXPECT_EQ(scene_.set("lights.1.type", Json("point")), Invalidates::Samples);
    EXPECT_EQ(scene_.lights.at(1).type().name, "point");
}

TEST_F(ScenePathTest, type_exchanges_the_node) {
    EXPECT_EQ(set("subject.type", "other"), Invalidates::Program);
    EXPECT_EQ(scene_.subject.type().name, "other");
    EXPECT_EQ(set("subject.type", "other"), Invalidates::Nothing);
    EXPECT_EQ(set("lights.0.type", "point"), Invalidates::Samples);
    EXPECT_EQ(scene_.lights[0].type().name, "point");
}

TEST_F(ScenePathTest, next_index_with_type_appends) {
    EXPECT_EQ(set("lights.1.type", "point"), Invalidates::Samples);
    EXPECT_EQ(scene_.lights.size(), 2U);
    EXPECT_EQ(set("post.effects.0.type", "vignette"), Invalidates::Present);
    EXPECT_EQ(scene_.effects.size(), 1U);
    EXPECT_EQ(set("post.effects[0].enabled", "false"), Invalidates::Present);
    for (std::size_t i = 2; i < Scene::kMaxLights; ++i)
        set("lights." + std::to_string(i) + ".type", "sun");
    EXPECT_EQ(errorOf("lights.8.type", "sun"), "lights.8.type: at most 8 lights are possible");
}

TEST_F(ScenePathTest, slots_stand_among_the_subjects_parameters) {
    EXPECT_EQ(errorOf("subject.slots.0.bend", "1"), "subject.slots.0.bend: there is no slot 0; set its .formula first");
    const char* own = R"({"name": "own", "source": "uniform float twist; //! 1 [0, 2]"})";
    EXPECT_EQ(set("subject.slots.0.formula", own), Invalidates::Program);
    EXPECT_EQ(set("subject.slots.0.twist", "0.5"), Invalidates::Samples);
    EXPECT_EQ(set("subject.slots.1", "{}"), Invalidates::Program);
    EXPECT_EQ(set("subject.slots.1.bend", "2"), Invalidates::Samples);
    EXPECT_EQ(Scene::parse(catalogueWithFakes(), "saved", scene_.toJson().dump()), scene_);
    EXPECT_EQ(errorOf("subject.slots.1.bend", "3"), "subject.slots.1.bend: 3 is outside [0, 2]");
    EXPECT_THAT(errorOf("subject", R"({"slots": [{"bned": 1}]})"), HasSubstr("did you mean 'bend'?"));
    EXPECT_EQ(set("subject.slots.0", "null"), Invalidates::Program);
    ASSERT_EQ(scene_.slots.size(), 1U);
    EXPECT_EQ(scene_.slots[0].number("bend"), 2.0);
    EXPECT_EQ(set("subject", R"({"slots": [{}, {"bend": 0.5}]})"), Invalidates::Program);
    EXPECT_EQ(scene_.slots.size(), 2U);
    EXPECT_EQ(set("subject.power", "9"), Invalidates::Samples);
    EXPECT_EQ(scene_.slots.size(), 2U);
    EXPECT_EQ(set("subject.type", "other"), Invalidates::Program);
    EXPECT_TRUE(scene_.slots.empty()) << "they belonged to the other subject";
}

TEST_F(ScenePathTest, whole_parts_are_set_by_json) {
    EXPECT_EQ(set("camera", R"({"fov": 50})"), Invalidates::Samples);
    EXPECT_EQ(scene_.camera.number("fov"), 50);
    EXPECT_EQ(set("camera", "{}"), Invalidates::Samples);
    EXPECT_EQ(set("camera", "{}"), Invalidates::Nothing);
    EXPECT_EQ(set("lights", R"([{"type": "point"}, {}])"), Invalidates::Samples);
    EXPECT_EQ(scene_.lights.size(), 2U);
    EXPECT_EQ(set("lights.2", R"({"type": "sun", "size": 3})"), Invalidates::Samples);
    EXPECT_EQ(scene_.lights.at(2).number("size"), 3);
    EXPECT_EQ(set("lights.0", "null"), Invalidates::Samples);
    ASSERT_EQ(scene_.lights.size(), 2U);
    EXPECT_EQ(scene_.lights[1].number("size"), 3);
    EXPECT_EQ(set("post", R"({"effects": [{}]})"), Invalidates::Present);
    EXPECT_EQ(scene_.effects.size(), 1U);
    EXPECT_EQ(set("post.effects", "[]"), Invalidates::Present);
    EXPECT_TRUE(scene_.effects.empty());
    EXPECT_EQ(set("subject", R"({"type": "other"})"), Invalidates::Program);
}

TEST_F(ScenePathTest, errors_name_the_path_and_change_nothing) {
    EXPECT_EQ(errorOf("camera.fvo", "3"), "camera.fvo: unknown parameter 'fvo'; did you mean 'fov'?");
    EXPECT_EQ(errorOf("camra.fov", "3"), "camra.fov: unknown part 'camra'; did you mean 'camera'?");
    EXPECT_EQ(errorOf("camera.fov", "999"), "camera.fov: 999 is outside [1, 150]");
    EXPECT_EQ(errorOf("camera.fov.x", "3"), "camera.fov.x: 'fov' has no parts");
    EXPECT_EQ(errorOf("title.x", "3"), "title.x: the title has no parts");
    EXPECT_EQ(errorOf("subject.type", "fkae"), "subject.type: unknown subject type \"fkae\"; did you mean 'fake'?");
    EXPECT_EQ(errorOf("lights.x.size", "1"), "lights.x.size: expected a number of a light, got \"x\"");
    EXPECT_EQ(errorOf("lights.5.size", "1"), "lights.5.size: there is no light 5; 1 there, counted from 0");
    EXPECT_EQ(errorOf("lights.1.size", "1"), "lights.1.size: there is no light 1; set its .type first");
    EXPECT_THAT(errorOf("lights.99999999999999999999.size", "1"), HasSubstr("there is no light"));
    EXPECT_EQ(errorOf("lights.1.type", "sum"), "lights.1.type: unknown light type \"sum\"; did you mean 'sun'?");
    EXPECT_THAT(errorOf("lights", "[{}, {\"type\": 3}]"), HasSubstr("lights: /1/type: expected the name of a type"));
    EXPECT_THAT(errorOf("lights", "[{"), HasSubstr("lights: value:1:3: expected a key in double quotes"));
    EXPECT_THAT(errorOf("post", R"({"exposure": 2, "effects": [3]})"),
                HasSubstr("post: /effects/0: expected an object"));
    EXPECT_THAT(errorOf("post", "[]"), HasSubstr("expected an object"));
    for (const char* path : {"", ".", "camera.", ".fov", "lights[0]size", "camera..fov"})
        EXPECT_THAT(errorOf(path, "1"), HasSubstr("expected")) << path;
}

} // namespace
} // namespace apeiron::scene
