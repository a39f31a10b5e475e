#include "core/error.hpp"
#include "io/volumes/elements.hpp"
#include "io/volumes/volumes.hpp"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstring>

namespace apeiron::io::volumes {
namespace {

using volume::Volume;

/// The box of active voxels, dense, one channel for each component; what is not active has the background's value.
template <class Grid, class Scalar, int kComponents>
void setDense(Volume& volume, const Grid& grid, Element element, std::size_t limit) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty())
        throw Error(ErrorKind::Io, fmt::format("the grid {} has no active voxels", inQuotes(grid.getName())));
    const auto edge = [&box](int axis) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(box.max()[axis]) - box.min()[axis] + 1);
    };
    const Shape shape{edge(0), edge(1), edge(2), kComponents, 1};
    std::vector<std::byte> elements(requireMemory(shape, element, limit));
    const std::size_t plane = elements.size() / kComponents;
    const auto accessor = grid.getConstAccessor();
    std::size_t at = 0;
    for (int z = box.min().z(); z <= box.max().z(); ++z)
        for (int y = box.min().y(); y <= box.max().y(); ++y)
            for (int x = box.min().x(); x <= box.max().x(); ++x, at += sizeof(Scalar)) {
                const auto value = accessor.getValue({x, y, z});
                for (int c = 0; c < kComponents; ++c) {
                    Scalar scalar{};
                    if constexpr (kComponents == 1) {
                        scalar = static_cast<Scalar>(value);
                    } else {
                        scalar = value[c];
                    }
                    std::memcpy(elements.data() + static_cast<std::size_t>(c) * plane + at, &scalar, sizeof scalar);
                }
            }
    setVoxels(volume, shape, element, std::move(elements));

    const openvdb::math::Transform& transform = grid.transform();
    if (!transform.isLinear())
        throw Error(ErrorKind::Io, fmt::format("the grid {} is in a frustum, not a box", inQuotes(grid.getName())));
    const openvdb::Vec3d origin = transform.indexToWorld(box.min().asVec3d());
    glm::dmat4 map(1);
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d next = box.min().asVec3d();
        next[axis] += 1;
        const openvdb::Vec3d step = transform.indexToWorld(next) - origin;
        for (int row = 0; row < 3; ++row)
            map[axis][row] = step[row];
        map[3][axis] = origin[axis];
    }
    double sum = 0;
    for (int i = 0; i < 16; ++i)
        sum += map[i / 4][i % 4];
    if (!std::isfinite(sum) || glm::determinant(glm::dmat3(map)) == 0)
        throw Error(ErrorKind::Io, "its transform cannot be");
    volume.indexToWorld = map;
}

/// Whether the grid was of a type that is understood.
bool convert(Volume& volume, const openvdb::GridBase& grid, std::size_t limit) {
    if (grid.isType<openvdb::FloatGrid>()) {
        setDense<openvdb::FloatGrid, float, 1>(volume, static_cast<const openvdb::FloatGrid&>(grid), Element::Float32,
                                               limit);
    } else if (grid.isType<openvdb::DoubleGrid>()) {
        setDense<openvdb::DoubleGrid, double, 1>(volume, static_cast<const openvdb::DoubleGrid&>(grid),
                                                 Element::Float64, limit);
    } else if (grid.isType<openvdb::Int32Grid>()) {
        setDense<openvdb::Int32Grid, std::int32_t, 1>(volume, static_cast<const openvdb::Int32Grid&>(grid),
                                                      Element::Int32, limit);
    } else if (grid.isType<openvdb::BoolGrid>()) {
        setDense<openvdb::BoolGrid, std::uint8_t, 1>(volume, static_cast<const openvdb::BoolGrid&>(grid),
                                                     Element::UInt8, limit);
    } else if (grid.isType<openvdb::Vec3SGrid>()) {
        setDense<openvdb::Vec3SGrid, float, 3>(volume, static_cast<const openvdb::Vec3SGrid&>(grid), Element::Float32,
                                               limit);
        volume.channelNames = {"x", "y", "z"};
    } else {
        return false;
    }
    return true;
}

std::string listed(const openvdb::GridPtrVec& grids) {
    std::string names;
    for (const auto& grid : grids)
        names += (names.empty() ? "" : ", ") + inQuotes(grid->getName());
    return names;
}

} // namespace

Volume readVdb(const std::filesystem::path& path, const std::string& name, std::size_t limit) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open(false);
    const openvdb::GridPtrVecPtr headers = file.readAllGridMetadata();
    if (headers == nullptr || headers->empty()) throw Error(ErrorKind::Io, "holds no grids");
    for (const auto& header : *headers) {
        if (!name.empty() && header->getName() != name) continue;
        Volume volume;
        volume.modality = volume::Modality::Simulation;
        const openvdb::GridBase::Ptr grid = file.readGrid(header->getName());
        if (grid != nullptr && convert(volume, *grid, limit)) {
            if (headers->size() > 1 && name.empty())
                volume.messages.push_back(fmt::format("the grid {} of {} is shown; all: {}",
                                                      inQuotes(header->getName()), headers->size(), listed(*headers)));
            if (grid->getGridClass() == openvdb::GRID_LEVEL_SET)
                volume.messages.emplace_back("is a level set: its values are distances to a surface");
            return volume;
        }
        if (!name.empty())
            throw Error(ErrorKind::Io, fmt::format("the grid {} holds values of type {}, which is not understood",
                                                   inQuotes(name), header->valueType()));
    }
    throw Error(ErrorKind::BadInput, name.empty() ? "none of its grids holds numbers" : "has no grid " + inQuotes(name),
                {}, "its grids: " + listed(*headers));
}

} // namespace apeiron::io::volumes
