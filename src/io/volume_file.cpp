#include "io/volume_file.hpp"

#include "core/error.hpp"
#include "io/volume_kind.hpp"
#include "io/volume_parts.hpp"
#include "io/volume_stream.hpp"
#include "volume/raw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace apeiron::io {
namespace {

namespace fs = std::filesystem;
using volume::Volume;
using volume::VolumeRequest;

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

Volume readRaw(const VolumeRequest& request) {
    const volume::RawForm form = volume::parseRawForm(request.raw);
    const std::string where = request.file.string();
    std::error_code error;
    const std::uintmax_t there = fs::file_size(request.file, error);
    if (error) throw Error(ErrorKind::Io, "cannot be read: " + error.message(), where);
    try {
        const std::uint64_t wanted = form.offset + volume::byteSize(form, memoryFor(request));
        if (there < wanted)
            throw Error(ErrorKind::BadInput, fmt::format("has {} bytes, and {} needs {}", there, request.raw, wanted));
        Volume volume = volume::makeVolume(form, memoryFor(request));
        const File file(std::fopen(request.file.c_str(), "rb"));
        if (!file || fseeko(file.get(), static_cast<off_t>(form.offset), SEEK_SET) != 0 ||
            std::fread(volume.voxels.data(), 1, volume.voxels.size(), file.get()) != volume.voxels.size())
            throw Error(ErrorKind::Io, "cannot be read: " + std::generic_category().message(errno));
        volume::toNativeOrder(volume, form);
        if (there > wanted)
            volume.messages.push_back(fmt::format("{} bytes behind the voxels were left out", there - wanted));
        volume.name = where;
        return volume;
    } catch (const Error& problem) {
        throw problem.at(where);
    }
}

/// How long reading may take [s]: no disk and no library is that slow.
unsigned timeLimit(const VolumeRequest& request) {
    constexpr double kLeast = 20;
    constexpr double kBytesPerSecond = 1e6;
    std::error_code error;
    double bytes = 0;
    if (fs::is_directory(request.file, error)) {
        for (fs::directory_iterator entry(request.file, error), end; !error && entry != end; entry.increment(error)) {
            std::error_code ignored;
            const std::uintmax_t size = fs::file_size(entry->path(), ignored);
            if (!ignored) bytes += static_cast<double>(size);
        }
    } else {
        bytes = static_cast<double>(fs::file_size(request.file, error));
    }
    return static_cast<unsigned>(std::min(kLeast + bytes / kBytesPerSecond, 1e5));
}

/// The program that reads: beside ours, or where the build put it.
fs::path readerProgram() {
    std::error_code ignored;
    const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path() / "apeiron-reader";
    for (const fs::path& path : {beside, fs::path(APEIRON_READER)})
        if (::access(path.c_str(), X_OK) == 0) return path;
    throw Error(ErrorKind::Io, "the program that reads volumes is missing", beside.string(),
                "build or install apeiron-reader");
}

/// A running reader, which is waited for in any case.
class Reader {
  public:
    Reader(const fs::path& program, const VolumeRequest& request, std::size_t limit) {
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail(errno);
        from_.reset(::fdopen(ends[0], "rb"));
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        // Libraries' own chatter goes nowhere; what matters comes through the pipe.
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        std::array<std::string, 5> texts{program.string(), request.file.string(), request.grid, std::to_string(limit),
                                         std::to_string(timeLimit(request))};
        std::array<char*, 6> arguments{texts[0].data(), texts[1].data(), texts[2].data(),
                                       texts[3].data(), texts[4].data(), nullptr};
        const int code = ::posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        if (code != 0) fail(code);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() {
        from_.reset(); // a reader that still writes is stopped by that
        if (process_ > 0) ::waitpid(process_, nullptr, 0);
    }

    std::FILE* from() const { return from_.get(); }

  private:
    [[noreturn]] static void fail(int code) {
        throw Error(ErrorKind::Io,
                    "the program that reads volumes cannot be started: " + std::generic_category().message(code));
    }

    File from_;
    pid_t process_ = -1;
};

} // namespace

std::size_t availableMemory() {
    std::ifstream file("/proc/meminfo");
    std::string name;
    std::size_t kilobytes = 0;
    std::string unit;
    while (file >> name >> kilobytes && std::getline(file, unit))
        if (name == "MemAvailable:") return kilobytes * 1024;
    return std::size_t{4} << 30;
}

std::size_t memoryFor(const VolumeRequest& request) {
    // Something is left for everything else, and for the copy on the GPU.
    return request.memory != 0 ? request.memory : availableMemory() / 10 * 8;
}

Volume readVolume(const VolumeRequest& request) {
    const std::string where = request.file.string();
    std::error_code error;
    if (!fs::exists(request.file, error)) throw Error(ErrorKind::Io, "there is no such file", where);
    if (!request.raw.empty()) return readRaw(request);
    if (fs::is_regular_file(request.file, error) && !volumeKind(request.file))
        throw Error(ErrorKind::Io, "is no volume that can be read", where,
                    "known: NRRD, MetaImage, NIfTI, DICOM, TIFF, OpenVDB; of bare voxels say the form");
    const std::size_t limit = memoryFor(request);
    const Reader reader(readerProgram(), request, limit);
    try {
        return receiveVolume(reader.from(), limit);
    } catch (const Error& problem) {
        throw problem.at(where);
    }
}

bool isVolume(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored) || volumeKind(path).has_value();
}

void registerVolumeFiles() {
    volume::setVolumeLoader(readVolume, openVolume);
}

} // namespace apeiron::io
