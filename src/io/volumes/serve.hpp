#pragma once

#include "volume/source.hpp"

#include <filesystem>

// What the reader's process does. It is a process of its own, since libraries for file formats crash, loop and ask for
// all memory when a file is damaged.
namespace apeiron::io::volumes {

/// How a reader's process ends.
enum class Ending {
    Sent = 0,    ///< a volume, or an error
    Unheard = 1, ///< nobody listens any more
    Crashed = 3, ///< a library did; an error was sent
    TooLong = 4, ///< the limit of time was reached; an error was sent
};

/// What a reader may take.
struct Limits {
    std::size_t voxels = 0; ///< bytes of them
    unsigned seconds = 20;  ///< of a processor; ten times as much by the clock
};

/// Reads what is requested and sends it (see io/volume_stream.hpp) to a file descriptor. Limits the memory and time of
/// this process, and takes over its signals: when a library crashes, an error that names the file is sent. The process
/// has to end then.
Ending serve(const volume::VolumeRequest& request, const Limits& limits, int to);

/// The file that is to blame when a library crashes from now on. No effect outside serve().
void blame(const std::filesystem::path& file);

} // namespace apeiron::io::volumes
