#pragma once

namespace apeiron::cli {

/// Turns the first SIGINT or SIGTERM into a request to stop, while it lives. A second one ends the program as usual.
class Interrupt {
  public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool requested() const;
};

} // namespace apeiron::cli
