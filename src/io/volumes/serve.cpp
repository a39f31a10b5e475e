#include "io/volumes/serve.hpp"

#include "core/error.hpp"
#include "io/volume_stream.hpp"
#include "io/volumes/volumes.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace apeiron::io::volumes {
namespace {

/// An error as it is sent, ready to be written by a signal handler.
struct LastWords {
    std::array<char, 4096> bytes{};
    std::size_t size = 0;

    void set(const std::string& what) {
        char* text = nullptr;
        std::size_t length = 0;
        std::FILE* stream = open_memstream(&text, &length);
        if (stream == nullptr) return;
        sendError(stream, Error(ErrorKind::Io, what));
        std::fclose(stream);
        if (length <= bytes.size()) {
            std::memcpy(bytes.data(), text, length);
            size = length;
        }
        std::free(text);
    }
};

LastWords ifCrashed;
LastWords ifTooLong;
int listener = -1;
/// Once voxels are on their way, nothing else may come between them.
std::atomic<bool> sending{false};

void endOn(int signal) {
    const bool late = signal == SIGXCPU || signal == SIGALRM;
    const LastWords& words = late ? ifTooLong : ifCrashed;
    if (listener >= 0 && !sending) [[maybe_unused]]
        const ssize_t ignored = ::write(listener, words.bytes.data(), words.size);
    _exit(static_cast<int>(late ? Ending::TooLong : Ending::Crashed));
}

void takeSignals() {
    // A handler needs a stack of its own where it was the stack that ran over.
    static std::array<char, 65536> stack;
    const stack_t own{stack.data(), 0, stack.size()};
    sigaltstack(&own, nullptr);
    struct sigaction action {};
    action.sa_handler = endOn;
    action.sa_flags = SA_ONSTACK | SA_RESETHAND;
    sigaction(SIGXCPU, &action, nullptr);
    sigaction(SIGALRM, &action, nullptr);
#if !defined(__SANITIZE_ADDRESS__) // which wants to tell by itself
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL})
        sigaction(signal, &action, nullptr);
#endif
}

void limitProcess(const Limits& limits) {
#if !defined(__SANITIZE_ADDRESS__)
    // However a file lies: three copies of the voxels at most, and the libraries themselves.
    const rlim_t most = 3 * static_cast<rlim_t>(limits.voxels) + (rlim_t{1} << 30);
    const rlimit memory{most, most};
    setrlimit(RLIMIT_AS, &memory);
#endif
    const rlimit time{limits.seconds, limits.seconds + 5};
    setrlimit(RLIMIT_CPU, &time);
    alarm(10 * limits.seconds);
    const rlimit core{0, 0};
    setrlimit(RLIMIT_CORE, &core);
}

} // namespace

void blame(const std::filesystem::path& file) {
    if (listener < 0) return;
    const std::string name = inQuotes(file.filename().string());
    ifCrashed.set(fmt::format("{} is damaged: the library that reads it gave up", name));
    ifTooLong.set(fmt::format("{} takes too long to read: it is damaged", name));
}

Ending serve(const volume::VolumeRequest& request, const Limits& limits, int to) {
    listener = to;
    blame(request.file);
    takeSignals();
    limitProcess(limits);
    std::FILE* out = ::fdopen(to, "wb");
    if (out == nullptr) return Ending::Unheard;
    bool sent = false;
    try {
        const volume::Volume volume = read(request, limits.voxels);
        sending = true;
        sent = sendVolume(out, volume);
    } catch (const Error& error) {
        sending = true;
        sent = sendError(out, error);
    }
    return sent ? Ending::Sent : Ending::Unheard;
}

} // namespace apeiron::io::volumes
