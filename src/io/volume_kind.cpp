#include "io/volume_kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

namespace apeiron::io {
namespace {

namespace fs = std::filesystem;

bool isTiff(std::string_view begin) {
    using namespace std::string_view_literals;
    return begin.starts_with("II*\0"sv) || begin.starts_with("MM\0*"sv) || begin.starts_with("II+\0"sv) ||
           begin.starts_with("MM\0+"sv);
}

bool isNifti(std::string_view begin, const std::string& name) {
    using namespace std::string_view_literals;
    if (begin.starts_with("\x1f\x8b"))
        return name.ends_with(".nii.gz") || name.ends_with(".hdr.gz") || name.ends_with(".img.gz");
    if (begin.size() >= 348) {
        const std::string_view magic = begin.substr(344, 4);
        if (magic == "n+1\0"sv || magic == "ni1\0"sv) return true;
    }
    return begin.size() >= 8 && (begin.substr(4, 4) == "n+2\0"sv || begin.substr(4, 4) == "ni2\0"sv);
}

bool isMetaImage(std::string_view begin, const std::string& name) {
    const bool named = name.ends_with(".mhd") || name.ends_with(".mha");
    return begin.starts_with("ObjectType") || (named && begin.find("NDims") != std::string_view::npos);
}

} // namespace

std::optional<VolumeKind> volumeKind(const fs::path& file) {
    using namespace std::string_view_literals;
    std::error_code ignored;
    // A pipe's first bytes could not be put back.
    if (!fs::is_regular_file(file, ignored)) return std::nullopt;
    std::FILE* stream = std::fopen(file.c_str(), "rb");
    if (stream == nullptr) return std::nullopt;
    std::array<char, 512> bytes{};
    const std::string_view begin(bytes.data(), std::fread(bytes.data(), 1, bytes.size(), stream));
    std::fclose(stream);
    std::string name = file.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });

    if (begin.starts_with("NRRD000")) return VolumeKind::Nrrd;
    if (begin.starts_with(" BDV\0\0\0\0"sv)) return VolumeKind::OpenVdb;
    if (isTiff(begin)) return VolumeKind::Tiff;
    if (begin.size() >= 132 && begin.substr(128, 4) == "DICM") return VolumeKind::Dicom;
    if (isNifti(begin, name)) return VolumeKind::Nifti;
    if (isMetaImage(begin, name)) return VolumeKind::MetaImage;
    return std::nullopt;
}

} // namespace apeiron::io
