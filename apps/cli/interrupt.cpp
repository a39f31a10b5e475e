#include "interrupt.hpp"

#include <csignal>

namespace apeiron::cli {
namespace {

volatile std::sig_atomic_t stopRequested = 0;

constexpr int kSignals[] = {SIGINT, SIGTERM};

void onSignal(int /*signal*/) {
    stopRequested = 1;
    for (const int signal : kSignals)
        std::signal(signal, SIG_DFL);
}

} // namespace

Interrupt::Interrupt() {
    stopRequested = 0;
    // Also where SIGINT was ignored, as in the background of a script: a rendering should always be stoppable.
    for (const int signal : kSignals) {
        struct sigaction action = {};
        action.sa_handler = onSignal;
        action.sa_flags = SA_RESTART;
        sigaction(signal, &action, nullptr);
    }
}

Interrupt::~Interrupt() {
    for (const int signal : kSignals)
        std::signal(signal, SIG_DFL);
}

bool Interrupt::requested() const {
    return stopRequested != 0;
}

} // namespace apeiron::cli
