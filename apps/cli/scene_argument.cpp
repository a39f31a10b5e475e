#include "scene_argument.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "core/resources.hpp"
#include "core/suggest.hpp"
#include "io/image_file.hpp"
#include "io/volume_file.hpp"
#include "session/session.hpp"
#include "session/volume_scene.hpp"

#include <fmt/format.h>

#include <system_error>

namespace apeiron::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFolder = "scenes/";
constexpr std::string_view kExtension = ".json";

/// Gallery names have neither folder nor extension; `./name` is always a file.
bool looksLikeName(const std::string& argument) {
    return argument.find('/') == std::string::npos && argument.find('.') == std::string::npos;
}

scene::Scene loadFromStandardInput() {
    std::string text;
    try {
        text = readFile("/dev/stdin");
    } catch (const Error&) {
        throw Error(ErrorKind::Io, "standard input cannot be read");
    }
    return scene::Scene::parse(session::catalogue(), "standard input", text, fs::current_path());
}

} // namespace

std::vector<std::string> galleryNames() {
    std::vector<std::string> names;
    for (const Resource& resource : resources()) {
        std::string_view path = resource.path;
        if (!path.starts_with(kFolder) || !path.ends_with(kExtension)) continue;
        path.remove_prefix(kFolder.size());
        path.remove_suffix(kExtension.size());
        names.emplace_back(path);
    }
    return names;
}

scene::Scene parseScene(const std::string& file, const std::string& text) {
    return scene::Scene::parse(session::catalogue(), file, text, fs::path(file).parent_path());
}

scene::Scene loadScene(const std::string& argument) {
    if (argument == "-") return loadFromStandardInput();
    if (argument.empty()) throw Error(ErrorKind::BadInput, "the scene's name is empty");
    std::error_code ignored;
    if (looksLikeName(argument)) {
        const auto resource = findResource(fmt::format("{}{}{}", kFolder, argument, kExtension));
        if (resource) return parseScene(std::string(resource->path), std::string(resource->text));
        if (!fs::is_regular_file(argument, ignored))
            throw Error(ErrorKind::BadInput, "no file and no gallery scene is called " + inQuotes(argument), {},
                        suggestion(argument, galleryNames()));
    }
    if (fs::status(argument, ignored).type() == fs::file_type::not_found)
        throw Error(ErrorKind::Io, "there is no such file", argument);
    if (io::isVolume(argument)) {
        const fs::path file(argument);
        return session::volumeScene(file.is_absolute() ? argument : "./" + argument, file.filename().string());
    }
    const bool picture = io::detectImageFormat(argument).has_value();
    return parseScene(argument, picture ? io::readScene(argument) : readFile(argument));
}

} // namespace apeiron::cli
