#include "core/error.hpp"
#include "io/volumes/itk_elements.hpp"
#include "io/volumes/volumes.hpp"
#include "io/volumes/whole.hpp"

#include <fmt/format.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <cmath>
#include <system_error>

namespace apeiron::io::volumes {
namespace {

using volume::Volume;

itk::ImageIOBase::Pointer ioFor(VolumeKind kind) {
    if (kind == VolumeKind::Nrrd) return itk::NrrdImageIO::New().GetPointer();
    if (kind == VolumeKind::Nifti) return itk::NiftiImageIO::New().GetPointer();
    return itk::MetaImageIO::New().GetPointer();
}

Shape shapeOf(const itk::ImageIOBase& io) {
    const unsigned dimensions = io.GetNumberOfDimensions();
    const auto edge = [&](unsigned axis) { return axis < dimensions ? io.GetDimensions(axis) : 1; };
    Shape shape{edge(0), edge(1), edge(2), io.GetNumberOfComponents(), edge(3)};
    for (unsigned axis = 4; axis < dimensions; ++axis)
        if (edge(axis) != 1)
            throw Error(
                ErrorKind::Io,
                fmt::format("has {} dimensions, and three in space and one in time are understood", dimensions));
    return shape;
}

/// Spacing, direction and origin as one map; ITK's world is LPS, as ours.
void setPlace(Volume& volume, const itk::ImageIOBase& io, VolumeKind kind) {
    const unsigned dimensions = std::min(io.GetNumberOfDimensions(), 3U);
    glm::dmat4 map(1);
    for (unsigned axis = 0; axis < dimensions; ++axis) {
        const std::vector<double> direction = io.GetDirection(axis);
        for (unsigned row = 0; row < 3; ++row) {
            const double component =
                row < direction.size() && row < dimensions ? direction[row] : (row == axis ? 1.0 : 0.0);
            map[static_cast<int>(axis)][static_cast<int>(row)] = component * io.GetSpacing(axis);
        }
        map[3][static_cast<int>(axis)] = io.GetOrigin(axis);
    }
    bool finite = true;
    for (int i = 0; i < 16; ++i)
        finite = finite && std::isfinite(map[i / 4][i % 4]);
    const double extent =
        glm::length(glm::dvec3(map[0])) * glm::length(glm::dvec3(map[1])) * glm::length(glm::dvec3(map[2]));
    if (finite && std::abs(glm::determinant(glm::dmat3(map))) > 1e-6 * extent && extent > 0) {
        volume.indexToWorld = map;
        // What says nothing has the grid's own axes.
        const glm::dmat3 axes(map);
        volume.oriented =
            kind == VolumeKind::Nifti ||
            axes != glm::dmat3(glm::length(axes[0]), 0, 0, 0, glm::length(axes[1]), 0, 0, 0, glm::length(axes[2]));
    } else {
        volume.messages.emplace_back("its spacing or orientation cannot be; voxels are taken as 1 mm");
    }
}

/// Nothing compresses by more than deflate's 1032: a header that promises more lies. Data in files of their own is not
/// looked at.
void requirePlausible(const std::filesystem::path& file, VolumeKind kind, std::size_t bytes) {
    const std::string extension = file.extension().string();
    if (kind == VolumeKind::MetaImage ? extension != ".mha"
                                      : (extension == ".nhdr" || extension == ".hdr" || extension == ".img"))
        return;
    std::error_code error;
    const std::uintmax_t there = std::filesystem::file_size(file, error);
    if (!error && bytes / 1100 > there)
        throw Error(ErrorKind::Io,
                    fmt::format("its header promises {} bytes of voxels, and the file has {} in all: it is damaged",
                                bytes, there));
}

} // namespace

Element elementOf(const itk::ImageIOBase& io) {
    using Type = itk::IOComponentEnum;
    switch (io.GetComponentType()) {
    case Type::UCHAR:
        return Element::UInt8;
    case Type::CHAR:
        return Element::Int8;
    case Type::USHORT:
        return Element::UInt16;
    case Type::SHORT:
        return Element::Int16;
    case Type::UINT:
        return Element::UInt32;
    case Type::INT:
        return Element::Int32;
    case Type::ULONG:
        return sizeof(long) == 8 ? Element::UInt64 : Element::UInt32;
    case Type::LONG:
        return sizeof(long) == 8 ? Element::Int64 : Element::Int32;
    case Type::ULONGLONG:
        return Element::UInt64;
    case Type::LONGLONG:
        return Element::Int64;
    case Type::FLOAT:
        return Element::Float32;
    case Type::DOUBLE:
        return Element::Float64;
    default:
        throw Error(ErrorKind::Io, "its voxels are of a type that is not understood");
    }
}

std::vector<std::byte> readElements(itk::ImageIOBase& io, std::size_t bytes) {
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
        region.SetIndex(axis, 0);
        region.SetSize(axis, io.GetDimensions(axis));
    }
    io.SetIORegion(region);
    std::vector<std::byte> elements(bytes);
    io.Read(elements.data());
    return elements;
}

Volume readItk(const std::filesystem::path& file, VolumeKind kind, std::size_t limit) {
    if (kind == VolumeKind::MetaImage) requireMetaHeader(file);
    if (kind == VolumeKind::Nifti) requireNiftiHeader(file);
    const itk::ImageIOBase::Pointer io = ioFor(kind);
    io->SetFileName(file.string());
    io->ReadImageInformation();
    Volume volume;
    Shape shape = shapeOf(*io);
    const Element element = elementOf(*io);
    const std::size_t bytes = requireMemory(shape, element, limit);
    requirePlausible(file, kind, bytes);
    const std::size_t voxels = shape.x * shape.y * shape.z * shape.times;
    if (kind == VolumeKind::MetaImage) requireMetaVoxels(file, voxels * shape.channels, bytesOf(element));
    if (kind == VolumeKind::Nifti) requireNiftiVoxels(file, voxels, shape.channels);
    setPlace(volume, *io, kind);
    if (shape.times > 1 && kind == VolumeKind::Nifti && std::isfinite(io->GetSpacing(3)))
        volume.timeStep = io->GetSpacing(3);
    std::vector<std::byte> elements = readElements(*io, bytes);
    if (shape.channels > 1) {
        const std::uint64_t kept = keptChannels(shape.channels, volume);
        elements =
            separated(elements, bytesOf(element), shape.x * shape.y * shape.z, shape.channels, kept, shape.times);
        shape.channels = kept;
    }
    setVoxels(volume, shape, element, std::move(elements));
    return volume;
}

} // namespace apeiron::io::volumes
