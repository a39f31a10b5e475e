#include "session/volume_scene.hpp"

#include "session/session.hpp"

namespace apeiron::session {

scene::Scene volumeScene(const std::string& source, const std::string& title) {
    scene::Scene scene(catalogue());
    scene.title = title;
    scene.set("subject", Json{{"type", "volume"}, {"source", source}});
    // Occlusion and shadows show forms at once and are cheap.
    scene.set("renderer", Json{{"type", "lao"}});
    scene.set("output.samples", Json(32));
    // A key light from the upper left, a cool one from behind on the right, and dark behind it all.
    scene.set(
        "lights",
        Json::array(
            {{{"type", "sun"}, {"azimuth", -130}, {"elevation", 42}, {"intensity", 8}},
             {{"type", "sun"}, {"azimuth", 40}, {"elevation", 20}, {"intensity", 3.5}, {"color", {0.6, 0.75, 1.0}}}}));
    scene.set("environment", Json{{"type", "gradient"},
                                  {"top", {0.5, 0.55, 0.65}},
                                  {"horizon", {0.03, 0.035, 0.045}},
                                  {"bottom", {0.05, 0.045, 0.04}},
                                  {"sharpness", 0.6}});
    return scene;
}

} // namespace apeiron::session
