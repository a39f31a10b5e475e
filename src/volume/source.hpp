#pragma once

#include "volume/large.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace apeiron::volume {

/// Which volume is wanted: a file, or a folder of slices.
struct VolumeRequest {
    std::filesystem::path file;
    /// The file is bare voxels of this form, "128x128x128:uint16:big:offset=512" (see raw.hpp); empty: its own format
    /// tells.
    std::string raw;
    /// Which of several grids of an OpenVDB file; empty: the first one.
    std::string grid;
    /// No more memory than this for its voxels [bytes]; 0: as much as the machine has to spare.
    std::size_t memory = 0;

    bool operator==(const VolumeRequest&) const = default;
};

/// Reads a volume. @throws Error (Io, BadInput) that says what is wrong with the file.
using VolumeLoader = std::function<Volume(const VolumeRequest&)>;

/// Opens a volume for reading in parts, where it is larger than the request's memory; nothing where it is not, and
/// where its format cannot be read that way. @throws Error (Io, BadInput) that says what is wrong with the file.
using VolumeOpener = std::function<std::optional<LargeVolume>(const VolumeRequest&)>;

/// The engine itself knows no files: a front end says once how volumes are read (natively io::readVolume).
/// Process-wide, not thread-safe. Forgets what loadVolume() keeps.
void setVolumeLoader(VolumeLoader loader, VolumeOpener opener = {});

/// Gives a volume that is already in memory a name: from now on a request for the file of that name gives it, before
/// any loader is asked. For pages, which have bytes and no files, and for tests. Null takes it away.
void provideVolume(const std::string& name, std::shared_ptr<const Volume> volume);

/// The volume that was asked for. As long as somebody holds it, or it is the one that was loaded last, asking again
/// reads nothing, unless the file was written to in the meantime. Not thread-safe.
/// @throws Error: what the loader throws; BadInput when no loader was set
std::shared_ptr<const Volume> loadVolume(const VolumeRequest& request);

/// What the opener makes of it; nothing for what is in memory already.
std::optional<LargeVolume> openVolume(const VolumeRequest& request);

} // namespace apeiron::volume
