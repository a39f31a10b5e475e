// How fast mcs and mcm converge: PSNR against a reference of many samples with another seed, and iterations a second.
// The method of figure 7 and table 1 of Lesar, Bohak & Marolt (2018).
//
//     apeiron_convergence [--volume FILE] [--lamp] [--sizes 256 512 1024] [--grids 64 128 256] [--csv FILE]
//
// Without a file the volume is the generated cloud. A file is reduced by means of boxes of voxels to each size of grid.
// Times are of rendering alone (generate + integrate): start, loading and compilation do not count. References have as
// many samples as --seconds allows, looks end at an eighth of them: what is left of the reference's noise then takes up
// to 0.5 dB off. PSNR is told of display values (sRGB, linear tone mapper, not rounded), as one sees them, and of
// linear radiance cut to [0, 1], as a floating-point render target holds it. Times in brackets are extrapolated from
// the last look: error falls as the square root of the samples.

#include "bench_support.hpp"
#include "core/file.hpp"
#include "io/image_file.hpp"
#include "io/volume_file.hpp"
#include "session/session.hpp"
#include "volume/source.hpp"
#include "volume/voxels.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

using namespace apeiron;
using bench::psnr;

constexpr const char* kScene = R"({
    "apeiron": 1,
    "subject": {"type": "volume", "density": 100, "transfer": {"window": "data", "points": [
        {"value": 0, "color": "#e0b080", "opacity": 0}, {"value": 1, "color": "#e0b080", "opacity": 1}]}},
    "renderer": {"type": "mcm", "bounces": 8},
    "lights": [],
    "environment": {"type": "constant", "color": [1, 1, 1]},
    "post": {"tonemapper": "linear"}
})";

/// Small and bright in the dark: 4 degrees wide, and white paper that faces it is just as bright as displays can show.
constexpr const char* kLamp =
    R"([{"type": "sun", "elevation": 50, "azimuth": 240, "color": [1, 1, 1], "intensity": 3.14159265, "size": 4}])";

struct Settings {
    std::string volume;
    std::vector<int> sizes{256, 512, 1024};
    std::vector<int> grids{64, 128, 256};
    std::vector<std::string> renderers{"mcs", "mcm"};
    std::vector<std::string> set;
    int samples = 512;     ///< most of a look
    int reference = 4000;  ///< most of a reference
    double seconds = 20.0; ///< of rendering a reference [s]
    bool lamp = false;
    std::string csv;
    std::string dump;
};

/// One look at a picture that gets better.
struct Look {
    std::int64_t samples = 0;
    double wall = 0.0;    ///< of rendering [s]
    double cpu = 0.0;     ///< of all threads [s]
    double display = 0.0; ///< PSNR of display values [dB]
    double linear = 0.0;  ///< PSNR of radiance cut to [0, 1] [dB]
    Image<float> picture{1, 1, 4};
    Image<float> radiance{1, 1, 4};
};

/// The first channel with `size` voxels along its longest side, each the mean of the box of voxels that it stands for.
volume::Volume reduced(const volume::Volume& from, int size) {
    const int longest = std::max({from.size.x, from.size.y, from.size.z});
    const int factor = std::max(longest / size, 1);
    if (factor == 1) return from;
    volume::Volume to = from;
    to.size = glm::max(from.size / factor, 1);
    to.channels = to.timePoints = 1;
    to.type = volume::VoxelType::Float32;
    const glm::dvec3 shift(0.5 * (factor - 1));
    to.indexToWorld[3] = from.indexToWorld * glm::dvec4(shift, 1.0);
    for (int i = 0; i < 3; ++i)
        to.indexToWorld[i] = from.indexToWorld[i] * static_cast<double>(factor);
    std::vector<float> means(volume::voxelsPerChannel(to), 0.0F);
    const auto index = [&](glm::ivec3 p) {
        const glm::u64vec3 q(p);
        const glm::u64vec3 size64(to.size);
        return static_cast<std::size_t>((q.z * size64.y + q.y) * size64.x + q.x);
    };
    volume::visitVoxels(from, 0, [&](const auto* voxels) {
        std::size_t i = 0;
        for (int z = 0; z < from.size.z; ++z) {
            for (int y = 0; y < from.size.y; ++y) {
                for (int x = 0; x < from.size.x; ++x, ++i) {
                    const glm::ivec3 p = glm::ivec3(x, y, z) / factor;
                    if (glm::any(glm::greaterThanEqual(p, to.size))) continue;
                    means[index(p)] += volume::number(voxels[i]) / static_cast<float>(factor * factor * factor);
                }
            }
        }
    });
    to.voxels.resize(means.size() * sizeof(float));
    if (from.type == volume::VoxelType::UInt8) { // as other programs have it
        to.type = from.type;
        to.voxels.resize(means.size());
        for (std::size_t i = 0; i < means.size(); ++i)
            to.voxels[i] = static_cast<std::byte>(std::lround(means[i]));
    } else {
        std::memcpy(to.voxels.data(), means.data(), to.voxels.size());
    }
    return to;
}

/// The sphere around the whole box, however much of that is empty, as high as the picture (as
/// bench/web_convergence.ts). Around the origin: volumes that seem to stand on their heads are turned about it.
void centre(scene::Scene& scene, volume::Volume& volume) {
    const glm::dvec3 size(volume.size);
    volume.indexToWorld[3] -= volume.indexToWorld * glm::dvec4(0.5 * size - 0.5, 1.0) - glm::dvec4(0, 0, 0, 1);
    double longest = 0.0;
    for (int i = 0; i < 3; ++i)
        longest = std::max(longest, size[i] * glm::length(glm::dvec3(volume.indexToWorld[i])));
    const glm::dvec3 position = 2.53 * longest * glm::normalize(glm::dvec3(0.38, -1.0, 0.22));
    scene.set("camera.position", std::string_view(fmt::format("{},{},{}", position.x, position.y, position.z)));
    scene.set("camera.target", std::string_view("0,0,0"));
    scene.set("camera.fov", std::string_view("40"));
}

void renderUntil(session::Session& session, std::int64_t samples) {
    session.set("output.samples", std::string_view(std::to_string(samples)));
    while (!session.step(1.0).finished) {
    }
}

/// Times and pictures of now; how good they are is to be worked out.
Look lookAt(session::Session& session) {
    Look look;
    look.samples = session.samples();
    const auto& times = session.statistics().phases.times;
    for (const char* phase : {"generate", "integrate"}) {
        const auto found = times.find(phase);
        if (found == times.end()) continue;
        look.wall += 1e-3 * found->second.wallMs;
        look.cpu += 1e-3 * found->second.cpuMs;
    }
    look.picture = session.picture();
    look.radiance = session.layers().radiance;
    for (float& value : look.radiance.data())
        value = std::clamp(value, 0.0F, 1.0F);
    return look;
}

/// As many samples as fit into the seconds, but not more than `most`.
Look referenceOf(session::Session& session, double seconds, std::int64_t most) {
    std::int64_t samples = 1;
    renderUntil(session, samples);
    Look look = lookAt(session);
    while (samples < most && look.wall < seconds) {
        const double left = seconds / look.wall * static_cast<double>(samples);
        samples = std::min({most, 2 * samples, std::max(samples + 1, static_cast<std::int64_t>(left))});
        renderUntil(session, samples);
        look = lookAt(session);
    }
    return look;
}

/// Exponent of the error by a line through its logarithms: -0.5 for independent samples. Nothing for a single look.
std::string slope(const std::vector<Look>& looks) {
    if (looks.size() < 2) return "";
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (const Look& look : looks) {
        const double u = std::log(static_cast<double>(look.samples));
        const double v = -look.display / 20.0 * std::log(10.0);
        n += 1.0;
        x += u;
        y += v;
        xx += u * u;
        xy += u * v;
    }
    return fmt::format("{:.2f}", (n * xy - x * y) / (n * xx - x * x));
}

/// When a PSNR is reached, between looks along the logarithm of time [s]; in brackets where the looks end before.
std::string reached(const std::vector<Look>& looks, double Look::*psnr, double wanted) {
    for (std::size_t i = 0; i < looks.size(); ++i) {
        if (looks[i].*psnr < wanted) continue;
        if (i == 0) return fmt::format("< {:.2f}", looks[i].wall);
        const Look& a = looks[i - 1];
        const Look& b = looks[i];
        const double part = (wanted - a.*psnr) / (b.*psnr - a.*psnr);
        return fmt::format("{:.2f}", std::exp(std::log(a.wall) + part * (std::log(b.wall) - std::log(a.wall))));
    }
    const Look& last = looks.back();
    return fmt::format("({:.1f})", last.wall * std::pow(10.0, 0.1 * (wanted - last.*psnr)));
}

/// PSNR after 1, 4, 16, ... samples.
std::string course(const std::vector<Look>& looks, double Look::*psnr) {
    std::string text;
    for (std::size_t i = 0; i < looks.size(); i += 2)
        text += fmt::format("{}{:.1f}", text.empty() ? "" : ", ", looks[i].*psnr);
    return text;
}

void run(const Settings& settings) {
    const auto context = gpu::Context::create();
    volume::setVolumeLoader(io::readVolume);
    std::shared_ptr<const volume::Volume> file;
    if (!settings.volume.empty()) file = volume::loadVolume({settings.volume, {}, {}, 0});
    std::string csv = "renderer,size,grid,reference,samples,seconds,cpu_seconds,psnr_display,psnr_linear\n";
    fmt::print("{}, {}\n\n", settings.volume.empty() ? "cloud" : settings.volume, settings.lamp ? "lamp" : "white sky");
    fmt::print(
        "| renderer | picture | volume | reference, samples | iterations/s | CPU ms a sample | PSNR [dB] of display "
        "values after 1, 4, 16, ... samples | of linear radiance | error falls as n^ | display: 24 dB after [s] | "
        "30 dB | 35 dB | linear: 24 dB | 30 dB | 35 dB |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
        "\n");
    for (const std::string& renderer : settings.renderers) {
        for (const int grid : settings.grids) {
            scene::Scene scene = scene::Scene::parse(session::catalogue(), "convergence", kScene);
            if (settings.lamp) {
                scene.set("lights", Json::parse(kLamp));
                scene.set("environment.color", std::string_view("0,0,0"));
            }
            scene.set("renderer.type", std::string_view(renderer));
            if (renderer == "mcm") scene.set("renderer.bounces", std::string_view("8"));
            if (file) {
                const auto volume = std::make_shared<volume::Volume>(reduced(*file, grid));
                centre(scene, *volume);
                volume::provideVolume("reduced", volume);
                scene.set("subject.source", std::string_view("reduced"));
                if (file->type == volume::VoxelType::UInt8) { // opacity is the byte
                    Json transfer = scene.subject.get<parameter::Structure>("transfer").json;
                    transfer["window"] = {{"level", 127.5}, {"width", 255}};
                    scene.set("subject.transfer", transfer);
                }
            } else {
                scene.set("subject.resolution", std::to_string(grid));
            }
            scene.set("output.samples", std::string_view("1000000"));
            for (const std::string& edit : settings.set) {
                const std::size_t equals = edit.find('=');
                scene.set(edit.substr(0, equals), std::string_view(edit).substr(equals + 1));
            }
            for (const int size : settings.sizes) {
                scene.set("output.width", std::to_string(size));
                scene.set("output.height", std::to_string(size));
                scene.set("output.seed", std::string_view("1"));
                Look reference;
                {
                    session::Session session(*context, scene);
                    reference = referenceOf(session, settings.seconds, settings.reference);
                }
                scene.set("output.seed", std::string_view("0"));
                std::vector<Look> looks;
                session::Session session(*context, scene);
                const std::int64_t most = std::clamp<std::int64_t>(reference.samples / 8, 1, settings.samples);
                for (std::int64_t n = 1; n <= most; n *= 2) {
                    renderUntil(session, n);
                    Look look = lookAt(session);
                    look.display = psnr(look.picture, reference.picture);
                    look.linear = psnr(look.radiance, reference.radiance);
                    csv += fmt::format("{},{},{},{},{},{:.4f},{:.4f},{:.3f},{:.3f}\n", renderer, size, grid,
                                       reference.samples, look.samples, look.wall, look.cpu, look.display, look.linear);
                    looks.push_back(std::move(look));
                }
                // The reference's time says most of how fast samples are.
                const auto count = static_cast<double>(reference.samples);
                fmt::print("| {} | {}² | {}³ | {} | {:.2f} | {:.0f} | {} | {} | {}", renderer, size, grid,
                           reference.samples, count / reference.wall, 1e3 * reference.cpu / count,
                           course(looks, &Look::display), course(looks, &Look::linear), slope(looks));
                for (const auto measure : {&Look::display, &Look::linear}) {
                    for (const double wanted : {24.0, 30.0, 35.0})
                        fmt::print(" | {}", reached(looks, measure, wanted));
                }
                fmt::print(" |\n");
                std::fflush(stdout);
                if (!settings.dump.empty()) {
                    const std::string base = fmt::format("{}/{}_{}_{}", settings.dump, renderer, size, grid);
                    io::writeImage(base + "_reference.png", reference.picture, 8, {});
                    for (const Look& look : looks)
                        io::writeImage(fmt::format("{}_{}.png", base, look.samples), look.picture, 8, {});
                }
            }
        }
    }
    if (!settings.csv.empty()) writeFile(settings.csv, csv);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("How fast the renderers of media converge");
    app.add_option("--volume", settings.volume, "File, reduced to each size of grid; else the generated cloud");
    app.add_option("--sizes", settings.sizes, "Of pictures [px]");
    app.add_option("--grids", settings.grids, "Voxels along the longest side");
    app.add_option("--renderers", settings.renderers);
    app.add_option("--samples", settings.samples, "Looks at 1, 2, 4, ... up to this, and an eighth of the reference");
    app.add_option("--seconds", settings.seconds, "Rendering of a reference, about [s]");
    app.add_option("--reference", settings.reference, "Most samples of a reference");
    app.add_option("--set", settings.set, "PATH=VALUE of the scene");
    app.add_flag("--lamp", settings.lamp, "A small bright lamp in the dark instead of a white sky");
    app.add_option("--csv", settings.csv, "All looks, for bench/plot_convergence.py");
    app.add_option("--dump", settings.dump, "Folder for the pictures");
    CLI11_PARSE(app, argc, argv);
    return bench::runAs("apeiron_convergence", [&] { run(settings); });
}
