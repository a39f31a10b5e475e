#include "volume/source.hpp"

#include "core/error.hpp"

#include <map>
#include <system_error>

namespace apeiron::volume {
namespace {

/// What was loaded, and of which state of the file.
struct Loaded {
    VolumeRequest request;
    std::filesystem::file_time_type written;
    std::weak_ptr<const Volume> volume;
};

struct Sources {
    VolumeLoader loader;
    VolumeOpener opener;
    std::map<std::string, std::shared_ptr<const Volume>> provided;
    std::vector<Loaded> loaded;
    std::shared_ptr<const Volume> latest;
};

Sources& sources() {
    static Sources all;
    return all;
}

std::filesystem::file_time_type lastWritten(const std::filesystem::path& path) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(path, error);
    return error ? std::filesystem::file_time_type{} : time;
}

} // namespace

void setVolumeLoader(VolumeLoader loader, VolumeOpener opener) {
    Sources& all = sources();
    all.loader = std::move(loader);
    all.opener = std::move(opener);
    all.loaded.clear();
    all.latest.reset();
}

void provideVolume(const std::string& name, std::shared_ptr<const Volume> volume) {
    if (volume == nullptr) {
        sources().provided.erase(name);
    } else {
        sources().provided[name] = std::move(volume);
    }
}

std::shared_ptr<const Volume> loadVolume(const VolumeRequest& request) {
    Sources& all = sources();
    if (const auto found = all.provided.find(request.file.string()); found != all.provided.end()) return found->second;
    if (request.file.empty()) throw Error(ErrorKind::BadInput, "no file is named");

    const auto written = lastWritten(request.file);
    auto kept = all.loaded.begin();
    while (kept != all.loaded.end()) {
        std::shared_ptr<const Volume> volume = kept->volume.lock();
        if (volume == nullptr) {
            kept = all.loaded.erase(kept);
        } else if (kept->request == request && kept->written == written) {
            all.latest = volume;
            return volume;
        } else {
            ++kept;
        }
    }

    if (!all.loader)
        throw Error(ErrorKind::BadInput, "files of volumes cannot be read here", request.file.string(),
                    "choose a generated volume");
    // Two large volumes at once may be one too many.
    all.latest.reset();
    auto volume = std::make_shared<const Volume>(all.loader(request));
    all.loaded.push_back({request, written, volume});
    all.latest = volume;
    return volume;
}

std::optional<LargeVolume> openVolume(const VolumeRequest& request) {
    const Sources& all = sources();
    if (!all.opener || all.provided.count(request.file.string()) != 0) return std::nullopt;
    return all.opener(request);
}

} // namespace apeiron::volume
