#include "core/file.hpp"
#include "scene_support.hpp"

namespace apeiron::scene {
namespace {

using parameter::ModuleReference;
using test::catalogueWithFakes;
using test::messageOf;
using testing::HasSubstr;
using testing::StartsWith;

Scene parse(const std::string& text, const std::filesystem::path& base = {}) {
    return Scene::parse(catalogueWithFakes(), "a.json", text, base);
}
std::string errorOf(const std::string& text) {
    return messageOf([&] { parse(text); });
}
Scene reread(const Scene& scene, bool all) {
    return parse(scene.toJson(all).dump(2));
}

Scene richScene() {
    return parse(R"({
        "apeiron": 1, "title": "Täst",
        "camera": {"mode": "free", "position": ["1e-50", "2", 3], "orientation": [0, 0, 0.5, 0.5], "fov": 12.5},
        "subject": {"power": 3, "type": "fake", "bend": 1.5, "formula": {"name": "m", "source": "uniform float bend; //! 0.5 [0, 2]"}},
        "lights": [{"type": "point", "intensity": 4}, {"azimuth": 10}],
        "environment": {"intensity": 0.5},
        "post": {"exposure": 1, "effects": [{"enabled": false}, {"type": "vignette"}]},
        "output": {"width": 64, "seed": 4294967295}})");
}

TEST(SceneTest, default_scene_has_one_sun_and_the_first_subject) {
    const Scene scene(catalogueWithFakes());
    EXPECT_EQ(scene.subject.type().name, "fake");
    ASSERT_EQ(scene.lights.size(), 1U);
    EXPECT_EQ(scene.lights[0].type().name, "sun");
    EXPECT_EQ(scene.output.integer("width"), 960);
    EXPECT_TRUE(scene.effects.empty());
}

TEST(SceneTest, no_subject_at_all_is_a_clear_error) {
    EXPECT_EQ(messageOf([] { Scene scene(std::make_shared<Catalogue>()); }), "there are no types of subject");
}

TEST(SceneTest, empty_document_is_the_default_scene) {
    EXPECT_EQ(parse("{}"), Scene(catalogueWithFakes()));
    EXPECT_EQ(parse(R"({"apeiron": 1, "camera": {}, "subject": {}, "post": {}})"), Scene(catalogueWithFakes()));
}

TEST(SceneTest, saved_scene_reads_back_equal) {
    const Scene rich = richScene();
    EXPECT_EQ(reread(rich, false), rich);
    EXPECT_EQ(reread(rich, true), rich);
    const Scene plain(catalogueWithFakes());
    EXPECT_EQ(reread(plain, false), plain);
    EXPECT_EQ(reread(plain, true), plain);
    EXPECT_EQ(reread(rich, false).toJson(), rich.toJson());
}

TEST(SceneTest, empty_list_of_lights_stays_empty) {
    const Scene dark = parse(R"({"lights": []})");
    EXPECT_TRUE(dark.lights.empty());
    EXPECT_EQ(reread(dark, false), dark);
}

TEST(SceneTest, every_difference_is_seen) {
    const Scene scene = richScene();
    for (const auto& [path, value] : {std::pair("title", "x"),
                                      {"camera.fov", "13"},
                                      {"subject.bend", "0"},
                                      {"lights.1.azimuth", "11"},
                                      {"environment.rotation", "1"},
                                      {"post.exposure", "2"},
                                      {"post.effects.0.enabled", "true"},
                                      {"output.seed", "1"}}) {
        Scene changed = scene;
        changed.set(path, std::string_view(value));
        EXPECT_NE(changed, scene) << path;
    }
}

TEST(SceneTest, module_and_type_come_first_whatever_the_order) {
    const Scene scene = richScene();
    EXPECT_EQ(scene.subject.number("bend"), 1.5);
    EXPECT_EQ(scene.lights[0].type().name, "point");
    EXPECT_EQ(scene.lights[0].number("intensity"), 4);
    EXPECT_EQ(scene.lights[1].type().name, "sun");
}

TEST(SceneTest, positions_keep_their_digits) {
    EXPECT_EQ(reread(richScene(), false).camera.get<parameter::Decimal3>("position")[0].toString(),
              "0." + std::string(49, '0') + "1");
}

TEST(SceneTest, saved_document_names_its_version_first) {
    EXPECT_THAT(Scene(catalogueWithFakes()).toJson().dump(), StartsWith(R"({"apeiron":1,)"));
}

TEST(SceneTest, errors_name_file_line_and_pointer) {
    EXPECT_EQ(errorOf("{\n\"camera\": {\n\"fov\": 999}}"), "a.json:3 (/camera/fov): 999 is outside [1, 150]");
    EXPECT_EQ(errorOf("{\n\"camera\": {\n\"fvo\": 9}}"),
              "a.json:3 (/camera/fvo): unknown parameter 'fvo'; did you mean 'fov'?");
    EXPECT_EQ(errorOf("{\n\"camra\": {}}"), "a.json:2 (/camra): unknown key 'camra'; did you mean 'camera'?");
    EXPECT_EQ(errorOf("{\"post\": {\"efects\": []}}"),
              "a.json:1 (/post/efects): unknown parameter 'efects'; did you mean 'effects'?");
    EXPECT_EQ(errorOf("{\"lights\": [\n{},\n{\"type\": \"sum\"}]}"),
              "a.json:3 (/lights/1/type): unknown light type \"sum\"; did you mean 'sun'?");
    EXPECT_EQ(errorOf("{\"lights\": {}}"), "a.json:1 (/lights): expected a list [...], got object");
    EXPECT_EQ(errorOf("{\"lights\": [3]}"), "a.json:1 (/lights/0): expected an object {...}, got number");
    EXPECT_EQ(errorOf("[]"), "a.json:1: expected an object {...}, got array");
    EXPECT_EQ(errorOf("{\"title\": 3}"), "a.json:1 (/title): expected a text, got 3");
    EXPECT_EQ(errorOf("{\"subject\": {\"type\": \"fak\"}}"),
              "a.json:1 (/subject/type): unknown subject type \"fak\"; did you mean 'fake'?");
    EXPECT_THAT(
        errorOf("{\"subject\": {\n\"formula\": {\"name\": \"m\", \"source\": \"uniform float f; //! 1 [2, 3]\"}}}"),
        HasSubstr("a.json:2 (/subject/formula): m:1: default value: 1 is outside [2, 3]"));
    EXPECT_EQ(errorOf("{\"renderer\": {\"type\": \"raymrach\"}}"),
              "a.json:1 (/renderer/type): unknown module \"raymrach\" of renderers; did you mean 'raymarch'?");
    EXPECT_EQ(errorOf("{\"camera\": {\"orientation\": [0, 0, 0, 0]}}"),
              "a.json:1 (/camera/orientation): expected a vector that is not zero");
}

TEST(SceneTest, newer_version_is_refused_before_anything_else) {
    EXPECT_THAT(errorOf(R"({"apeiron": 2, "new": 1})"),
                HasSubstr("a.json:1 (/apeiron): made by a newer version of Apeiron"));
    EXPECT_THAT(errorOf(R"({"apeiron": "1"})"), HasSubstr("expected the version of the document"));
    EXPECT_THAT(errorOf(R"({"apeiron": 0})"), HasSubstr("expected the version of the document"));
}

TEST(SceneTest, too_many_lights_are_an_error) {
    EXPECT_NO_THROW(parse(R"({"lights": [{},{},{},{},{},{},{},{}]})"));
    EXPECT_EQ(errorOf(R"({"lights": [{},{},{},{},{},{},{},{},{}]})"),
              "a.json:1 (/lights): at most 8 lights are possible");
}

TEST(SceneTest, modules_are_found_beside_the_document) {
    const test::TemporaryFolder folder;
    writeFile(folder / "mine.glsl", "uniform float wave; //! 1 [0, 9]");
    const Scene scene = parse(R"({"subject": {"wave": 4, "formula": "./mine.glsl"}})", folder.path());
    EXPECT_EQ(scene.subject.number("wave"), 4);
    EXPECT_EQ(reread(scene, false), scene) << "without the folder: the source travels with the document";
}

TEST(CatalogueTest, describes_every_role_and_module) {
    const Json json = catalogueWithFakes()->toJson();
    EXPECT_EQ(json["version"], 1);
    for (const char* role : {"camera", "subject", "renderer", "light", "environment", "post", "effect", "output"})
        EXPECT_TRUE(json["roles"].contains(role)) << role;
    EXPECT_TRUE(json["roles"]["light"]["list"]);
    EXPECT_FALSE(json["roles"]["camera"]["list"]);
    EXPECT_EQ(json["roles"]["light"]["types"]["sun"]["parameters"][0]["name"], "azimuth");
    EXPECT_EQ(json["roles"]["camera"]["types"][""]["parameters"][0]["choices"].dump(), R"(["orbit","free"])");
    EXPECT_TRUE(json["modules"]["tonemappers"].contains("reinhard"));
    EXPECT_TRUE(json["modules"]["tonemappers"]["reinhard"].contains("parameters"));
}

TEST(CatalogueTest, changing_the_tone_mapper_keeps_samples_and_the_renderer_does_not) {
    const Scene scene(catalogueWithFakes());
    using parameter::Invalidates;
    EXPECT_EQ(scene.post.schema().at("tonemapper").invalidates, Invalidates::Present);
    EXPECT_EQ(scene.renderer.schema().at("type").invalidates, Invalidates::Program);
    EXPECT_EQ(scene.environment.schema().at("type").invalidates, Invalidates::Program);
    EXPECT_EQ(scene.subject.schema().at("formula").invalidates, Invalidates::Program) << "by default";
}

} // namespace
} // namespace apeiron::scene
