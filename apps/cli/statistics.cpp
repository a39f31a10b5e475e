#include "statistics.hpp"

#include "options.hpp"

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace apeiron::cli {
namespace {

/// When the process was created, in seconds since the machine was started [s]; negative when unknown.
double processStart() {
    std::ifstream file("/proc/self/stat");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    // The program's name stands in brackets and may hold anything: fields are counted from behind it.
    const std::size_t bracket = text.rfind(')');
    if (bracket == std::string::npos) return -1.0;
    std::istringstream fields(text.substr(bracket + 1));
    std::string field;
    constexpr int kStartTime = 22 - 2; // see proc(5)
    for (int i = 0; i < kStartTime; ++i)
        fields >> field;
    std::istringstream value(field);
    double ticks = -1.0;
    value >> ticks;
    return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

Json toJson(const Phases::Times& times) {
    return {{"wall_ms", times.wallMs}, {"cpu_ms", times.cpuMs}, {"gpu_ms", times.gpuMs}};
}

} // namespace

Phases::Times timeSinceStart() {
    Phases::Times times;
    times.cpuMs = 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    timespec now{};
    clock_gettime(CLOCK_BOOTTIME, &now);
    const double start = processStart();
    const double seconds = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    if (start >= 0.0 && seconds >= start) times.wallMs = 1e3 * (seconds - start);
    return times;
}

Phases sum(Phases a, const Phases& b) {
    for (const auto& [name, times] : b.times) {
        Phases::Times& all = a.times[name];
        all.wallMs += times.wallMs;
        all.cpuMs += times.cpuMs;
        all.gpuMs += times.gpuMs;
    }
    return a;
}

Phases::Times renderTimes(const Phases& phases) {
    Phases::Times all;
    for (const char* name : {"generate", "integrate", "present", "post"}) {
        const auto found = phases.times.find(name);
        if (found == phases.times.end()) continue;
        all.wallMs += found->second.wallMs;
        all.cpuMs += found->second.cpuMs;
        all.gpuMs += found->second.gpuMs;
    }
    return all;
}

double pixelRate(const session::Session& session, double renderSeconds) {
    return renderSeconds > 0.0 ? static_cast<double>(session.statistics().pixels) / renderSeconds : 0.0;
}

Json toJson(const Measured& measured) {
    const session::Session& session = measured.session;
    const session::Statistics& statistics = session.statistics();
    const gpu::Capabilities& device = session.context().capabilities();

    Json phases = Json::object();
    for (const char* name :
         {"start", "context", "compile", "render", "generate", "integrate", "present", "post", "read", "write"}) {
        const auto found = measured.phases.times.find(name);
        phases[name] = toJson(found == measured.phases.times.end() ? Phases::Times{} : found->second);
    }
    phases["render"] = toJson(renderTimes(measured.phases));

    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    Json json = Json::object();
    json["apeiron"] = APEIRON_VERSION;
    json["device"] = device.renderer;
    json["driver"] = device.version;
    json["software"] = device.software;
    json["stage"] = std::string(toString(session.stage()));
    json["width"] = session.size().x;
    json["height"] = session.size().y;
    json["samples"] = session.samples();
    json["noise"] = session.samples() >= 2 ? Json(measured.noise) : Json(nullptr);
    json["seed"] = session.scene().output.integer("seed");
    if (const std::optional<double> scale = session.scalePower()) json["scale_power"] = *scale;
    json["wall_s"] = measured.wallSeconds;
    json["samples_per_second"] = pixelRate(session, measured.renderSeconds);
    json["phases"] = std::move(phases);
    json["pixels"] = statistics.pixels;
    json["submissions"] = statistics.submissions;
    json["longest_submission_ms"] = 1e3 * statistics.longestSubmission;
    json["peak_memory_bytes"] = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
    return json;
}

} // namespace apeiron::cli
