#include "io/volume_stream.hpp"
#include "io/volumes/volumes.hpp"

#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

// apeiron-reader FILE GRID LIMIT: reads a volume and writes it to standard output for io::readVolume(), whose helper it
// is. A process of its own, since libraries for file formats may crash or ask for all memory when a file is damaged.
namespace {

/// However a file lies, no more than this is taken: three copies of the voxels at most, and the libraries themselves.
void limitMemory(std::size_t voxels) {
#if !defined(__SANITIZE_ADDRESS__)
    const rlim_t most = 3 * static_cast<rlim_t>(voxels) + (rlim_t{1} << 30);
    const rlimit memory{most, most};
    setrlimit(RLIMIT_AS, &memory);
#else
    static_cast<void>(voxels);
#endif
    constexpr rlim_t kSeconds = 600;
    const rlimit time{kSeconds, kSeconds};
    setrlimit(RLIMIT_CPU, &time);
    const rlimit core{0, 0};
    setrlimit(RLIMIT_CORE, &core);
}

} // namespace

int main(int argc, char** argv) {
    using namespace apeiron;
    if (argc != 4) return 2;
    const std::size_t limit = std::strtoull(argv[3], nullptr, 10);
    limitMemory(limit);
    // Libraries may print: that must not get into the voxels.
    std::FILE* out = fdopen(dup(STDOUT_FILENO), "wb");
    const int nowhere = open("/dev/null", O_WRONLY);
    if (out == nullptr || nowhere < 0) return 1;
    dup2(nowhere, STDOUT_FILENO);
    bool sent = false;
    try {
        const volume::Volume volume = io::volumes::read({argv[1], {}, argv[2], 0}, limit);
        sent = io::sendVolume(out, volume);
    } catch (const Error& error) {
        sent = io::sendError(out, error);
    } catch (const std::exception& error) {
        sent = io::sendError(out, Error(ErrorKind::Io, error.what()));
    }
    return sent ? 0 : 1;
}
