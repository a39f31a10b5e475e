#pragma once

#include "session/session.hpp"

namespace apeiron::cli {

/// What a rendering took, for --stats and bench.
struct Measured {
    const session::Session& session;
    Phases phases;            ///< the session's and the program's own
    double renderSeconds = 0; ///< wall time of the rendering loop [s]
    double wallSeconds = 0;   ///< from the start of the program [s]
    double noise = 0.0;       ///< render::Accumulation::noise()
};

/// Both phases' times, added up where names are the same.
Phases sum(Phases a, const Phases& b);

/// What `render` means everywhere: generate + integrate + present + post.
Phases::Times renderTimes(const Phases& phases);

/// Estimates of single pixels per second [1/s]; 0 when nothing was rendered.
double pixelRate(const session::Session& session, double renderSeconds);

/// What --stats writes.
Json toJson(const Measured& measured);

/// Time since the process was created, its processor time included: loading libraries is in it.
Phases::Times timeSinceStart();

} // namespace apeiron::cli
