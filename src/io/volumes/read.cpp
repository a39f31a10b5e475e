#include "core/error.hpp"
#include "io/volumes/volumes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <system_error>

namespace apeiron::io::volumes {
namespace {

namespace fs = std::filesystem;
using volume::Volume;

/// "slice2" before "slice10": numbers in names count as numbers.
bool naturalLess(const fs::path& pathA, const fs::path& pathB) {
    const std::string a = pathA.filename().string();
    const std::string b = pathB.filename().string();
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (!isDigit(a[i]) || !isDigit(b[j])) {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
            continue;
        }
        const auto number = [&isDigit](const std::string& text, std::size_t& at) {
            while (at + 1 < text.size() && text[at] == '0' && isDigit(text[at + 1]))
                ++at;
            const std::size_t begin = at;
            while (at < text.size() && isDigit(text[at]))
                ++at;
            return text.substr(begin, at - begin);
        };
        const std::string x = number(a, i);
        const std::string y = number(b, j);
        if (x.size() != y.size()) return x.size() < y.size();
        if (x != y) return x < y;
    }
    return a.size() - i < b.size() - j;
}

/// A folder is a series of DICOM files, or else a stack of TIFF files.
Volume readFolder(const fs::path& folder, std::size_t limit) {
    constexpr std::size_t kMostFiles = 100'000;
    std::vector<fs::path> dicom;
    std::vector<fs::path> tiff;
    std::error_code error;
    std::size_t count = 0;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (++count > kMostFiles) throw Error(ErrorKind::Io, fmt::format("holds more than {} files", kMostFiles));
        const std::optional<VolumeKind> kind = volumeKind(entry->path());
        if (kind == VolumeKind::Dicom) dicom.push_back(entry->path());
        if (kind == VolumeKind::Tiff) tiff.push_back(entry->path());
    }
    if (error) throw Error(ErrorKind::Io, "cannot be read: " + error.message());
    if (!dicom.empty()) {
        std::sort(dicom.begin(), dicom.end(), naturalLess);
        return readDicom(dicom, limit);
    }
    if (tiff.empty()) throw Error(ErrorKind::Io, "is a folder without DICOM or TIFF files");
    std::sort(tiff.begin(), tiff.end(), naturalLess);
    return readTiff(tiff, limit);
}

Volume readFile(const volume::VolumeRequest& request, std::size_t limit) {
    const std::optional<VolumeKind> kind = volumeKind(request.file);
    if (!kind) throw Error(ErrorKind::Io, "is no volume that can be read");
    switch (*kind) {
    case VolumeKind::Dicom:
        return readDicom({request.file}, limit);
    case VolumeKind::Tiff:
        return readTiff({request.file}, limit);
    case VolumeKind::OpenVdb:
        return readVdb(request.file, request.grid, limit);
    default:
        return readItk(request.file, *kind, limit);
    }
}

} // namespace

std::string inOneLine(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    // Of what is written over many lines the last one says it.
    text = text.substr(text.rfind('\n') + 1);
    constexpr std::size_t kLongest = 200;
    if (text.size() > kLongest) text = text.substr(0, kLongest) + " ...";
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7F; }, '?');
    return text;
}

Volume read(const volume::VolumeRequest& request, std::size_t limit) {
    try {
        std::error_code ignored;
        Volume volume =
            fs::is_directory(request.file, ignored) ? readFolder(request.file, limit) : readFile(request, limit);
        volume.name = request.file.string();
        return volume;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::Io, "asks for more memory than there is");
    } catch (const std::length_error&) {
        throw Error(ErrorKind::Io, "asks for more memory than there is");
    } catch (const std::exception& error) {
        throw Error(ErrorKind::Io, "is damaged: " + inOneLine(error.what()));
    } catch (...) {
        throw Error(ErrorKind::Io, "is damaged");
    }
}

} // namespace apeiron::io::volumes
