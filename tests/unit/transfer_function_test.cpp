#include "scene_support.hpp"
#include "volume/transfer_function.hpp"

namespace apeiron::volume {
namespace {

using test::messageOf;
using testing::HasSubstr;

std::vector<TransferFunction> read(const char* text) {
    return transferFunctions(Json::parse(text), Json("grey"));
}
std::string errorOf(const char* text) {
    return messageOf([&] { checkTransfer(Json::parse(text)); });
}

TEST(TransferFunctionTest, points_are_joined_by_straight_lines_in_linear_light) {
    const TransferFunction f = read(R"({"window": "none", "space": "linear", "points": [
        {"value": 10, "color": [0, 0, 1], "opacity": 0}, {"value": 20, "color": [1, 0, 0], "opacity": 0.8}]})")[0];
    const TransferPoint middle = evaluate(f, 12.5, 0.0);
    EXPECT_DOUBLE_EQ(middle.opacity, 0.2);
    EXPECT_DOUBLE_EQ(middle.color.x, 0.25);
    EXPECT_DOUBLE_EQ(middle.color.z, 0.75);
    EXPECT_EQ(evaluate(f, -1e9, 0.0).opacity, 0.0);
    EXPECT_EQ(evaluate(f, 1e9, 0.0).opacity, 0.8);
}

TEST(TransferFunctionTest, two_points_of_one_value_are_a_step) {
    const TransferFunction f = read(R"({"window": "none", "points": [{"value": 1, "opacity": 0},
        {"value": 1, "opacity": 1}]})")[0];
    EXPECT_EQ(evaluate(f, 0.999, 0.0).opacity, 0.0);
    EXPECT_EQ(evaluate(f, 1.0, 0.0).opacity, 1.0);
}

TEST(TransferFunctionTest, colors_are_srgb_where_it_is_not_said) {
    const auto colorOf = [](const char* text) { return read(text)[0].points[0].color; };
    EXPECT_NEAR(colorOf(R"({"points": [{"value": 0, "color": "#808080"}]})").x, 0.215861, 1e-6); // IEC 61966-2-1
    EXPECT_NEAR(colorOf(R"({"points": [{"value": 0, "color": [0.5, 0.5, 0.5]}]})").y, 0.214041, 1e-6);
    EXPECT_EQ(colorOf(R"({"space": "linear", "points": [{"value": 0, "color": [0.5, 0.5, 0.5]}]})").z, 0.5);
}

TEST(TransferFunctionTest, windows_stretch_what_is_inside) {
    const DataRange data{-100, 300, 0, 200, 40};
    TransferFunction f = read(R"({"window": {"level": 40, "width": 80}, "points": [{"value": 0}, {"value": 1}],
        "shapes": [{"type": "box", "center": [0.5, 0.5], "size": [0.5, 1]}]})")[0];
    f = inValueUnits(f, data);
    EXPECT_EQ(f.points[0].value, 0.0);
    EXPECT_EQ(f.points[1].value, 80.0);
    EXPECT_EQ(f.shapes[0].center, glm::dvec2(40, 20));
    EXPECT_EQ(f.shapes[0].size, glm::dvec2(40, 40));
    const TransferFunction byData = inValueUnits(read(R"({"points": [{"value": 0}, {"value": 1}]})")[0], data);
    EXPECT_EQ(byData.points[1].value, 200.0);
}

TEST(TransferFunctionTest, shapes_are_what_their_names_say) {
    const auto opacity = [](const char* type, double value, double gradient) {
        const std::string text = std::string(R"({"window": "none", "shapes": [{"type": ")") + type +
                                 R"(", "center": [10, 2], "size": [4, 2], "opacity": 0.5}]})";
        return evaluate(read(text.c_str())[0], value, gradient).opacity;
    };
    EXPECT_EQ(opacity("box", 11.9, 2.9), 0.5);
    EXPECT_EQ(opacity("box", 12.1, 2), 0.0);
    EXPECT_EQ(opacity("box", 10, 3.1), 0.0);
    EXPECT_DOUBLE_EQ(opacity("gaussian", 12, 3), 0.5 * std::exp(-1.0)); // one standard deviation each way
    EXPECT_EQ(opacity("triangle", 10, 0.9), 0.0) << "below the apex";
    EXPECT_DOUBLE_EQ(opacity("triangle", 10, 1.5), 0.5) << "the middle line";
    EXPECT_DOUBLE_EQ(opacity("triangle", 10.25, 1.5), 0.25) << "half way to the side, which is 0.5 there";
    EXPECT_DOUBLE_EQ(opacity("triangle", 11, 3), 0.25) << "the upper edge is as wide as the shape";
}

TEST(TransferFunctionTest, overlapping_shapes_add_and_mix_by_opacity) {
    const TransferFunction f = read(R"({"window": "none", "space": "linear", "shapes": [
        {"type": "box", "center": [0, 0], "size": [2, 2], "color": [1, 0, 0], "opacity": 0.3},
        {"type": "box", "center": [0, 0], "size": [2, 2], "color": [0, 1, 0], "opacity": 0.1}]})")[0];
    const TransferPoint sum = evaluate(f, 0.0, 0.0);
    EXPECT_DOUBLE_EQ(sum.opacity, 0.4);
    EXPECT_DOUBLE_EQ(sum.color.x, 0.75);
    EXPECT_DOUBLE_EQ(sum.color.y, 0.25);
}

TEST(TransferFunctionTest, tables_hold_the_function_with_exact_ends) {
    const DataRange data{-1024, 3071, 0, 2000, 500};
    const TransferFunction f = read(R"({"window": "none", "points": [{"value": 100, "opacity": 0},
        {"value": 300, "opacity": 0.5}, {"value": 1123, "opacity": 1}]})")[0];
    const TransferTable table = transferTable(f, data, false);
    ASSERT_EQ(table.width, kTransferValues);
    ASSERT_EQ(table.height, 1);
    EXPECT_EQ(table.low, 100.0) << "no texels for where nothing changes";
    EXPECT_EQ(table.high, 1123.0);
    EXPECT_EQ(table.rgba[3], 0.0F);
    EXPECT_EQ(table.rgba[4 * 200 + 3], 0.5F); // one texel for each unit: 100 + 200
    EXPECT_EQ(table.rgba[4 * 1023 + 3], 1.0F);
    EXPECT_TRUE(table.emission.empty());
}

TEST(TransferFunctionTest, tables_of_shapes_have_rows_for_gradients) {
    const DataRange data{0, 255, 0, 255, 51};
    const TransferFunction f = read(R"({"window": "none", "shapes": [
        {"type": "box", "center": [100, 30], "size": [20, 10], "emission": 2}]})")[0];
    const TransferTable table = transferTable(f, data, true);
    ASSERT_EQ(table.width, kTransferSquare);
    ASSERT_EQ(table.height, kTransferSquare);
    const auto opacity = [&](int value, int gradient) { return table.rgba[4 * (256 * (5 * gradient) + value) + 3]; };
    EXPECT_EQ(opacity(100, 30), 1.0F);
    EXPECT_EQ(opacity(100, 24), 0.0F);
    EXPECT_EQ(opacity(111, 30), 0.0F);
    ASSERT_FALSE(table.emission.empty());
    EXPECT_EQ(table.emission[3 * (256 * 150 + 100)], 2.0F);
}

TEST(TransferFunctionTest, channels_without_a_function_of_their_own_have_the_last) {
    const std::vector<DataRange> ranges(3);
    const auto functions = read(R"(["grey", {"points": [{"value": 0, "opacity": 0.5}]}])");
    const std::vector<TransferTable> tables = transferTables(functions, ranges);
    ASSERT_EQ(tables.size(), 3U);
    EXPECT_EQ(tables[0].rgba[3], 0.0F);
    EXPECT_EQ(tables[1].rgba[3], 0.5F);
    EXPECT_EQ(tables[2].rgba, tables[1].rgba);
}

TEST(TransferFunctionTest, keys_replace_parts_of_a_preset) {
    const TransferFunction preset = read("\"ct_bone\"")[0];
    const TransferFunction f = read(R"({"preset": "ct_bone", "window": {"level": 0.5, "width": 1}})")[0];
    EXPECT_EQ(f.points.size(), preset.points.size());
    EXPECT_EQ(f.window, TransferFunction::Window::Given);
    EXPECT_EQ(preset.window, TransferFunction::Window::None);
    EXPECT_EQ(read("\"auto\"")[0].points.size(), read("\"grey\"")[0].points.size()) << "what auto was said to be";
}

TEST(TransferFunctionTest, every_preset_is_valid_and_shows_something) {
    ASSERT_GE(transferPresets().size(), 8U);
    for (const TransferPreset& preset : transferPresets()) {
        EXPECT_FALSE(preset.doc.empty()) << preset.name;
        for (const TransferFunction& f : transferFunctions(preset.transfer, Json("grey"))) {
            const TransferTable table = transferTable(f, {-1024, 3071, 0, 2000, 500}, f.twoDimensional());
            float most = 0.0F;
            for (std::size_t i = 3; i < table.rgba.size(); i += 4)
                most = std::max(most, table.rgba[i]);
            EXPECT_GE(most, 0.4F) << preset.name;
        }
    }
}

TEST(TransferFunctionTest, errors_say_where_and_what) {
    EXPECT_EQ(errorOf("\"ct_bon\""), "unknown preset \"ct_bon\"; did you mean 'ct_bone'?");
    EXPECT_EQ(errorOf(R"({"points": [{"value": 0}, {"value": 1, "opacity": 1.5}]})"),
              "points: 1: opacity: 1.5 is outside [0, 1]");
    EXPECT_EQ(errorOf(R"({"points": [{"value": 1}, {"value": 0}]})"), "points: 1: values must ascend");
    EXPECT_THAT(errorOf(R"({"points": [{"opacity": 1}]})"), HasSubstr("points: 0: a point needs a \"value\""));
    EXPECT_THAT(errorOf(R"({"ponts": []})"), HasSubstr("did you mean 'points'?"));
    EXPECT_THAT(errorOf("{}"), HasSubstr("needs \"points\" or \"shapes\""));
    EXPECT_THAT(errorOf("3"), HasSubstr("expected a preset's name"));
    EXPECT_THAT(errorOf("[]"), HasSubstr("empty list"));
    EXPECT_THAT(errorOf(R"([["grey"]])"), HasSubstr("0: a list inside a list"));
    EXPECT_THAT(errorOf(R"({"points": [{"value": 0, "color": "red"}]})"), HasSubstr("points: 0: color: expected"));
    EXPECT_THAT(errorOf(R"({"window": {"level": 1}, "points": [{"value": 0}]})"), HasSubstr("window: a window needs"));
    EXPECT_THAT(errorOf(R"({"window": {"level": 1, "width": 0}, "points": [{"value": 0}]})"),
                HasSubstr("window: width: 0 is outside"));
    EXPECT_THAT(errorOf(R"({"shapes": [{"type": "disc", "center": [0, 0], "size": [1, 1]}]})"),
                HasSubstr("shapes: 0: type: unknown value \"disc\""));
    const std::string many = R"({"points": [)" + [] {
        std::string text;
        for (int i = 0; i < 257; ++i)
            text += (i == 0 ? "" : ",") + std::string(R"({"value": 0})");
        return text;
    }() + "]}";
    EXPECT_THAT(errorOf(many.c_str()), HasSubstr("at most 256"));
}

class TransferParameterTest : public testing::Test {
  protected:
    TransferParameterTest() : catalogue_(std::make_shared<scene::Catalogue>()) {
        catalogue_->add({"subject", "ball", "A fake", {transferParameter()}, {}});
    }
    static Json transferOf(const scene::Scene& scene) {
        return scene.subject.get<parameter::Structure>("transfer").json;
    }
    std::shared_ptr<scene::Catalogue> catalogue_;
};

TEST_F(TransferParameterTest, documents_keep_it_as_it_was_written) {
    const std::string text = R"({"apeiron": 1, "subject": {"type": "ball", "transfer":
        {"preset": "grey", "window": {"level": 3.0, "width": 2.0}}}})";
    const scene::Scene scene = scene::Scene::parse(catalogue_, "a.json", text);
    const scene::Scene again = scene::Scene::parse(catalogue_, "b.json", scene.toJson().dump());
    EXPECT_EQ(again, scene);
    EXPECT_EQ(transferOf(again)["window"]["level"], 3.0);
}

TEST_F(TransferParameterTest, errors_in_documents_show_line_and_place) {
    const std::string text = "{\"apeiron\": 1, \"subject\": {\"type\": \"ball\",\n \"transfer\": {\"points\": [{}]}}}";
    EXPECT_EQ(messageOf([&] { scene::Scene::parse(catalogue_, "a.json", text); }),
              "a.json:2 (/subject/transfer): points: 0: a point needs a \"value\"");
}

TEST_F(TransferParameterTest, paths_reach_into_it) {
    scene::Scene scene(catalogue_);
    EXPECT_EQ(scene.set("subject.transfer", "ct_bone"), parameter::Invalidates::Samples);
    EXPECT_EQ(transferOf(scene), Json("ct_bone"));
    scene.set("subject.transfer.window", R"({"level": 40, "width": 400})");
    EXPECT_EQ(transferOf(scene), Json::parse(R"({"preset": "ct_bone", "window": {"level": 40, "width": 400}})"));
    scene.set("subject.transfer.window.width", "80");
    EXPECT_EQ(transferOf(scene)["window"]["width"], 80);
    scene.set("subject.transfer.points", R"([{"value": 0}, {"value": 1}])");
    scene.set("subject.transfer.points.1.opacity", "0.5");
    scene.set("subject.transfer.points.2", R"({"value": 2, "opacity": 1})");
    EXPECT_EQ(transferOf(scene)["points"].size(), 3U);
    scene.set("subject.transfer.window", "null");
    EXPECT_FALSE(transferOf(scene).contains("window"));
    const Json before = transferOf(scene);
    EXPECT_EQ(messageOf([&] { scene.set("subject.transfer.points.1.opacity", "2"); }),
              "subject.transfer.points.1.opacity: points: 1: opacity: 2 is outside [0, 1]");
    EXPECT_THAT(messageOf([&] { scene.set("subject.transfer.points.7.opacity", "1"); }), HasSubstr("no element 7"));
    EXPECT_EQ(transferOf(scene), before) << "nothing changes when it throws";
}

} // namespace
} // namespace apeiron::volume
