#include "session/session.hpp"

#include "core/error.hpp"
#include "render/kernel_sources.hpp"
#include "session/subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#ifndef __EMSCRIPTEN__
#include <unistd.h>
#endif

namespace apeiron::session {
namespace {

constexpr auto kFloat4 = gpu::PixelFormat::RGBA32F;

/// After a move of the camera, what the old picture shows of a pixel counts this much beside its first new value, and
/// less with every sample.
constexpr float kShareAtFirst = 0.7F;
constexpr std::int64_t kFadingSamples = 8;

/// Part of a step's budget that work is planned for: what the rest of the machine does meanwhile must fit in as well.
constexpr double kPlanned = 0.9;

/// Pixels are left out only when they have so many samples: of fewer, the variance is not known well enough.
constexpr std::int64_t kLeastSamples = 16;

glm::ivec2 sizeOf(const scene::Scene& scene) {
    return {static_cast<int>(scene.output.integer("width")), static_cast<int>(scene.output.integer("height"))};
}

gpu::Stage chooseStage(const gpu::Context& context, const Options& options) {
    if (options.stage) return *options.stage;
    // Hardware shades fragments on a part of its processors only, software is faster without a workgroup's bookkeeping
    // (docs/performance.md).
    const gpu::Capabilities& c = context.capabilities();
    return c.compute && !c.software ? gpu::Stage::Compute : gpu::Stage::Fragment;
}

/// Whether the picture from both cameras is the same: without a lens, where its focus is makes no difference.
bool seenAlike(parameter::Node a, const parameter::Node& b) {
    if (a.number("aperture") != 0.0 || b.number("aperture") != 0.0) return a == b;
    a.set("focus", b.value("focus"));
    a.set("blades", b.value("blades"));
    return a == b;
}

/// Whether nodes differ in what kernels may have as constants: structures (transfer functions) are textures always.
bool differInConstants(const parameter::Node& a, const parameter::Node& b) {
    if (a == b) return false;
    if (&a.type() != &b.type()) return true;
    parameter::Node rest = a;
    for (const parameter::Parameter& parameter : a.schema()) {
        if (parameter.type == parameter::Type::Structure) rest.set(parameter.name, b.value(parameter.name));
    }
    return !(rest == b);
}

/// Refuses sizes that the device or this machine's memory cannot hold, before anything is allocated.
void requireSize(const gpu::Context& context, glm::ivec2 size, bool reproject) {
    const gpu::Capabilities& c = context.capabilities();
    // Pictures may be read in blocks of 8 x 8.
    const int most = c.maxTextureSize / 8 * 8;
    if (size.x > most || size.y > most) {
        throw Error(ErrorKind::BadInput, fmt::format("{}x{} is larger than the device's textures", size.x, size.y),
                    "output.width, output.height", fmt::format("{} takes up to {}x{}", c.renderer, most, most));
    }
#ifndef __EMSCRIPTEN__
    if (c.software) {
        const std::int64_t perPixel = render::kBytesPerPixel + (reproject ? render::kBytesPerPixelToMove : 0);
        const double needed = static_cast<double>(size.x) * size.y * static_cast<double>(perPixel);
        const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
        if (needed > 0.8 * there) {
            throw Error(ErrorKind::BadInput,
                        fmt::format("{}x{} needs {:.1f} GiB of memory, this machine has {:.1f}", size.x, size.y,
                                    needed / (1 << 30), there / (1 << 30)),
                        "output.width, output.height", "choose a smaller size");
        }
    }
#endif
}

} // namespace

Session::Session(const gpu::Context& context, const Options& options)
    : Session(context, scene::Scene(catalogue()), options) {}

Session::Session(const gpu::Context& context, scene::Scene scene, const Options& options)
    : context_(context), options_(options), build_{chooseStage(context, options_), options_.specialise},
      scene_(std::move(scene)), cache_(context), timer_(context), interleave_(options_.interleave), prepass_({1, 1}),
      cursor_({1, 1}) {
    apply(parameter::Invalidates::Program, true);
}

Session::~Session() = default;

glm::ivec2 Session::size() const {
    return sizeOf(scene_);
}

void Session::frame(const render::Subject& subject, glm::ivec2 size) {
    const auto bounds = subject.bounds();
    if (!bounds || bounds->radius <= 0.0) return;
    if (scene_.camera != scene::Scene(scene_.sharedCatalogue()).camera) return;
    scene::Camera camera(scene_.camera);
    const double aspect = static_cast<double>(size.x) / size.y;
    if (bounds->corners.empty() || bounds->front == glm::dvec3(0.0))
        camera.frame(bounds->center, bounds->radius, aspect, bounds->front);
    else
        camera.frame(bounds->center, bounds->corners, aspect, bounds->front);
    scene_.camera = camera.node();
}

void Session::apply(parameter::Invalidates what, bool sizeChanged) {
    using parameter::Invalidates;
    if (what == Invalidates::Nothing && !sizeChanged) return;
    const glm::ivec2 size = sizeOf(scene_);
    if (sizeChanged) requireSize(context_, size, options_.reproject);
    // Everything that can fail is made aside first, so that a failure changes nothing.
    std::unique_ptr<render::Subject> subject;
    std::unique_ptr<render::Renderer> renderer;
    std::unique_ptr<post::Chain> chain;
    std::string variant;
    {
        const Phases::Scope scope(statistics_.phases, "compile");
        const std::string& name = scene_.subject.type().name;
        if (name != subjectName_) {
            for (const render::SubjectType& type : subjectTypes()) {
                if (type.node.name == name) subject = type.create();
            }
            if (subject) subject->setPatient(options_.wholeData);
        }
        render::Subject& current = subject ? *subject : *subject_;
        if (what == Invalidates::Program || what == Invalidates::Samples || subject) {
            current.prepare(context_, scene_);
            frame(current, size);
        }
        variant = render::variantOf(scene_, current);
        if (variant != variant_) what = Invalidates::Program;
        if (what == Invalidates::Program || sizeChanged || subject) {
            renderer = render::makeRenderer(context_, cache_, build_, scene_, current, size);
        }
        chain = std::make_unique<post::Chain>(context_, cache_, build_.stage, scene_, size);
        if (sizeChanged) {
            auto picture = std::make_unique<render::Picture>(context_, size, options_.reproject);
            auto texture = std::make_unique<gpu::Texture>(context_, kFloat4, size, "display");
            displayTargets_ = gpu::Targets(context_, {texture.get()});
            displayTexture_ = std::move(texture);
            picture_ = std::move(picture);
            // Made now, as the first move of a camera should not wait for it.
            before_ = options_.reproject ? std::make_unique<render::Picture>(context_, size, true) : nullptr;
        }
    }
    if (subject) {
        subject_ = std::move(subject);
        subjectName_ = scene_.subject.type().name;
    }
    const bool fresh = renderer != nullptr;
    variant_ = std::move(variant);
    if (fresh) {
        renderer_ = std::move(renderer);
        picture_->mean = picture_->spread = nullptr; // they were the old one's
    }
    chain_ = std::move(chain);
    stale_ = true;
    if (what == Invalidates::Program || sizeChanged) {
        governor_.restart();
        prepassGovernor_.restart();
    }
    if (what == Invalidates::Program || what == Invalidates::Samples || sizeChanged) {
        renderer_->setScene(scene_, render::View(scene_, size), *subject_);
        reset();
    }
    const Phases::Scope scope(statistics_.phases, "compile");
    // (Into the picture that nobody needs: the other one may be shown for a while.)
    if (fresh) renderer_->warmUp(before_ ? *before_ : *picture_);
    chain_->warmUp(scene_, *picture_, displayTargets_);
    context_.finish();
}

parameter::Invalidates Session::replace(scene::Scene scene, parameter::Invalidates what) {
    if (scene.camera != scene_.camera && seenAlike(scene.camera, scene_.camera)) {
        scene::Scene rest = scene;
        rest.camera = scene_.camera;
        what = scene::strongest(parameter::Invalidates::Present, scene::difference(scene_, rest));
    }
    // A specialised session's kernels hold these parts' values as constants; cameras, lights but for
    // their number and kinds (render::variantOf()), and sizes are uniforms always.
    const bool constants = differInConstants(scene.subject, scene_.subject) || scene.slots != scene_.slots ||
                           scene.renderer != scene_.renderer || scene.environment != scene_.environment;
    if (what == parameter::Invalidates::Samples && build_.specialise && constants)
        what = parameter::Invalidates::Program;
    const bool sizeChanged = sizeOf(scene) != sizeOf(scene_);
    // Until there is something of the new picture, the old one is better than none.
    const bool anew = what == parameter::Invalidates::Samples || what == parameter::Invalidates::Program;
    const bool hold = anew && !sizeChanged && scene.camera == scene_.camera && holdPicture();
    std::swap(scene, scene_);
    try {
        apply(what, sizeChanged);
    } catch (...) {
        std::swap(scene, scene_);
        if (scene_.subject.type().name == subjectName_) subject_->prepare(context_, scene_);
        throw;
    }
    held_ = hold;
    return what;
}

void Session::setScene(scene::Scene scene) {
    const parameter::Invalidates what = scene::difference(scene_, scene);
    replace(std::move(scene), what);
}

parameter::Invalidates Session::set(std::string_view path, std::string_view text, const std::filesystem::path& base) {
    scene::Scene edited = scene_;
    const parameter::Invalidates what = edited.set(path, text, base);
    return replace(std::move(edited), what);
}

parameter::Invalidates Session::set(std::string_view path, const Json& value, const std::filesystem::path& base) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    return set(path, std::string_view(text), base);
}

void Session::setSpecialise(bool specialise) {
    if (specialise == build_.specialise) return;
    const bool hold = holdPicture();
    build_.specialise = specialise;
    try {
        apply(parameter::Invalidates::Program, false);
    } catch (...) {
        build_.specialise = !specialise;
        throw;
    }
    held_ = hold;
}

void Session::setCamera(const scene::Camera& camera) {
    if (camera.node() == scene_.camera) return;
    // Projection and filter are uniforms too: no camera edit needs another program.
    if (seenAlike(camera.node(), scene_.camera)) {
        scene_.camera = camera.node();
        stale_ = true;
        return;
    }
    const bool keep = options_.reproject && camera.node().value("projection") == scene_.camera.value("projection");
    if (keep) keepPicture();
    scene_.camera = camera.node();
    renderer_->setScene(scene_, render::View(scene_, size()), *subject_);
    restart(keep);
}

bool Session::holdPicture() {
    const bool hold = options_.reproject && wholePicture();
    if (hold) present();
    return hold;
}

void Session::keepPicture() {
    // As long as nothing new was computed, the older picture is the better one.
    if (samples_ == 0 && block_ == 0 && cursor_.taken() == 0 && !held_) return;
    present();
    std::swap(picture_, before_);
    cameraBefore_ = camera();
    scaleBefore_ = 1.0;
    viewBefore_ = std::make_unique<render::View>(scene_, size());
}

void Session::reset() {
    restart(false);
}

void Session::restart(bool keep) {
    renderer_->reset();
    const int factor = std::min({options_.interleave, size().x, size().y});
    int first = 0;
    int row = 0;
    if (keep && cameraBefore_) {
        // Other pixels than those of the last time: a journey of short steps must renew all of them.
        if (samples_ == 0 && interleave_.factor() == factor) first = interleave_.first() + block_;
        if (samples_ == 0 && !cursor_.done()) row = cursor_.fresh();
        moved_ = true;
    } else {
        cameraBefore_.reset();
        moved_ = false;
    }
    interleave_ = render::Interleave(factor, first);
    // (A picture as large as the device's textures has no room for sub-images that do not divide it.)
    for (int smaller = factor - 1; !renderer_->holds(interleave_); --smaller)
        interleave_ = render::Interleave(smaller);
    prepass_ = render::TileCursor(renderer_->prepassSize());
    cursor_ = render::TileCursor(interleave_.block(size()), row);
    block_ = 0;
    pending_ = false;
    single_ = false;
    samples_ = 0;
    seconds_ = 0.0;
    noiseCheck_ = 8;
    noiseSeen_ = std::numeric_limits<double>::infinity();
    held_ = false;
    stale_ = true;
}

bool Session::limitReached(double secondsOfStep) {
    const parameter::Node& output = scene_.output;
    if (samples_ >= output.integer("samples")) return true;
    const double time = output.number("time");
    if (time > 0.0 && seconds_ + secondsOfStep >= time && samples_ > 0) return true;
    const double noiseTarget = output.number("noise");
    if (noiseTarget > 0.0 && samples_ >= noiseCheck_) {
        noiseSeen_ = lookAtNoise(noiseTarget);
        // Reading back takes time: look again when the noise can have fallen by a tenth.
        noiseCheck_ = samples_ + std::max<std::int64_t>(samples_ / 5, 1);
    }
    return noiseSeen_ <= noiseTarget;
}

double Session::lookAtNoise(double target) {
    const render::Accumulation all = accumulation();
    // Pixels that are better than the whole picture is to be need nothing more.
    if (samples_ >= kLeastSamples) renderer_->setErrorLimit(static_cast<float>(target * all.luminance()));
    return all.noise();
}

double Session::timed(const char* phase, const std::function<void()>& work) {
    const Stopwatch watch;
    Phases::Scope scope(statistics_.phases, phase);
    timer_.start();
    work();
    timer_.stop();
    context_.finish();
    scope.times().gpuMs += timer_.milliseconds();
    return watch.seconds();
}

void Session::integrate() {
    integrateSeconds_ = timed("integrate", [this] { renderer_->integrate(interleave_); });
    single_ = false;
    // Sub-images serve the first picture; whole pictures are faster afterwards.
    interleave_ = render::Interleave(1);
    block_ = 0;
    cursor_ = render::TileCursor(interleave_.block(size()));
}

bool Session::advance(double remaining, bool mustWork) {
    if (pending_ || single_) {
        // A sample that is to be the only one is shown as it is.
        const bool only = pending_ && samples_ == 0 && scene_.output.integer("samples") == 1;
        if (!only && !mustWork && remaining < 1.5 * integrateSeconds_) return false;
        if (pending_) ++samples_;
        if (only) {
            single_ = true;
        } else {
            integrate();
        }
        pending_ = false;
        stale_ = true;
        return true;
    }
    // After a move the first sample does not wait for the prepass: moves that follow each other quickly would never get
    // beyond it.
    if (!prepass_.done() && (samples_ > 0 || !cameraBefore_)) {
        std::int64_t texels = prepassGovernor_.next(remaining, mustWork);
        if (options_.tilePixels > 0) texels = std::min(texels, options_.tilePixels);
        if (texels <= 0) return false;
        const gpu::Region region = prepass_.take(texels);
        const double seconds = timed("generate", [&] { renderer_->prepass(region); });
        prepassGovernor_.report(static_cast<std::int64_t>(region.size.x) * region.size.y, seconds);
        return true;
    }
    const auto sample = static_cast<std::uint32_t>(samples_ + scene_.output.integer("first_sample"));
    if (renderer_->drawDue(sample)) {
        if (!mustWork && remaining < 1.2 * drawSeconds_) return false;
        drawSeconds_ = timed("draw", [&] { renderer_->draw(sample); });
        return true;
    }
    std::int64_t pixels = governor_.next(remaining, mustWork);
    if (options_.tilePixels > 0) pixels = std::min(pixels, options_.tilePixels);
    if (pixels <= 0) return false;
    const gpu::Region region = cursor_.take(pixels);
    const double seconds =
        timed("generate", [&] { renderer_->generate(sample, interleave_, interleave_.offset(block_), region); });
    const std::int64_t done = static_cast<std::int64_t>(region.size.x) * region.size.y;
    governor_.report(done, seconds);
    statistics_.pixels += done;
    ++statistics_.submissions;
    statistics_.longestSubmission = std::max(statistics_.longestSubmission, seconds);
    // With an older picture around, every new pixel is worth showing.
    if (samples_ == 0 && cameraBefore_) stale_ = true;
    if (!cursor_.done()) return true;
    ++block_;
    if (samples_ == 0) stale_ = true;
    if (block_ == interleave_.count()) {
        pending_ = true;
    } else {
        cursor_ = render::TileCursor(interleave_.block(size()));
    }
    return true;
}

StepResult Session::step(double budget) {
    const Stopwatch watch;
    StepResult result;
    bool mustWork = true;
    budget *= kPlanned;
    if (subject_->update(scene_, 0.25 * budget)) {
        // (What is not whole would leave its holes in the next one.)
        const bool keep = options_.reproject && wholePicture();
        if (keep) keepPicture();
        renderer_->setScene(scene_, render::View(scene_, size()), *subject_);
        restart(keep);
    }
    result.changed = moved_;
    moved_ = false;
    while (!limitReached(watch.seconds())) {
        const std::int64_t before = samples_;
        const int blockBefore = block_;
        if (!advance(budget - watch.seconds(), mustWork)) break;
        mustWork = false;
        result.changed = result.changed || samples_ != before ||
                         (samples_ == 0 && (block_ != blockBefore || (cameraBefore_ && cursor_.taken() != 0)));
        if (budget - watch.seconds() <= 0.0) break;
    }
    seconds_ += watch.seconds();
    result.samples = samples_;
    result.finished = limitReached(0.0) && !subject_->busy();
    return result;
}

double Session::progress() const {
    const double blocks = interleave_.count();
    const glm::ivec2 size = interleave_.block(this->size());
    const double inBlock = 1.0 - static_cast<double>(cursor_.left()) / (static_cast<double>(size.x) * size.y);
    return std::min((block_ + (block_ < interleave_.count() ? inBlock : 0.0)) / blocks, 1.0);
}

double Session::noise() {
    return accumulation().noise();
}

void Session::present() {
    if (!stale_) return;
    if (held_ && samples_ == 0 && block_ == 0) {
        stale_ = false;
        return;
    }
    held_ = false;
    render::Progress progress;
    if (samples_ == 0 || single_) {
        progress.blocks = block_;
        progress.band = {cursor_.first() * interleave_.block(size()).x, static_cast<int>(cursor_.taken())};
        if (block_ == interleave_.count()) progress.band = {0, 0};
    }
    // The old picture's part fades while samples come in, and is gone from a finished one.
    const std::int64_t fading = std::min(kFadingSamples, scene_.output.integer("samples"));
    std::optional<render::History> history;
    if (cameraBefore_ && samples_ < fading) {
        const glm::vec3 offset(render::difference(cameraBefore_->position(), camera().position()));
        const float share = samples_ == 0
                                ? kShareAtFirst
                                : kShareAtFirst * (1.0F - static_cast<float>(samples_) / static_cast<float>(fading));
        history.emplace(render::History{*before_, *viewBefore_, offset, static_cast<float>(scaleBefore_), share});
    }
    timed("present", [&] { renderer_->present(*picture_, interleave_, progress, history ? &*history : nullptr); });
    stale_ = false;
}

Image<float> Session::picture(double dither) {
    present();
    timed("post", [&] {
        post::Display display;
        display.dither = dither;
        chain_->run(scene_, *picture_, displayTargets_, display);
    });
    const Phases::Scope scope(statistics_.phases, "read");
    return displayTexture_->download();
}

void Session::show() {
    present();
    const Phases::Scope scope(statistics_.phases, "post");
    post::Display display;
    display.dither = 1.0 / 255.0;
    display.flip = true;
    display.opaque = true;
    chain_->run(scene_, *picture_, gpu::Targets::screen(size()), display);
    context_.check("showing the picture");
}

Session::Layers Session::layers() {
    present();
    const Phases::Scope scope(statistics_.phases, "read");
    return {picture_->radiance.download(), picture_->geometry.download(), picture_->albedo.download()};
}

render::Accumulation Session::accumulation() {
    if (single_) integrate();
    return renderer_->accumulation();
}

std::optional<double> Session::distanceAt(glm::ivec2 pixel) {
    const glm::ivec2 last = size() - 1;
    present();
    const glm::ivec2 inside = glm::clamp(pixel, glm::ivec2(0), last);
    if (picture_->albedo.texel(inside).w <= 0.0F) return std::nullopt;
    return static_cast<double>(picture_->geometry.texel(inside).w);
}

std::vector<std::string> Session::notes() const {
    return subject_->notes(scene_);
}

bool Session::focusAt(glm::ivec2 pixel) {
    const std::optional<double> distance = distanceAt(pixel);
    if (!distance) return false;
    const glm::dvec2 whole(size());
    const glm::dvec2 place = (2.0 * glm::dvec2(pixel) + 1.0 - whole) / whole * glm::dvec2(1.0, -1.0);
    scene::Camera focused = camera();
    focused.focusOn(*distance, place, whole.x / whole.y);
    setCamera(focused);
    return true;
}

double Session::distanceToSurface() {
    return renderer_->lookAround(scene_, *subject_, glm::vec3(0.0F)).distance;
}

void Session::rebase() {
    scene::Scene edited = scene_;
    const std::optional<double> scale = subject_->rebase(edited);
    if (!scale) return;
    carryHistory(*scale, edited.camera.get<parameter::Decimal3>("position"), glm::dvec3(0.0));
    scene_ = std::move(edited);
    renderer_->setScene(scene_, render::View(scene_, size()), *subject_);
    stale_ = true;
}

void Session::carryHistory(double scale, const parameter::Decimal3& position, const glm::dvec3& back) {
    if (!cameraBefore_) return;
    const glm::dvec3 away = scale * render::difference(cameraBefore_->position(), camera().position()) + back;
    parameter::Decimal3 place = position;
    for (std::size_t i = 0; i < 3; ++i)
        place[i] = place[i] + Decimal(away[static_cast<int>(i)]);
    parameter::Node node = cameraBefore_->node();
    node.set("position", place);
    cameraBefore_.emplace(std::move(node));
    scaleBefore_ *= scale;
}

bool Session::autopilot(render::Autopilot way, double speed, double seconds) {
    if (!(speed > 0.0) || !(seconds > 0.0)) return false;
    scene::Scene edited = scene_;
    const std::optional<render::Flown> flown = subject_->autopilot(edited, way, speed, seconds);
    if (!flown) return false;
    const bool keep = options_.reproject && flown->back;
    if (keep) {
        keepPicture();
        carryHistory(flown->scale, edited.camera.get<parameter::Decimal3>("position"), *flown->back);
    }
    scene_ = std::move(edited);
    renderer_->setScene(scene_, render::View(scene_, size()), *subject_);
    restart(keep);
    return true;
}

bool Session::moveCamera(const scene::Camera& wanted) {
    const scene::Camera here = camera();
    const glm::dvec3 way = render::difference(wanted.position(), here.position());
    // Turning in place needs no look around, which waits for the GPU.
    const bool stays = way == glm::dvec3(0.0);
    const double part = stays ? 1.0 : renderer_->lookAround(scene_, *subject_, glm::vec3(way)).freePart;
    if (part >= 1.0) {
        setCamera(wanted);
        if (!stays) rebase();
        return true;
    }
    parameter::Node node = wanted.node();
    parameter::Decimal3 place = here.position();
    for (std::size_t i = 0; i < 3; ++i)
        place[i] = place[i] + Decimal(part * way[static_cast<int>(i)]);
    node.set("position", place);
    setCamera(scene::Camera(std::move(node)));
    rebase();
    return false;
}

void Session::fly(const glm::dvec3& direction, double speed, double seconds) {
    const double length = glm::length(direction);
    if (length == 0.0 || seconds <= 0.0) return;
    scene::Camera moved = camera();
    const double distance = distanceToSurface();
    const double scale = std::isfinite(distance) && distance > 0.0 ? distance : moved.distance();
    // Towards a surface that is straight ahead, the distance falls exponentially, however long a frame takes.
    moved.fly(direction * (scale * (1.0 - std::exp(-speed * seconds)) / length));
    moveCamera(moved);
}

} // namespace apeiron::session
