#include "io/volumes/whole.hpp"

#include "core/error.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace apeiron::io::volumes {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Io, what);
}

/// A MetaImage's header: "Key = Value" lines, of which ElementDataFile is the last one.
struct MetaHeader {
    std::map<std::string, std::string> values;
    std::uintmax_t end = 0; ///< where the voxels begin, or the names of their files
};

std::string trimmed(const std::string& text) {
    constexpr const char* kSpace = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(kSpace);
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

MetaHeader metaHeader(const fs::path& file) {
    constexpr int kMostLines = 1000;
    constexpr std::streamsize kLongestLine = 16'384;
    std::ifstream stream(file, std::ios::binary);
    std::vector<char> buffer(kLongestLine);
    MetaHeader header;
    for (int i = 0; i < kMostLines; ++i) {
        if (!stream.getline(buffer.data(), kLongestLine)) break;
        const std::string line(buffer.data());
        const std::size_t sign = line.find_first_of("=:");
        if (trimmed(line).empty()) continue;
        const std::string key = trimmed(line.substr(0, sign));
        if (sign == std::string::npos || key.empty())
            fail(fmt::format("line {} of its header is no \"Key = Value\": it is damaged", i + 1));
        header.values[key] = trimmed(line.substr(sign + 1));
        if (key != "ElementDataFile") continue;
        header.end = stream.eof() ? fs::file_size(file) : static_cast<std::uintmax_t>(stream.tellg());
        return header;
    }
    fail("its header has no ElementDataFile: it is damaged");
}

/// All numbers of a value. @throws Error where it is not `count` of them.
std::vector<double> numbersOf(const MetaHeader& header, const std::string& key, std::size_t count) {
    std::istringstream words(header.values.at(key));
    std::vector<double> numbers;
    for (std::string word; words >> word && numbers.size() <= count;) {
        char* end = nullptr;
        numbers.push_back(std::strtod(word.c_str(), &end));
        if (*end != '\0') fail(fmt::format("{} in its header is no number: {}", key, inQuotes(word)));
    }
    if (numbers.size() != count)
        fail(fmt::format("{} in its header has {} instead of {} numbers: it is damaged", key,
                         numbers.size() > count ? "more" : std::to_string(numbers.size()), count));
    return numbers;
}

void requireWhole(const MetaHeader& header, const std::string& key, double least, double most) {
    if (header.values.count(key) == 0) return;
    const double number = numbersOf(header, key, 1).front();
    if (!(number >= least && number <= most) || number != static_cast<double>(static_cast<std::int64_t>(number)))
        fail(fmt::format("{} = {} in its header cannot be", key, inQuotes(header.values.at(key))));
}

bool isTrue(const MetaHeader& header, const std::string& key) {
    const auto found = header.values.find(key);
    return found != header.values.end() && !found->second.empty() &&
           std::string_view("Tt1Yy").find(found->second.front()) != std::string_view::npos;
}

std::uintmax_t sizeOf(const fs::path& file) {
    std::error_code error;
    // A pipe or a device would be waited for.
    if (!fs::is_regular_file(file, error))
        fail(fmt::format("its voxels' file {} is not there", inQuotes(file.string())));
    return fs::file_size(file, error);
}

[[noreturn]] void tooShort(std::uintmax_t wanted, std::uintmax_t there) {
    fail(fmt::format("its header promises {} bytes of voxels, and there are {}: it is damaged", wanted, there));
}

/// The files of a header that names several: a list of them behind it, or a pattern with first and last number and
/// step.
std::vector<fs::path> metaFiles(const fs::path& file, const MetaHeader& header) {
    const std::string& name = header.values.at("ElementDataFile");
    const fs::path folder = file.parent_path();
    if (!name.starts_with("LIST")) {
        if (name.find('%') != std::string::npos)
            fail("its voxels are in files named by a pattern, which is not understood; list them (ElementDataFile = "
                 "LIST)");
        return {folder / name};
    }
    constexpr std::size_t kMostFiles = 100'000;
    std::vector<fs::path> files;
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(header.end));
    for (std::string line; files.size() < kMostFiles && std::getline(stream, line);)
        if (!trimmed(line).empty()) files.push_back(folder / trimmed(line));
    return files;
}

/// How many bytes a zlib or gzip stream that begins somewhere in a file gives, if it is no more than `most`.
std::uintmax_t inflatedSize(const fs::path& file, std::uintmax_t begin, std::uintmax_t most) {
    std::ifstream input(file, std::ios::binary);
    input.seekg(static_cast<std::streamoff>(begin));
    std::vector<Bytef> packed(std::size_t{1} << 16);
    std::vector<Bytef> plain(std::size_t{1} << 18);
    z_stream stream{};
    constexpr int kEitherKind = 32 + MAX_WBITS;
    if (inflateInit2(&stream, kEitherKind) != Z_OK) throw std::bad_alloc();
    std::uintmax_t size = 0;
    int state = Z_OK;
    while (state == Z_OK && size < most) {
        if (stream.avail_in == 0) {
            input.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
            stream.avail_in = static_cast<uInt>(input.gcount());
            stream.next_in = packed.data();
            if (stream.avail_in == 0) break;
        }
        stream.avail_out = static_cast<uInt>(plain.size());
        stream.next_out = plain.data();
        state = inflate(&stream, Z_NO_FLUSH);
        size += plain.size() - stream.avail_out;
    }
    inflateEnd(&stream);
    return size;
}

/// How many words are behind a place of a file, if no more than `most`.
std::uintmax_t wordsBehind(const fs::path& file, std::uintmax_t begin, std::uintmax_t most) {
    std::ifstream input(file, std::ios::binary);
    input.seekg(static_cast<std::streamoff>(begin));
    std::uintmax_t count = 0;
    for (std::string word; count < most && input >> word;)
        ++count;
    return count;
}

/// Unsigned numbers of a binary file, in its byte order. Beyond the file's end there are none.
class Numbers {
  public:
    explicit Numbers(const fs::path& file) : stream_(file, std::ios::binary) {}
    bool bigEndian = false;

    std::optional<std::uint64_t> at(std::uint64_t place, std::size_t width) {
        std::array<unsigned char, 8> bytes{};
        stream_.clear();
        if (place > std::uint64_t{1} << 62 || !stream_.seekg(static_cast<std::streamoff>(place)) ||
            !stream_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(width)))
            return std::nullopt;
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < width; ++i)
            number |= static_cast<std::uint64_t>(bytes[i]) << (8 * (bigEndian ? width - 1 - i : i));
        return number;
    }

  private:
    std::ifstream stream_;
};

struct Close {
    void operator()(gzFile file) const { gzclose(file); }
};

using GzipStream = std::unique_ptr<std::remove_pointer_t<gzFile>, Close>;

/// A NIfTI file's header, of version 1 or 2, in either byte order.
class NiftiHeader {
  public:
    explicit NiftiHeader(gzFile stream) {
        const auto read = [&](std::size_t begin, std::size_t end) {
            const auto size = static_cast<unsigned>(end - begin);
            if (gzread(stream, bytes_.data() + begin, size) != static_cast<int>(size)) fail("its header is cut off");
        };
        read(0, kFirst);
        std::int32_t size = 0;
        std::memcpy(&size, bytes_.data(), sizeof size);
        isSecond_ = size == kSecond || size == 0x1C020000;
        isTurned_ = size != kSecond && size != kFirst;
        if (isSecond_) read(kFirst, kSecond);
    }

    template <class T> T at(std::size_t place) const {
        std::array<char, sizeof(T)> part{};
        std::memcpy(part.data(), bytes_.data() + place, sizeof(T));
        if (isTurned_) std::reverse(part.begin(), part.end());
        T number{};
        std::memcpy(&number, part.data(), sizeof(T));
        return number;
    }
    /// The n-th real number from a place on, which depends on the version.
    double real(std::size_t first, std::size_t second, std::size_t n) const {
        return isSecond_ ? at<double>(second + 8 * n) : static_cast<double>(at<float>(first + 4 * n));
    }
    bool isSecond() const { return isSecond_; }
    std::size_t size() const { return isSecond_ ? kSecond : kFirst; }

  private:
    static constexpr int kFirst = 348;
    static constexpr int kSecond = 540;
    std::array<char, kSecond> bytes_{};
    bool isSecond_ = false;
    bool isTurned_ = false;
};

GzipStream openedGzip(const fs::path& file) {
    // Reads plain files as they are, too.
    GzipStream stream(gzopen(file.c_str(), "rb"));
    if (!stream) fail("cannot be read");
    return stream;
}

/// Bits of a voxel's component in the file: scaled numbers come out of ITK in another type than they are stored in.
std::uintmax_t niftiBits(const NiftiHeader& header, std::size_t components) {
    const int type = header.at<std::int16_t>(header.isSecond() ? 12 : 70);
    const int bits = header.at<std::int16_t>(header.isSecond() ? 14 : 72);
    if (bits < 8 || bits > 256) fail("its voxels are of a type that is not understood");
    // RGB, RGBA and complex numbers are counted as one.
    constexpr std::array kWhole{128, 2304, 32, 1792, 2048};
    const bool whole = std::find(kWhole.begin(), kWhole.end(), type) != kWhole.end();
    return static_cast<std::uintmax_t>(bits) * (whole ? 1 : components);
}

} // namespace

void requireMetaHeader(const fs::path& file) {
    const MetaHeader header = metaHeader(file);
    for (const char* needed : {"NDims", "DimSize", "ElementType"})
        if (header.values.count(needed) == 0) fail(fmt::format("its header has no {}: it is damaged", needed));
    constexpr double kMostDimensions = 10; // of MetaIO's arrays
    requireWhole(header, "NDims", 1, kMostDimensions);
    const auto dimensions = static_cast<std::size_t>(numbersOf(header, "NDims", 1).front());
    for (const double edge : numbersOf(header, "DimSize", dimensions))
        if (!(edge >= 1 && edge <= 2147483647.0)) fail("its header says that it is empty: it is damaged");
    for (const char* key : {"Offset", "Position", "Origin", "ElementSpacing", "ElementSize", "CenterOfRotation"})
        if (header.values.count(key) > 0) numbersOf(header, key, dimensions);
    for (const char* key : {"TransformMatrix", "Rotation", "Orientation"})
        if (header.values.count(key) > 0) numbersOf(header, key, dimensions * dimensions);
    requireWhole(header, "ElementNumberOfChannels", 1, 1e6);
    requireWhole(header, "HeaderSize", -1, 1e15);
    requireWhole(header, "CompressedDataSize", 0, 1e15);
    if (!header.values.at("ElementType").starts_with("MET_")) fail("its ElementType is not known");
    const std::string& name = header.values.at("ElementDataFile");
    if (name.empty()) fail("its ElementDataFile is empty: it is damaged");
}

void requireMetaVoxels(const fs::path& file, std::size_t elements, std::size_t width) {
    const MetaHeader header = metaHeader(file);
    const std::string& name = header.values.at("ElementDataFile");
    const bool local = name == "LOCAL" || name == "Local" || name == "local";
    const std::vector<fs::path> files = local ? std::vector<fs::path>{file} : metaFiles(file, header);
    double skipped = header.values.count("HeaderSize") > 0 ? numbersOf(header, "HeaderSize", 1).front() : 0;
    if (local) skipped = static_cast<double>(header.end);
    const auto begin = static_cast<std::uintmax_t>(std::max(skipped, 0.0));
    const bool binary = header.values.count("BinaryData") == 0 || isTrue(header, "BinaryData");
    const std::uintmax_t bytes = elements * width;
    std::uintmax_t there = 0;
    for (const fs::path& one : files) {
        const std::uintmax_t size = sizeOf(one);
        if (!binary) {
            there += wordsBehind(one, begin, (bytes - there + width - 1) / width) * width;
        } else if (isTrue(header, "CompressedData")) {
            there += inflatedSize(one, begin, bytes - there);
        } else {
            there += size - std::min(size, begin);
        }
        if (there >= bytes) return;
    }
    tooShort(bytes, there);
}

void requireNiftiHeader(const fs::path& file) {
    const GzipStream stream = openedGzip(file);
    const NiftiHeader header(stream.get());
    const auto require = [&](std::size_t first, std::size_t second, std::size_t count) {
        constexpr double kFar = 1e9; // [mm]
        for (std::size_t i = 0; i < count; ++i)
            if (!(std::abs(header.real(first, second, i)) <= kFar))
                fail("its spacing or orientation cannot be: it is damaged");
    };
    require(80, 112, 3);
    const auto code = [&](std::size_t first, std::size_t second) {
        return header.isSecond() ? header.at<std::int32_t>(second) : header.at<std::int16_t>(first);
    };
    if (code(252, 344) != 0) require(256, 352, 6);
    if (code(254, 348) != 0) require(280, 400, 12);
}

void requireNiftiVoxels(const fs::path& file, std::size_t voxels, std::size_t components) {
    const std::string name = file.filename().string();
    if (!name.ends_with(".nii") && !name.ends_with(".nii.gz")) return;
    const GzipStream stream = openedGzip(file);
    const NiftiHeader header(stream.get());
    const std::uintmax_t bytes = (niftiBits(header, components) * voxels + 7) / 8;
    std::vector<char> buffer(std::size_t{1} << 18);
    std::uintmax_t there = 0;
    while (there < bytes) {
        const int got = gzread(stream.get(), buffer.data(), static_cast<unsigned>(buffer.size()));
        if (got <= 0) tooShort(bytes, there);
        there += static_cast<std::uintmax_t>(got);
    }
}

// The element of the pixels says how many they are, and comes before them: tag (7fe0,0010), then (explicit VR) "OW" or
// "OB" and two zeros, then the length.
void requireDicomPixels(const fs::path& file, std::size_t bytes) {
    using namespace std::string_view_literals;
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    constexpr auto kTag = "\xe0\x7f\x10\0"sv;
    for (std::size_t at = text.find(kTag); at != std::string::npos; at = text.find(kTag, at + 1)) {
        const std::string_view behind = std::string_view(text).substr(at + kTag.size(), 8);
        const bool isExplicit = behind.starts_with("OW\0\0"sv) || behind.starts_with("OB\0\0"sv);
        std::uint32_t length = 0;
        if (behind.size() < (isExplicit ? 8U : 4U)) continue;
        std::memcpy(&length, behind.data() + (isExplicit ? 4 : 0), sizeof length);
        if (length != bytes + bytes % 2) continue;
        const std::size_t begin = at + kTag.size() + (isExplicit ? 8 : 4);
        if (text.size() - begin < bytes)
            fail(fmt::format("{} is damaged: it promises {} bytes of pixels and has {}",
                             inQuotes(file.filename().string()), bytes, text.size() - begin));
        return;
    }
}

// TIFF 6.0, section 2; BigTIFF has numbers of twice the width (Adobe's and Joris Van Damme's draft, 2007).
std::size_t tiffPageCount(const fs::path& file) {
    Numbers numbers(file);
    numbers.bigEndian = numbers.at(0, 1) == 'M';
    const bool wide = numbers.at(2, 2) == 43;
    const std::size_t width = wide ? 8 : 4;
    const std::size_t countWidth = wide ? 8 : 2;
    const std::uint64_t tagSize = wide ? 20 : 12;
    constexpr std::size_t kMostPages = 1'000'000; // a chain may lead back to its beginning
    std::size_t pages = 0;
    std::optional<std::uint64_t> next = numbers.at(wide ? 8 : 4, width);
    while (next && *next != 0 && pages < kMostPages) {
        const auto tags = numbers.at(*next, countWidth);
        if (!tags || *tags > 65'535) break;
        next = numbers.at(*next + countWidth + *tags * tagSize, width);
        ++pages;
    }
    if (!next || *next != 0) fail(fmt::format("is damaged: page {} is cut off", pages + (next ? 1 : 0)));
    return pages;
}

} // namespace apeiron::io::volumes
