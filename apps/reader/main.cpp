#include "io/volumes/serve.hpp"

#include <cstdlib>
#include <fcntl.h>
#include <unistd.h>

// apeiron-reader FILE GRID BYTES SECONDS: reads a volume and writes it to standard output for io::readVolume(), whose
// helper it is. BYTES and SECONDS are what it may take.
int main(int argc, char** argv) {
    using namespace apeiron;
    if (argc != 5) return 2;
    const std::size_t bytes = std::strtoull(argv[3], nullptr, 10);
    const auto seconds = static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10));
    // Libraries may print: that must not get into the voxels.
    const int out = dup(STDOUT_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY);
    if (out < 0 || nowhere < 0) return 1;
    dup2(nowhere, STDOUT_FILENO);
    return static_cast<int>(io::volumes::serve({argv[1], {}, argv[2], 0}, {bytes, seconds}, out));
}
