// The engine as JavaScript sees it: session::Session behind embind. One Engine uses the WebGL 2 context that is current
// when it is made. Every apeiron::Error reaches JavaScript as an Error with its message. src/engine.ts has the same
// interface in TypeScript.
#include "core/error.hpp"
#include "core/resources.hpp"
#include "session/session.hpp"
#include "session/volume_scene.hpp"
#include "volume/source.hpp"
#include "volume_data.hpp"

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <algorithm>
#include <cmath>
#include <exception>

namespace apeiron::web {
namespace {

using emscripten::val;
using parameter::Decimal3;

/// The first picture appears in 8 x 8 sub-images: something is seen after a 64th of a sample.
constexpr int kInterleave = 8;

/// How far look() goes up and down [rad].
constexpr double kSteepest = 1.55;

/// Runs `work`; what it throws becomes a JavaScript Error.
template <class Work> auto guarded(const Work& work) -> decltype(work()) {
    std::string message;
    try {
        return work();
    } catch (const std::exception& exception) {
        message = exception.what();
    } catch (...) {
        message = "unknown failure in the engine";
    }
    // Outside the handler: JavaScript's exceptions must not unwind through it.
    val::global("Error").new_(message).throw_();
}

val toJs(const glm::dvec3& v) {
    val array = val::array();
    for (int i = 0; i < 3; ++i)
        array.set(i, v[i]);
    return array;
}

/// The point moved by an offset, rounded far below the offset's size so that repeated moves do not lengthen decimals.
Decimal3 moved(const Decimal3& point, const glm::dvec3& offset) {
    const double size = std::max({std::abs(offset.x), std::abs(offset.y), std::abs(offset.z)});
    if (size == 0.0 || !std::isfinite(size)) return point;
    const int places = 20 - static_cast<int>(std::floor(std::log10(size)));
    Decimal3 result;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        result[axis] = point[axis] + Decimal(offset[i]).rounded(places);
    }
    return result;
}

class Engine {
  public:
    Engine() = default;

    /// Takes over the current WebGL context. Nothing else can be done before the first scene or volume: another one
    /// before it would compile its kernels in vain.
    void start() {
        guarded([&] {
            context_ = gpu::Context::adopt();
            // Where a processor does the work, kernels with constants are about five times as fast and compile at once.
            // Drivers of GPUs may take seconds to compile: there, no edit of a value must.
            specialise_ = context_->capabilities().software;
        });
    }

    void loadScene(const std::string& text, const std::string& name, int width, int height) {
        guarded([&] {
            scene::Scene scene = scene::Scene::parse(session::catalogue(), name, text);
            setSize(scene, width, height);
            open(std::move(scene));
        });
    }

    /// Shows a volume that JavaScript read, as a scene of its own, which knows it by `name`. The last one is given up.
    /// @param voxels, form see volumeOf()
    void openVolume(const std::string& name, const val& voxels, const std::string& form, int width, int height) {
        guarded([&] {
            auto volume = std::make_shared<const volume::Volume>(volumeOf(name, voxels, form));
            const std::shared_ptr<const volume::Volume> before = provided_;
            volume::provideVolume(name, volume);
            try {
                scene::Scene scene = session::volumeScene(name, name);
                setSize(scene, width, height);
                open(std::move(scene));
            } catch (...) {
                volume::provideVolume(name, name == providedName_ ? before : nullptr);
                throw;
            }
            if (!providedName_.empty() && name != providedName_) volume::provideVolume(providedName_, nullptr);
            providedName_ = name;
            provided_ = std::move(volume);
        });
    }

    /// What an editor of transfer functions begins with (volume::toJson(Shown)); "null" where no volume is shown.
    std::string volumeJson() const {
        return guarded([&] {
            const std::optional<volume::Shown> shown = session().volume();
            return shown ? volume::toJson(*shown).dump() : std::string("null");
        });
    }

    /// See session::Session::histogram(); "null" where no volume is shown.
    std::string histogramJson(int channel, int values, int gradients) const {
        return guarded([&] {
            const std::optional<volume::Histogram> histogram = session().histogram(channel, values, gradients);
            return histogram ? volume::toJson(*histogram).dump() : std::string("null");
        });
    }

    /// What the volume holds where a pixel shows it (volume::toJson(Reading)); "null" where it shows none.
    std::string valueJson(int x, int y) {
        return guarded([&] {
            const std::optional<volume::Reading> reading = session().valueAt({x, y});
            return reading ? volume::toJson(*reading).dump() : std::string("null");
        });
    }

    void resize(int width, int height) {
        guarded([&] {
            scene::Scene scene = session().scene();
            setSize(scene, width, height);
            session().setScene(std::move(scene));
        });
    }

    /// @param all with the parameters that are at their defaults
    std::string sceneJson(bool all) const {
        return guarded([&] { return session().scene().toJson(all).dump(2); });
    }

    /// The modules whose source travels inside the document, as "modules" of schemaJson().
    std::string ownModulesJson() const {
        return guarded([&] {
            const scene::Scene& scene = session().scene();
            Json modules = Json::object();
            const auto add = [&](const parameter::Node& node) {
                for (const parameter::Parameter& parameter : node.schema()) {
                    if (parameter.type != parameter::Type::Module) continue;
                    const auto& reference = node.get<parameter::ModuleReference>(parameter.name);
                    if (!reference.source) continue;
                    const parameter::GlslModule& module = node.module(parameter.name);
                    Json parameters = Json::array();
                    for (const parameter::Parameter& own : module.parameters)
                        parameters.push_back(parameter::toJson(own));
                    modules[parameter.folder][reference.name] = {
                        {"doc", module.doc}, {"tags", Json(module.tags)}, {"parameters", parameters}};
                }
            };
            for (const parameter::Node* node : {&scene.subject, &scene.renderer, &scene.environment, &scene.post})
                add(*node);
            for (const parameter::Node& node : scene.lights)
                add(node);
            for (const parameter::Node& node : scene.effects)
                add(node);
            for (const parameter::Node& node : scene.slots)
                add(node);
            return modules.dump();
        });
    }

    /// Sets one value by path, given as JSON. Returns what that makes stale.
    /// @param live more such edits follow, as from a slider: they must not compile anything each
    std::string set(const std::string& path, const std::string& jsonText, bool live) {
        return guarded([&] {
            const Json value = Json::parse(jsonText);
            if (live && session().specialised()) {
                scene::Scene edited = session().scene();
                if (edited.set(path, value) == parameter::Invalidates::Samples) session().setSpecialise(false);
            }
            return std::string(parameter::toString(session().set(path, value)));
        });
    }

    /// Whether tune() would make it faster: live edits have made it slower.
    bool tunable() const { return specialise_ && !session().specialised(); }
    /// Compiles kernels with the present values as constants; samples start anew.
    void tune() {
        guarded([&] { session().setSpecialise(specialise_); });
    }

    void reset() {
        guarded([&] { session().reset(); });
    }

    /// @param budgetMs [ms]
    val step(double budgetMs) {
        return guarded([&] {
            const session::StepResult result = session().step(1e-3 * budgetMs);
            val object = val::object();
            object.set("samples", static_cast<double>(result.samples));
            object.set("changed", result.changed);
            object.set("finished", result.finished);
            return object;
        });
    }

    /// Waits until it is done: the time would otherwise be taken for the next estimate's.
    void show() {
        guarded([&] {
            session().show();
            context().finish();
        });
    }

    double samples() const { return static_cast<double>(session().samples()); }
    double progress() const { return session().progress(); }

    void orbit(double yaw, double pitch) {
        move([&](scene::Camera& camera) { camera.orbit(yaw, pitch); });
    }
    void zoom(double factor) {
        move([&](scene::Camera& camera) { camera.zoom(factor); });
    }
    void pan(double right, double up) {
        move([&](scene::Camera& camera) { camera.pan(right, up); });
    }
    void fly(double right, double up, double back) {
        move([&](scene::Camera& camera) { camera.fly({right, up, back}); });
    }
    /// Turns the view in place, around the scene's upward axis and up or down: the horizon stays as it is.
    void look(double yaw, double pitch) {
        move([&](scene::Camera& camera) {
            const glm::dquat view = camera.orientation();
            const glm::dvec3 up = glm::normalize(camera.node().vec3("up"));
            // Not beyond the poles, where left and right would change places.
            const double elevation = std::asin(std::clamp(glm::dot(camera.forward(), up), -1.0, 1.0));
            const double raised =
                std::clamp(elevation + pitch, std::min(-kSteepest, elevation), std::max(kSteepest, elevation));
            const glm::dquat turned =
                glm::angleAxis(yaw, up) * view * glm::angleAxis(raised - elevation, glm::dvec3(1, 0, 0));
            // The same turn in camera space, as Camera takes it: around y, then x, then z.
            const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::conjugate(view) * turned));
            camera.look(std::atan2(turn[2].x, turn[2].z), std::asin(std::clamp(-turn[2].y, -1.0, 1.0)),
                        std::atan2(turn[0].y, turn[1].y));
        });
    }

    /// Scales the view around a point: what is there stays under the cursor.
    /// @param x, y, z the point, from the camera [world units]
    void zoomAround(double x, double y, double z, double factor) {
        guarded([&] {
            const glm::dvec3 offset = (1.0 - factor) * glm::dvec3(x, y, z);
            scene::Camera camera = session().camera();
            const glm::dvec3 ahead = camera.distance() * camera.forward();
            parameter::Node node = camera.node();
            const Decimal3 place = moved(camera.position(), offset);
            // A target that is not ahead (free mode) is put there, as Camera does.
            const Decimal3 target = moved(place, factor * ahead);
            node.set("position", place);
            node.set("target", target);
            session().moveCamera(scene::Camera(std::move(node)));
        });
    }

    /// Turns towards a point, which becomes the target.
    /// @param x, y, z the point, from the camera [world units]
    void aim(double x, double y, double z) {
        guarded([&] {
            scene::Camera camera = session().camera();
            camera.orbit(0.0, 0.0); // leaves free mode
            parameter::Node node = camera.node();
            node.set("target", moved(camera.position(), {x, y, z}));
            session().setCamera(scene::Camera(std::move(node)));
        });
    }

    /// From the camera to its target [world units].
    val toTarget() const {
        return guarded([&] {
            const scene::Camera camera = session().camera();
            return toJs(camera.distance() * camera.forward());
        });
    }

    /// From the camera to what is seen at a pixel [world units]; null where that is background.
    val pointAt(int x, int y) {
        return guarded([&] {
            const std::optional<glm::dvec3> point = session().pointAt({x, y});
            return point ? toJs(*point) : val::null();
        });
    }

    /// See session::Session::focusAt().
    bool focusAt(int x, int y) {
        return guarded([&] { return session().focusAt({x, y}); });
    }

    /// See session::Session::notes().
    std::string notesJson() const {
        return guarded([&] { return Json(session().notes()).dump(); });
    }
    /// See session::Session::emptyReason().
    std::string emptyReason() {
        return guarded([&] { return session().emptyReason(); });
    }

    /// Infinite where the subject cannot tell [world units].
    double distanceToSurface() {
        return guarded([&] { return session().distanceToSurface(); });
    }
    /// See session::Session::autopilot(). @param speed [distances to the surface per second] @param seconds [s]
    bool autopilot(bool dive, double speed, double seconds) {
        return guarded([&] {
            return session().autopilot(dive ? render::Autopilot::Dive : render::Autopilot::Rise, speed, seconds);
        });
    }
    /// See session::Session::scalePower(); null where there is none.
    val scalePower() const {
        return guarded([&] {
            const std::optional<double> power = session().scalePower();
            return power ? val(*power) : val::null();
        });
    }
    /// From the camera to its target [world units].
    double distanceToTarget() const {
        return guarded([&] { return session().camera().distance(); });
    }

    /// The picture as a Uint8ClampedArray of its own: sRGB, straight alpha, rows from the top.
    val pixels() {
        return guarded([&] {
            const Image<float> picture = session().picture(1.0 / 255.0);
            std::vector<std::uint8_t> bytes(picture.data().size());
            std::transform(picture.data().begin(), picture.data().end(), bytes.begin(), [](float value) {
                return static_cast<std::uint8_t>(std::clamp(std::lround(255.0F * value), 0L, 255L));
            });
            return val::global("Uint8ClampedArray")
                .new_(val(emscripten::typed_memory_view(bytes.size(), bytes.data())));
        });
    }

    std::string statisticsJson() const {
        return guarded([&] {
            const session::Statistics& statistics = session().statistics();
            Json phases = Json::object();
            for (const auto& [name, times] : statistics.phases.times)
                phases[name] = times.wallMs;
            return Json{{"phases", phases},
                        {"pixels", statistics.pixels},
                        {"submissions", statistics.submissions},
                        {"longestSubmission", statistics.longestSubmission}}
                .dump();
        });
    }

    std::string device() const { return context().capabilities().renderer; }
    bool software() const { return context().capabilities().software; }
    int maxSize() const { return context().capabilities().maxTextureSize / 8 * 8; }
    int width() const { return session().size().x; }
    int height() const { return session().size().y; }

  private:
    /// Sizes of 0 leave the scene's own.
    static void setSize(scene::Scene& scene, int width, int height) {
        if (width <= 0 || height <= 0) return;
        scene.output.set("width", std::int64_t{width});
        scene.output.set("height", std::int64_t{height});
    }

    void open(scene::Scene scene) {
        if (session_) return session_->setScene(std::move(scene));
        session::Options options;
        options.interleave = kInterleave;
        options.specialise = specialise_;
        session_ = std::make_unique<session::Session>(context(), std::move(scene), options);
    }

    template <class Change> void move(const Change& change) {
        guarded([&] {
            scene::Camera camera = session().camera();
            change(camera);
            session().moveCamera(camera);
        });
    }

    session::Session& session() const {
        if (!session_) throw Error(ErrorKind::BadInput, "the engine shows no scene yet");
        return *session_;
    }
    const gpu::Context& context() const {
        if (!context_) throw Error(ErrorKind::BadInput, "the engine has not been started");
        return *context_;
    }

    // The session dies before its context.
    std::unique_ptr<gpu::Context> context_;
    std::unique_ptr<session::Session> session_;
    // Kept while nothing else is opened: the session's own may go away and come back. Static: so does a lost context.
    inline static std::string providedName_;                       // NOLINT: one page, one thread
    inline static std::shared_ptr<const volume::Volume> provided_; // NOLINT
    bool specialise_ = false;                                      ///< kernels have constants, except during live edits
};

std::string schemaJson() {
    return guarded([] { return session::catalogue()->toJson().dump(); });
}

constexpr std::string_view kSceneFolder = "scenes/";
constexpr std::string_view kSceneExtension = ".json";

/// The gallery: names and titles, in order.
std::string galleryJson() {
    return guarded([] {
        Json gallery = Json::array();
        for (const Resource& resource : resourcesInFolder("scenes", kSceneExtension)) {
            std::string_view name = resource.path.substr(resource.path.rfind('/') + 1);
            name.remove_suffix(kSceneExtension.size());
            const Json document = Json::parse(resource.text, nullptr, false);
            const auto title = document.is_object() ? document.find("title") : document.end();
            const bool titled = document.is_object() && title != document.end() && title->is_string();
            gallery.push_back({{"name", name}, {"title", titled ? title->get<std::string>() : std::string(name)}});
        }
        return gallery.dump();
    });
}

/// The text of a gallery scene.
std::string gallerySceneJson(const std::string& name) {
    return guarded([&] {
        const auto resource = findResource(std::string(kSceneFolder) + name + std::string(kSceneExtension));
        if (!resource) throw Error(ErrorKind::BadInput, "there is no gallery scene " + inQuotes(name));
        return std::string(resource->text);
    });
}

} // namespace
} // namespace apeiron::web

EMSCRIPTEN_BINDINGS(apeiron) {
    using namespace emscripten;
    using apeiron::web::Engine;
    class_<Engine>("Engine")
        .constructor<>()
        .function("start", &Engine::start)
        .function("loadScene", &Engine::loadScene)
        .function("openVolume", &Engine::openVolume)
        .function("volumeJson", &Engine::volumeJson)
        .function("histogramJson", &Engine::histogramJson)
        .function("valueJson", &Engine::valueJson)
        .function("resize", &Engine::resize)
        .function("sceneJson", &Engine::sceneJson)
        .function("ownModulesJson", &Engine::ownModulesJson)
        .function("set", &Engine::set)
        .function("tunable", &Engine::tunable)
        .function("tune", &Engine::tune)
        .function("reset", &Engine::reset)
        .function("step", &Engine::step)
        .function("show", &Engine::show)
        .function("samples", &Engine::samples)
        .function("progress", &Engine::progress)
        .function("orbit", &Engine::orbit)
        .function("zoom", &Engine::zoom)
        .function("pan", &Engine::pan)
        .function("fly", &Engine::fly)
        .function("look", &Engine::look)
        .function("zoomAround", &Engine::zoomAround)
        .function("aim", &Engine::aim)
        .function("toTarget", &Engine::toTarget)
        .function("pointAt", &Engine::pointAt)
        .function("focusAt", &Engine::focusAt)
        .function("notesJson", &Engine::notesJson)
        .function("emptyReason", &Engine::emptyReason)
        .function("distanceToSurface", &Engine::distanceToSurface)
        .function("distanceToTarget", &Engine::distanceToTarget)
        .function("autopilot", &Engine::autopilot)
        .function("scalePower", &Engine::scalePower)
        .function("pixels", &Engine::pixels)
        .function("statisticsJson", &Engine::statisticsJson)
        .function("device", &Engine::device)
        .function("software", &Engine::software)
        .function("maxSize", &Engine::maxSize)
        .function("width", &Engine::width)
        .function("height", &Engine::height);
    function("schemaJson", &apeiron::web::schemaJson);
    function("galleryJson", &apeiron::web::galleryJson);
    function("gallerySceneJson", &apeiron::web::gallerySceneJson);
}
