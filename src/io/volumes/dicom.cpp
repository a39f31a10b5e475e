#include "core/error.hpp"
#include "io/volumes/itk_elements.hpp"
#include "io/volumes/serve.hpp"
#include "io/volumes/volumes.hpp"
#include "io/volumes/whole.hpp"

#include <fmt/format.h>
#include <itkGDCMImageIO.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

// DICOM PS3.3, C.7.6.2: where slices are in the patient is in their ImagePositionPatient and ImageOrientationPatient
// alone; neither names, nor instance numbers, nor the thickness of slices say so.
namespace apeiron::io::volumes {
namespace {

namespace fs = std::filesystem;
using volume::Modality;
using volume::Volume;

/// A file's header.
struct Slice {
    fs::path file;
    std::string series;
    std::string modality;
    double instance = 0;
    Shape shape;
    Element element = Element::UInt8;
    glm::dvec3 spacing{1};
    glm::dvec3 origin{0};
    glm::dvec3 row{1, 0, 0};
    glm::dvec3 column{0, 1, 0};
    double place = 0; ///< along the slices' normal [mm]
};

std::string tag(itk::GDCMImageIO& io, const char* key) {
    std::string value;
    io.GetValueFromTag(key, value);
    while (!value.empty() && (value.back() == ' ' || value.back() == '\0'))
        value.pop_back();
    return value;
}

itk::GDCMImageIO::Pointer opened(const fs::path& file) {
    blame(file);
    const itk::GDCMImageIO::Pointer io = itk::GDCMImageIO::New();
    io->SetFileName(file.string());
    io->ReadImageInformation();
    return io;
}

Slice readHeader(const fs::path& file) {
    const itk::GDCMImageIO::Pointer io = opened(file);
    Slice slice;
    slice.file = file;
    slice.series = tag(*io, "0020|000e");
    slice.modality = tag(*io, "0008|0060");
    slice.instance = std::strtod(tag(*io, "0020|0013").c_str(), nullptr);
    const unsigned dimensions = io->GetNumberOfDimensions();
    const auto edge = [&](unsigned axis) { return axis < dimensions ? io->GetDimensions(axis) : 1; };
    slice.shape = {edge(0), edge(1), edge(2), io->GetNumberOfComponents(), 1};
    slice.element = elementOf(*io);
    for (unsigned axis = 0; axis < std::min(dimensions, 3U); ++axis) {
        slice.spacing[static_cast<int>(axis)] = io->GetSpacing(axis);
        slice.origin[static_cast<int>(axis)] = io->GetOrigin(axis);
    }
    const std::vector<double> row = io->GetDirection(0);
    const std::vector<double> column = io->GetDirection(1);
    if (row.size() >= 3 && column.size() >= 3) {
        slice.row = {row[0], row[1], row[2]};
        slice.column = {column[0], column[1], column[2]};
    }
    requireDicomPixels(file, slice.shape.x * slice.shape.y * slice.shape.z * slice.shape.channels *
                                 static_cast<std::size_t>(std::strtol(tag(*io, "0028|0100").c_str(), nullptr, 10)) / 8);
    double finite = glm::dot(slice.origin, slice.origin);
    finite +=
        glm::dot(slice.spacing, slice.spacing) + glm::dot(slice.row, slice.row) + glm::dot(slice.column, slice.column);
    if (!std::isfinite(finite) || slice.spacing.x <= 0 || slice.spacing.y <= 0)
        throw Error(ErrorKind::Io, fmt::format("the place of {} in space cannot be", file.filename().string()));
    slice.place = glm::dot(slice.origin, glm::cross(slice.row, slice.column));
    return slice;
}

/// What slices of one stack have in common.
std::string stackOf(const Slice& s) {
    return fmt::format("{} {}x{}x{} {} {:.3f} {:.3f} {:.3f} {:.3f} {:.3f} {:.3f} {:.4g} {:.4g}", s.series, s.shape.x,
                       s.shape.y, s.shape.z, s.shape.channels, s.row.x + 0.0, s.row.y + 0.0, s.row.z + 0.0,
                       s.column.x + 0.0, s.column.y + 0.0, s.column.z + 0.0, s.spacing.x, s.spacing.y);
}

/// The largest stack of slices that belong together.
std::vector<Slice> chosenStack(const std::vector<fs::path>& files, Volume& volume) {
    std::map<std::string, std::vector<Slice>> stacks;
    std::string first;
    std::size_t unreadable = 0;
    for (const fs::path& file : files) {
        try {
            Slice slice = readHeader(file);
            stacks[stackOf(slice)].push_back(std::move(slice));
        } catch (const std::exception&) {
            if (unreadable++ == 0) first = file.filename().string();
        }
    }
    if (stacks.empty())
        throw Error(ErrorKind::Io,
                    files.size() == 1 ? "is damaged, or holds no picture" : "holds no pictures that can be read");
    if (unreadable > 0)
        volume.messages.push_back(
            fmt::format("{} of {} files are left out since they are damaged or hold no picture, {} for one", unreadable,
                        files.size(), inQuotes(first)));
    const auto largest = std::max_element(stacks.begin(), stacks.end(), [](const auto& a, const auto& b) {
        return a.second.size() * a.second.front().shape.z < b.second.size() * b.second.front().shape.z;
    });
    if (stacks.size() > 1)
        volume.messages.push_back(fmt::format("the largest of {} stacks of slices is shown, which has {} of {} files",
                                              stacks.size(), largest->second.size(), files.size()));
    return largest->second;
}

/// How many slices are at the same place, sorted by place: points of time.
std::size_t sortByPlace(std::vector<Slice>& slices) {
    std::sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.place < b.place; });
    const double tolerance =
        1e-3 * std::max(1e-3, (slices.back().place - slices.front().place) / static_cast<double>(slices.size()));
    std::vector<std::size_t> counts;
    std::size_t begin = 0;
    for (std::size_t i = 1; i <= slices.size(); ++i) {
        if (i < slices.size() && slices[i].place - slices[i - 1].place <= tolerance) continue;
        counts.push_back(i - begin);
        std::stable_sort(slices.begin() + static_cast<std::ptrdiff_t>(begin),
                         slices.begin() + static_cast<std::ptrdiff_t>(i),
                         [](const Slice& a, const Slice& b) { return a.instance < b.instance; });
        begin = i;
    }
    const std::size_t times = counts.front();
    if (std::any_of(counts.begin(), counts.end(), [times](std::size_t n) { return n != times; }))
        throw Error(ErrorKind::Io,
                    "has several slices at some places and not at others: which belong together is not clear");
    return times;
}

/// Where the places of the slices are, in steps of the volume: the same for evenly spaced ones.
struct Sampling {
    std::size_t count = 0;
    double step = 0; ///< [mm] along the normal
    bool even = true;
};

Sampling samplingOf(const std::vector<double>& places, Volume& volume) {
    const std::size_t n = places.size();
    const double total = places.back() - places.front();
    double least = total;
    double most = 0;
    for (std::size_t i = 1; i < n; ++i) {
        least = std::min(least, places[i] - places[i - 1]);
        most = std::max(most, places[i] - places[i - 1]);
    }
    const double mean = total / static_cast<double>(n - 1);
    // Positions are decimal texts, often of few digits: a hundredth of a slice is rounding.
    if (most - least <= 0.02 * mean) return {n, mean, true};
    // As fine as the finest part, but not without end.
    const double wanted = std::min(std::round(total / std::max(least, 1e-9 * total)) + 1, 4.0 * static_cast<double>(n));
    Sampling sampling{static_cast<std::size_t>(wanted), 0, false};
    sampling.step = total / static_cast<double>(sampling.count - 1);
    volume.messages.push_back(
        fmt::format("slices are {:.4g} to {:.4g} mm apart: resampled linearly from {} to {} slices, {:.4g} mm apart",
                    least, most, n, sampling.count, sampling.step));
    return sampling;
}

/// A slice's values as floats.
std::vector<float> asFloats(Element element, std::vector<std::byte> elements, const Shape& shape) {
    Volume slice;
    setVoxels(slice, shape, element, std::move(elements));
    std::vector<float> values(slice.voxels.size() / volume::bytesPerVoxel(slice.type));
    const auto convert = [&](auto example) {
        using T = decltype(example);
        for (std::size_t i = 0; i < values.size(); ++i) {
            T value{};
            std::memcpy(&value, slice.voxels.data() + i * sizeof(T), sizeof(T));
            values[i] = static_cast<float>(value);
        }
    };
    if (slice.type == volume::VoxelType::UInt8) convert(std::uint8_t{});
    if (slice.type == volume::VoxelType::Int8) convert(std::int8_t{});
    if (slice.type == volume::VoxelType::UInt16) convert(std::uint16_t{});
    if (slice.type == volume::VoxelType::Int16) convert(std::int16_t{});
    if (slice.type == volume::VoxelType::Float32) convert(float{});
    return values;
}

/// All slices one after the other, in the type of the first; as floats where slices differ in type.
class SliceReader {
  public:
    explicit SliceReader(const std::vector<Slice>& slices) : slices_(slices), element_(slices.front().element) {
        for (const Slice& slice : slices)
            if (slice.element != element_) mixed_ = true;
        if (mixed_ || bytesOf(element_) > 4) element_ = Element::Float32;
    }

    Element element() const { return element_; }

    /// Channels separated.
    std::vector<std::byte> read(std::size_t index) const {
        const Slice& slice = slices_[index];
        const Shape& s = slice.shape;
        const itk::GDCMImageIO::Pointer io = opened(slice.file);
        const std::size_t voxels = s.x * s.y * s.z;
        std::vector<std::byte> elements = readElements(*io, voxels * s.channels * bytesOf(slice.element));
        if (s.channels > 1)
            elements = separated(elements, bytesOf(slice.element), voxels, s.channels,
                                 std::min<std::size_t>(4, s.channels), 1);
        if (slice.element == element_) return elements;
        const std::vector<float> values = asFloats(slice.element, std::move(elements), s);
        std::vector<std::byte> result(values.size() * sizeof(float));
        std::memcpy(result.data(), values.data(), result.size());
        return result;
    }

  private:
    const std::vector<Slice>& slices_;
    Element element_;
    bool mixed_ = false;
};

template <class T>
void mix(std::byte* to, const std::vector<std::byte>& a, const std::vector<std::byte>& b, double weight) {
    for (std::size_t i = 0; i < a.size(); i += sizeof(T)) {
        T x{};
        T y{};
        std::memcpy(&x, a.data() + i, sizeof(T));
        std::memcpy(&y, b.data() + i, sizeof(T));
        double value = static_cast<double>(x) + weight * (static_cast<double>(y) - static_cast<double>(x));
        if constexpr (std::is_integral_v<T>) value = std::round(value);
        const T result = static_cast<T>(value);
        std::memcpy(to + i, &result, sizeof(T));
    }
}

void mix(Element element, std::byte* to, const std::vector<std::byte>& a, const std::vector<std::byte>& b,
         double weight) {
    if (weight <= 0 || weight >= 1) {
        std::memcpy(to, weight <= 0 ? a.data() : b.data(), a.size());
        return;
    }
    switch (element) {
    case Element::UInt8:
        return mix<std::uint8_t>(to, a, b, weight);
    case Element::Int8:
        return mix<std::int8_t>(to, a, b, weight);
    case Element::UInt16:
        return mix<std::uint16_t>(to, a, b, weight);
    case Element::Int16:
        return mix<std::int16_t>(to, a, b, weight);
    case Element::UInt32:
        return mix<std::uint32_t>(to, a, b, weight);
    case Element::Int32:
        return mix<std::int32_t>(to, a, b, weight);
    default:
        return mix<float>(to, a, b, weight);
    }
}

/// The stack's grid in the world: columns and rows, and from slice to slice whatever way the positions go.
void setGrid(Volume& volume, const std::vector<Slice>& slices, std::size_t times, double step) {
    const Slice& first = slices.front();
    const Slice& last = slices.back();
    const glm::dvec3 normal = glm::cross(first.row, first.column);
    const glm::dvec3 along = (last.origin - first.origin) / (last.place - first.place);
    for (std::size_t i = 0; i < slices.size(); i += times) {
        const glm::dvec3 expected = first.origin + (slices[i].place - first.place) * along;
        const double off = glm::length(slices[i].origin - expected);
        if (off > std::max(0.02, 0.25 * std::min(first.spacing.x, first.spacing.y)))
            throw Error(ErrorKind::Io, fmt::format("its slices are not in one line: {} is {:.3g} mm beside it",
                                                   slices[i].file.filename().string(), off));
    }
    const double tilt = std::atan(glm::length(along - normal)) * 180 / std::numbers::pi;
    if (tilt > 0.1)
        volume.messages.push_back(
            fmt::format("slices are tilted by {:.3g} degrees (gantry tilt): the grid is sheared by as much", tilt));
    volume.indexToWorld =
        glm::dmat4(glm::dvec4(first.row * first.spacing.x, 0), glm::dvec4(first.column * first.spacing.y, 0),
                   glm::dvec4(along * step, 0), glm::dvec4(first.origin, 1));
}

void setModality(Volume& volume, const std::string& modality) {
    if (modality == "CT") {
        volume.modality = Modality::Ct;
        volume.unit = "HU";
    } else if (modality == "MR") {
        volume.modality = Modality::Mri;
    } else if (modality == "SM" || modality == "GM") {
        volume.modality = Modality::Microscopy;
    }
}

/// One file, of one frame or many.
Volume readFrames(const Slice& slice, std::size_t limit, Volume volume) {
    Shape shape = slice.shape;
    requireMemory(shape, slice.element, limit);
    shape.channels = keptChannels(shape.channels, volume);
    const std::vector<Slice> slices{slice};
    const SliceReader reader(slices);
    setVoxels(volume, shape, reader.element(), reader.read(0));
    const glm::dvec3 normal = glm::cross(slice.row, slice.column);
    const double step = slice.spacing.z > 0 ? slice.spacing.z : 1.0;
    volume.indexToWorld =
        glm::dmat4(glm::dvec4(slice.row * slice.spacing.x, 0), glm::dvec4(slice.column * slice.spacing.y, 0),
                   glm::dvec4(normal * step, 0), glm::dvec4(slice.origin, 1));
    if (shape.z == 1) volume.messages.emplace_back("is a single slice; name the folder to see all of its series");
    return volume;
}

} // namespace

Volume readDicom(const std::vector<fs::path>& files, std::size_t limit) {
    Volume volume;
    volume.oriented = true;
    std::vector<Slice> slices = chosenStack(files, volume);
    setModality(volume, slices.front().modality);
    if (slices.size() == 1) return readFrames(slices.front(), limit, std::move(volume));
    if (slices.front().shape.z != 1)
        throw Error(ErrorKind::Io, "holds several files of many frames each", {}, "name one of the files");

    const std::size_t times = sortByPlace(slices);
    if (times == slices.size())
        throw Error(ErrorKind::Io, "holds slices at one place only", {}, "name one of the files");
    std::vector<double> places;
    for (std::size_t i = 0; i < slices.size(); i += times)
        places.push_back(slices[i].place);
    const Sampling sampling = samplingOf(places, volume);
    setGrid(volume, slices, times, sampling.step);

    const SliceReader reader(slices);
    Shape shape = slices.front().shape;
    shape.channels = keptChannels(shape.channels, volume);
    shape.z = sampling.count;
    shape.times = times;
    std::vector<std::byte> voxels(requireMemory(shape, reader.element(), limit));
    const std::size_t plane = shape.x * shape.y * bytesOf(reader.element());
    const auto to = [&](std::size_t time, std::size_t channel, std::size_t z) {
        return voxels.data() + ((time * shape.channels + channel) * shape.z + z) * plane;
    };
    for (std::size_t time = 0; time < times; ++time) {
        std::size_t below = 0;
        std::vector<std::byte> a = reader.read(time);
        std::vector<std::byte> b = reader.read(times + time);
        for (std::size_t z = 0; z < sampling.count; ++z) {
            const double place = places.front() + static_cast<double>(z) * sampling.step;
            while (sampling.even ? below + 1 < z && below + 2 < places.size()
                                 : below + 2 < places.size() && places[below + 1] < place) {
                ++below;
                a = std::move(b);
                b = reader.read((below + 1) * times + time);
            }
            double weight = (place - places[below]) / (places[below + 1] - places[below]);
            if (sampling.even) weight = z == below ? 0 : 1;
            std::vector<std::byte> mixed(a.size());
            mix(reader.element(), mixed.data(), a, b, std::clamp(weight, 0.0, 1.0));
            for (std::size_t channel = 0; channel < shape.channels; ++channel)
                std::memcpy(to(time, channel, z), mixed.data() + channel * plane, plane);
        }
    }
    setVoxels(volume, shape, reader.element(), std::move(voxels));
    return volume;
}

} // namespace apeiron::io::volumes
