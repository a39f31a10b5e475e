#include "io/volume_parts.hpp"

#include "core/error.hpp"
#include "io/volume_file.hpp"
#include "volume/raw.hpp"
#include "volume/voxels.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <system_error>
#include <type_traits>
#include <unistd.h>

namespace apeiron::io {
namespace {

namespace fs = std::filesystem;
using volume::RawForm;
using volume::Volume;
using volume::VoxelBox;

/// A file that is read at any place.
class OpenFile {
  public:
    explicit OpenFile(const fs::path& path) : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (file_ < 0) fail(errno);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile() { ::close(file_); }

    void read(std::uint64_t offset, std::byte* to, std::size_t bytes) const {
        while (bytes > 0) {
            const ssize_t count = ::pread(file_, to, bytes, static_cast<off_t>(offset));
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(errno);
            if (count == 0) throw Error(ErrorKind::Io, "has become shorter", path_.string());
            to += count;
            offset += static_cast<std::uint64_t>(count);
            bytes -= static_cast<std::size_t>(count);
        }
    }

  private:
    [[noreturn]] void fail(int code) const {
        throw Error(ErrorKind::Io, "cannot be read: " + std::generic_category().message(code), path_.string());
    }

    fs::path path_;
    int file_;
};

/// Reads boxes of a file of bare voxels.
class RawReader {
  public:
    RawReader(const fs::path& path, const RawForm& form)
        : file_(std::make_shared<const OpenFile>(path)), scratch_(std::make_shared<Volume>()), form_(form) {}

    void operator()(const VoxelBox& box, int channel, int time, float* to) const {
        const std::uint64_t width = volume::bytesPerVoxel(form_.type);
        const auto x = static_cast<std::uint64_t>(form_.size.x);
        const auto y = static_cast<std::uint64_t>(form_.size.y);
        const auto z = static_cast<std::uint64_t>(form_.size.z);
        const std::uint64_t first = (static_cast<std::uint64_t>(time) * static_cast<std::uint64_t>(form_.channels) +
                                     static_cast<std::uint64_t>(channel)) *
                                    x * y * z;
        // From the first to the last voxel of a slice of the box in one piece: fewer calls are worth more than what is
        // read in vain.
        Volume& slice = *scratch_;
        slice.type = form_.type;
        const auto rows = static_cast<std::uint64_t>(box.size.y);
        slice.voxels.resize((x * (rows - 1) + static_cast<std::uint64_t>(box.size.x)) * width);
        for (int k = 0; k < box.size.z; ++k) {
            const std::uint64_t start =
                first +
                (static_cast<std::uint64_t>(box.first.z + k) * y + static_cast<std::uint64_t>(box.first.y)) * x +
                static_cast<std::uint64_t>(box.first.x);
            file_->read(form_.offset + start * width, slice.voxels.data(), slice.voxels.size());
            volume::toNativeOrder(slice, form_);
            volume::visitVoxels(slice, 0, [&](const auto* voxels) {
                for (int j = 0; j < box.size.y; ++j) {
                    const auto* row = voxels + static_cast<std::uint64_t>(j) * x;
                    for (int i = 0; i < box.size.x; ++i) {
                        const float value = volume::number(row[i]);
                        if constexpr (std::is_integral_v<std::decay_t<decltype(*row)>>) {
                            *to++ = value;
                        } else {
                            *to++ = std::isfinite(value) ? value : 0.0F;
                        }
                    }
                }
            });
        }
    }

  private:
    std::shared_ptr<const OpenFile> file_;
    std::shared_ptr<Volume> scratch_; ///< what was read last: memory that need not be allocated each time
    RawForm form_;
};

} // namespace

std::optional<volume::LargeVolume> openVolume(const volume::VolumeRequest& request) {
    if (request.raw.empty()) return std::nullopt;
    const RawForm form = volume::parseRawForm(request.raw);
    const std::size_t bytes = volume::byteSize(form, std::numeric_limits<std::size_t>::max());
    if (bytes <= memoryFor(request)) return std::nullopt;
    const std::string where = request.file.string();
    std::error_code error;
    const std::uintmax_t there = fs::file_size(request.file, error);
    if (error) throw Error(ErrorKind::Io, "cannot be read: " + error.message(), where);
    const std::uint64_t wanted = form.offset + bytes;
    if (there < wanted) {
        throw Error(ErrorKind::BadInput, fmt::format("has {} bytes, and {} needs {}", there, request.raw, wanted),
                    where);
    }
    volume::LargeVolume large;
    large.form.size = form.size;
    large.form.type = form.type;
    large.form.channels = form.channels;
    large.form.timePoints = form.timePoints;
    volume::centre(large.form, form.spacing);
    if (there > wanted)
        large.form.messages.push_back(fmt::format("{} bytes behind the voxels were left out", there - wanted));
    large.form.name = where;
    large.read = RawReader(request.file, form);
    return large;
}

} // namespace apeiron::io
