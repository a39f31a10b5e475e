#pragma once

#include "core/stopwatch.hpp"
#include "gpu/timer.hpp"
#include "post/chain.hpp"
#include "render/governor.hpp"
#include "render/renderer.hpp"
#include "scene/camera.hpp"
#include "volume/histogram.hpp"
#include "volume/volume_subject.hpp"

#include <functional>
#include <limits>
#include <optional>

namespace apeiron::session {

/// Everything that scenes can be made of: the document's own node types and all subjects.
std::shared_ptr<const scene::Catalogue> catalogue();

struct Options {
    /// Where kernels run; the default is what was measured to be faster on the kind of device.
    std::optional<gpu::Stage> stage = {};
    /// Parameters become constants of the kernels: faster, but every edit of one compiles anew (see
    /// render::BuildOptions).
    bool specialise = true;
    /// Most pixels that are submitted at once; 0 leaves it to the governor. The picture does not depend on it.
    std::int64_t tilePixels = 0;
    /// The first sample comes as factor² interleaved sub-images (1 to 8), so that there is a whole, coarse
    /// picture at once. The converged picture does not depend on it.
    int interleave = 1;
    /// After a move of the camera, pixels that are not computed yet show what the picture before has of them.
    bool reproject = true;
    /// All data is there before the first sample, instead of coming in while there is a coarser picture.
    bool wholeData = false;
};

/// What a step did.
struct StepResult {
    std::int64_t samples = 0; ///< complete samples now
    bool changed = false;     ///< show() would show something new
    bool finished = false;    ///< output.samples, output.noise or output.time is reached: nothing left to do
};

/// What was done since the session was made.
struct Statistics {
    Phases phases;           ///< "compile", "generate", "integrate", "present", "post", "read"
    std::int64_t pixels = 0; ///< estimates of single pixels computed
    std::int64_t submissions = 0;
    double longestSubmission = 0.0; ///< [s]
};

/// The façade of the engine: a scene, and the picture of it that gets better with every step. All front ends use this
/// and nothing below it. Not thread-safe. Needs its context current on the calling thread.
class Session {
  public:
    /// Starts with the default scene. @param context must outlive the session.
    explicit Session(const gpu::Context& context, const Options& options = {});
    Session(const gpu::Context& context, scene::Scene scene, const Options& options = {});
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const scene::Scene& scene() const { return scene_; }
    const gpu::Context& context() const { return context_; }
    gpu::Stage stage() const { return build_.stage; }
    glm::ivec2 size() const;

    /// Replaces the scene; keeps what it can (programs, samples when nothing changed). Compiles at once.
    /// The old scene stays when it throws. @throws Error
    void setScene(scene::Scene scene);

    /// Edits one value by path (see scene::Scene::set). Compiles at once where needed; nothing changes when it throws.
    /// The picture so far is shown until there is the first sub-image of the new one (see Options::interleave).
    parameter::Invalidates set(std::string_view path, std::string_view text, const std::filesystem::path& base = {});
    parameter::Invalidates set(std::string_view path, const Json& value, const std::filesystem::path& base = {});

    /// Makes parameters constants of the kernels, or uniforms again (see Options). Compiles at once; samples start
    /// anew. Nothing changes when it throws. @throws Error
    void setSpecialise(bool specialise);
    bool specialised() const { return build_.specialise; }

    /// Moves the camera; samples start anew. What the picture so far shows is kept and seen from the new place, until
    /// there is something better (see Options::reproject).
    void setCamera(const scene::Camera& camera);
    /// Moves the camera, but not through a surface: it stops where one is so near that the way on would lead into it.
    /// Whether it got there. From inside a surface every way is free.
    bool moveCamera(const scene::Camera& wanted);
    /// Flies on, at a speed in proportion to the distance of the nearest surface: that is approached for ever, and
    /// never touched. @param direction in camera space (x right, y up, z backwards); its length does not matter
    /// @param speed [distances to the surface per second] @param seconds since the last call [s]
    void fly(const glm::dvec3& direction, double speed, double seconds);
    /// Lets the camera fly by itself, where the subject knows how (see render::Subject::autopilot()); speed as of
    /// fly().
    /// @returns false, and nothing changes, where it does not
    bool autopilot(render::Autopilot way, double speed, double seconds);
    scene::Camera camera() const { return scene::Camera(scene_.camera); }

    /// Forgets all samples.
    void reset();

    /// Works for at most `budget` seconds [s] and returns; does at least one pixel's work when there is any. How much
    /// is done at once follows from what was measured.
    StepResult step(double budget);

    /// Complete samples of every pixel.
    std::int64_t samples() const { return samples_; }
    /// Part of the sample in progress that is done, 0..1.
    double progress() const;
    /// render::Accumulation::noise() of now. Reads the accumulators back.
    double noise();

    /// The finished picture, display-encoded: RGBA in [0, 1], rows from the top.
    /// @param dither one step of the output (1/255 for 8 bits), or 0
    Image<float> picture(double dither = 0.0);

    /// Shows the picture in the current default framebuffer (a window's, a canvas'), which has the scene's size.
    void show();

    /// HDR layers as presented: radiance + coverage, normal + depth, albedo + hit share. Rows from the top.
    struct Layers {
        Image<float> radiance;
        Image<float> geometry;
        Image<float> albedo;
    };
    Layers layers();

    /// All samples so far, for saving and merging.
    render::Accumulation accumulation();

    /// Distance along the camera ray to what is seen at a pixel [world units]; nothing where it is background.
    std::optional<double> distanceAt(glm::ivec2 pixel);

    /// From the camera to what is seen at a pixel [world units]; nothing where it is background.
    std::optional<glm::dvec3> pointAt(glm::ivec2 pixel);

    /// The volume that is shown, and how; nothing where the subject is none.
    std::optional<volume::Shown> volume() const { return volume::shown(*subject_, scene_); }

    /// What the volume holds where a pixel shows it; nothing where it is background, or the subject is no volume.
    std::optional<volume::Reading> valueAt(glm::ivec2 pixel);

    /// How many voxels of a channel have which values, over volume::histogramAxis(), in `values` classes; and which
    /// gradient magnitudes, up to DataRange::gradientHigh, in `gradients` classes where these are more than 1. Nothing
    /// where the subject is no volume. @throws Error (BadInput) for channels that are not there, and classes that are
    /// not 1 to 4096 (values), 1 to 1024 (gradients)
    std::optional<volume::Histogram> histogram(int channel, int values, int gradients = 1) const;

    /// Moves the camera's plane of focus to what is seen at a pixel; false, and nothing changes, where that is
    /// background. Samples start anew only where the lens has an aperture.
    bool focusAt(glm::ivec2 pixel);

    /// Distance from the camera to the nearest surface [world units]: what camera speed should follow.
    double distanceToSurface();

    /// What someone should know about how the scene is shown (see render::Subject::notes()).
    std::vector<std::string> notes() const;

    /// Why the picture shows nothing (the camera is inside the surface, nothing is in view, no light), in one line with
    /// what to do; empty when it shows something. Reads back as much of the layers as it takes to know that.
    std::string emptyReason();

    const Statistics& statistics() const { return statistics_; }

    /// How large what is around the camera is, as a power of ten (see render::Subject::scalePower()).
    std::optional<double> scalePower() const { return subject_->scalePower(); }

    /// What the subject counts (tiles drawn, generated, cached, ...): names and values of now.
    std::vector<std::pair<std::string, double>> counters() const { return subject_->counters(); }

  private:
    /// Takes another scene, of which `what` is stale; the old one stays when that throws. Returns what was made anew.
    parameter::Invalidates replace(scene::Scene scene, parameter::Invalidates what);
    /// After a move: world units that fit the place (see render::Subject::rebase()). The picture stays.
    void rebase();
    /// The picture of before the move is now seen from elsewhere, in other units. @param scale new units per old one
    /// @param position of the camera, in new units @param back from it to where it was, in new units
    void carryHistory(double scale, const parameter::Decimal3& position, const glm::dvec3& back);
    void apply(parameter::Invalidates what, bool sizeChanged);
    /// Puts a camera that the scene says nothing of where it sees all of the subject, where that has bounds.
    void frame(const render::Subject& subject, glm::ivec2 size);
    void present();
    /// Forgets all samples. @param keep the old picture fills the new one
    void restart(bool keep);
    /// Whether every pixel has something to show.
    bool wholePicture() const { return held_ || samples_ > 0 || block_ > 0 || cameraBefore_.has_value(); }
    /// Has the present picture ready to be shown for longer, if it is whole and may be. @returns whether it is
    bool holdPicture();
    /// Keeps the present picture for after a move of the camera.
    void keepPicture();
    /// Folds the complete sample into the accumulators, and begins the next.
    void integrate();
    bool advance(double remaining, bool mustWork);
    /// Runs GPU work to its end and books its time under a phase; returns the wall time [s].
    double timed(const char* phase, const std::function<void()>& work);
    bool limitReached(double secondsOfStep);
    /// The picture's noise; stops the sampling of pixels that are better than `target`.
    double lookAtNoise(double target);

    const gpu::Context& context_;
    Options options_;
    render::BuildOptions build_;
    scene::Scene scene_;
    gpu::KernelCache cache_;
    std::unique_ptr<render::Subject> subject_;
    std::string subjectName_;
    std::unique_ptr<render::Renderer> renderer_;
    std::string variant_; ///< render::variantOf() that it was made for
    std::unique_ptr<render::Picture> picture_;
    std::unique_ptr<render::Picture> before_;   ///< the picture of before the camera moved ...
    std::optional<scene::Camera> cameraBefore_; ///< ... and its camera; none: there is none
    double scaleBefore_ = 1.0;                  ///< world units now per unit of that picture
    std::unique_ptr<render::View> viewBefore_;
    std::unique_ptr<post::Chain> chain_;
    std::unique_ptr<gpu::Texture> displayTexture_;
    gpu::Targets displayTargets_;

    gpu::Timer timer_;
    render::Governor governor_;
    render::Interleave interleave_;
    render::TileCursor prepass_; ///< what is left to do of the prepass
    render::Governor prepassGovernor_;
    render::TileCursor cursor_;
    int block_ = 0;        ///< sub-images of the sample in progress that are complete
    bool pending_ = false; ///< the sample in progress is computed but not integrated
    bool single_ = false;  ///< the first sample is complete and counted, but not integrated: it was to be the only one
    double integrateSeconds_ = 0.0;
    double drawSeconds_ = 0.0; ///< what drawing the subject took last
    std::int64_t samples_ = 0;
    double seconds_ = 0.0;                                       ///< spent in step() since the last reset
    std::int64_t noiseCheck_ = 8;                                ///< the sample count at which noise is looked at next
    double noiseSeen_ = std::numeric_limits<double>::infinity(); ///< when it was looked at last
    bool moved_ = false; ///< the picture can show another view already, although nothing new was computed
    bool held_ = false;  ///< picture_ shows the scene of before an edit, as there is nothing of the new one yet
    bool stale_ = true;  ///< picture_ does not show the present state
    Statistics statistics_;
};

} // namespace apeiron::session
