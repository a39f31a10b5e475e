#include "core/file.hpp"

#include "core/error.hpp"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <unistd.h>

namespace apeiron {
namespace {

namespace fs = std::filesystem;

std::string reason(int code) {
    return std::generic_category().message(code);
}

[[noreturn]] void fail(const std::string& what, const fs::path& path, const std::string& hint = {}) {
    throw Error(ErrorKind::Io, what, path.string(), hint);
}

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

/// A name in the same folder that nobody else uses; short, because the full name may already be as long as can be.
fs::path temporaryBeside(const fs::path& path) {
    static std::atomic<unsigned> counter{0};
    fs::path name = ".apeiron-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    name += path.extension();
    return path.parent_path() / name;
}

/// Removes the temporary file unless it has taken its final name.
class TemporaryFile {
  public:
    explicit TemporaryFile(const fs::path& target) : path_(temporaryBeside(target)) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        if (!path_.empty()) fs::remove(path_, ignored);
    }

    const fs::path& path() const { return path_; }

    void moveTo(const fs::path& target) {
        std::error_code error;
        // A file that is replaced keeps its permissions, as if it had been written in place.
        if (const fs::file_status old = fs::status(target, error); fs::is_regular_file(old))
            fs::permissions(path_, old.permissions(), error);
        fs::rename(path_, target, error);
        if (error) fail("cannot be written: " + error.message(), target);
        path_.clear();
    }

  private:
    fs::path path_;
};

void requireFolder(const fs::path& path) {
    std::error_code ignored;
    if (path.filename().empty() || fs::is_directory(path, ignored)) fail("is a folder, not a file", path);
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) fail("the folder does not exist", folder, "create it first");
}

/// Devices and pipes (/dev/null, /dev/stdout) are written directly: a rename would replace them by a file.
bool isSpecial(const fs::path& path) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// The file behind a symbolic link, so that the link survives.
fs::path behindLinks(const fs::path& path) {
    std::error_code error;
    if (!fs::is_symlink(path, error)) return path;
    const fs::path target = fs::weakly_canonical(path, error);
    return error ? path : target;
}

void writeBytes(const fs::path& path, std::string_view content, const fs::path& asked) {
    File file(std::fopen(path.c_str(), "wb"));
    if (!file) fail("cannot be written: " + reason(errno), asked);
    const bool complete = std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
    const int writeError = errno;
    if (!complete) fail("cannot be written: " + reason(writeError), asked);
    // Closing flushes: a full disk may show up only here.
    if (std::fclose(file.release()) != 0) fail("cannot be written: " + reason(errno), asked);
}

} // namespace

std::string readFile(const fs::path& path, std::size_t limit) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) fail("is a folder, not a file", path);
    File file(std::fopen(path.c_str(), "rb"));
    if (!file) fail("cannot be read: " + reason(errno), path);

    // In pieces, and not by its size: pipes have none, and a file may grow meanwhile.
    std::string content;
    std::string piece(std::size_t{1} << 16, '\0');
    while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get())) {
        if (count > limit - content.size()) fail("is larger than " + std::to_string(limit) + " bytes", path);
        content.append(piece, 0, count);
    }
    if (std::ferror(file.get())) fail("cannot be read: " + reason(errno), path);
    return content;
}

void writeAtomically(const fs::path& path, const std::function<void(const fs::path& temporary)>& write) {
    requireFolder(path);
    if (isSpecial(path)) return write(path);
    const fs::path target = behindLinks(path);
    TemporaryFile temporary(target);
    write(temporary.path());
    temporary.moveTo(target);
}

void writeFile(const fs::path& path, std::string_view content) {
    requireFolder(path);
    writeAtomically(path, [&](const fs::path& temporary) { writeBytes(temporary, content, path); });
}

void requireWritable(const fs::path& path) {
    requireFolder(path);
    if (isSpecial(path)) return;
    const fs::path target = behindLinks(path);
    const TemporaryFile probe(target);
    const File file(std::fopen(probe.path().c_str(), "wb"));
    if (!file) fail("cannot be written: " + reason(errno), path);
}

} // namespace apeiron
