#include "progress_bar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sys/ioctl.h>
#include <unistd.h>

namespace apeiron::cli {
namespace {

constexpr double kInterval = 0.1; // [s]

int terminalWidth() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// `width` columns of blocks; the last one grows in eighths.
std::string bar(double fraction, int width) {
    static constexpr const char* kEighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
    const int eighths = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 8.0 * width);
    const int full = eighths / 8;
    std::string text;
    for (int i = 0; i < full; ++i)
        text += "█";
    text += kEighths[eighths % 8];
    text.append(static_cast<std::size_t>(width - full - (eighths % 8 > 0 ? 1 : 0)), ' ');
    return text;
}

std::string duration(double seconds) {
    const auto s = static_cast<long>(std::ceil(std::min(seconds, 1e9)));
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
    return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

std::string rate(double perSecond) {
    return perSecond < 10.0 ? fmt::format("{:.2f}/s", perSecond) : fmt::format("{:.0f}/s", perSecond);
}

} // namespace

std::string ProgressBar::line(const Progress& progress, int width) {
    const double bySamples = progress.total > 0 ? progress.samples / static_cast<double>(progress.total) : 0.0;
    const double byTime = progress.timeLimit > 0.0 ? progress.seconds / progress.timeLimit : 0.0;
    const double fraction = std::min(std::max(bySamples, byTime), 1.0);
    const bool hasGoal = progress.total > 0 || progress.timeLimit > 0.0;

    const auto done = static_cast<std::int64_t>(progress.samples);
    std::string text =
        progress.total > 0 ? fmt::format("{}/{} samples", done, progress.total) : fmt::format("{} samples", done);
    if (progress.seconds > 0.0) text += "  " + rate(progress.samples / progress.seconds);
    if (!hasGoal) {
        text += "  " + duration(progress.seconds);
    } else if (fraction > 0.0) {
        text += fmt::format("  {} left", duration(progress.seconds * (1.0 / fraction - 1.0)));
    }
    if (hasGoal) {
        const std::string percent = fmt::format("{:3.0f} % ", 100.0 * fraction);
        const int room = std::min(width - static_cast<int>(percent.size() + text.size()) - 4, 40);
        text = percent + (room >= 4 ? fmt::format("▕{}▏ ", bar(fraction, room)) : "") + text;
        if (room >= 4) return text;
    }
    return text.substr(0, static_cast<std::size_t>(std::max(width - 1, 0)));
}

ProgressBar::ProgressBar(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void ProgressBar::update(const Progress& progress) {
    if (!shown_ || watch_.seconds() < next_) return;
    next_ = watch_.seconds() + kInterval;
    drawn_ = true;
    fmt::print(stderr, "\r{}\x1b[K", line(progress, terminalWidth()));
    std::fflush(stderr);
}

} // namespace apeiron::cli
