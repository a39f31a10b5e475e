#pragma once

#include "terrain/address.hpp"
#include "terrain/cell_key.hpp"
#include "terrain/height.hpp"

#include <deque>
#include <optional>
#include <utility>

namespace apeiron::terrain {

/// A cell with its eight neighbours: like a cell's window, their heights follow from those of the parent's block, so
/// that neighbours are known wherever the path leads, without a search for common ancestors.
struct Block {
    std::int64_t level = 0;
    std::uint32_t x = 0; ///< of the middle cell, modulo 2^32
    std::uint32_t y = 0;
    /// Of lattice point (x - 2 + i, y - 2 + j) at [6 * j + i].
    std::array<std::int32_t, 36> heights{};

    /// The middle cell's neighbour at an offset. @pre -1 <= dx, dy <= 1
    Cell cell(int dx = 0, int dy = 0) const;

    bool operator==(const Block&) const = default;
};

/// The block about a cell of level 0.
Block rootBlock(const Shape& shape);
/// The block about a child of the middle cell.
Block childBlock(const Shape& shape, const Block& block, int digit);

/// A point over or on a terrain at any depth, exactly: a path, the point within the path's cell in fixed point, and
/// what it takes to know the heights of all ancestors. Memory: 2 bits a level for the path and one block of 160 bytes
/// every 64 levels, about 2.8 bytes a level in all.
///
/// The local frame: x and y in cells of the path's cell from its corner (0, 0), z in cells as well, from the height of
/// that corner.
class Place {
  public:
    /// The corner of the cell at that address. Takes about 0.3 us a level.
    explicit Place(const Shape& shape, Address address = {});

    const Shape& shape() const { return shape_; }
    const Address& address() const { return address_; }
    std::int64_t level() const { return address_.levels(); }

    /// Levels upwards from level() whose blocks are at hand at least (or all up to the root).
    static constexpr std::int64_t kLiveLevels = 24;
    /// The cell of the path at a level, and its neighbours. @pre max(0, level() - kLiveLevels) <= level <= level()
    const Block& block(std::int64_t level) const;
    const Block& block() const { return live_.back(); }
    Cell cell() const { return live_.back().cell(); }
    /// The same for any level above, recomputed from the nearest checkpoint. @pre 0 <= level <= level()
    Block ancestor(std::int64_t level) const;

    /// A cell near the point: at an offset of cells from the one of that level that holds it. Costs about 0.1 us for
    /// each level up to where the offset is one cell, and back.
    /// @pre max(0, level() - kLiveLevels) <= level <= level() + 24, |dx|, |dy| < 2^24; what lies beyond the blocks at
    /// hand, or outside the root cell's neighbours, is clamped to their border
    Cell cellNear(std::int64_t level, std::int64_t dx, std::int64_t dy) const;

    /// The cell of that name whose way from here is shorter than 2^31 cells of its level. Takes as long.
    /// @pre max(0, level() - kLiveLevels) <= key.level <= level() + 24, and from the first of these levels on the cell
    /// is one of the point's or in one of its neighbours; where that level is 0 it may be any
    Cell cellNamed(const CellKey& key) const;

    /// The point within the cell [2^-64 cells].
    std::uint64_t x() const { return x_; }
    std::uint64_t y() const { return y_; }
    /// Its height [2^-32 units of height of level()], modulo 2^64: comparable with heights of the level. The unit is
    /// 2^-kFractionBits cells.
    std::uint64_t height() const { return height_; }
    /// The height of the point in units of another level, see height(). @pre max(0, level() - kLiveLevels) <= level <=
    /// level() + 40
    std::uint64_t heightAt(std::int64_t level) const;

    /// In the local frame. Doubles: not exact below 2^-53 cells.
    glm::dvec3 position() const;
    /// @pre x and y in [0, 1), |z| < 2^18
    void setPosition(const glm::dvec3& position);

    /// Moves by an offset [cells of level()], to another cell where it leads out of this one. Stops at the border of
    /// the root cell. @returns false where it did. @pre |offset| < 2^18
    bool move(const glm::dvec3& offset);

    /// From the point to the middle of a cell, at its corners' mean height [cells of level()].
    /// @pre max(0, level() - kLiveLevels) <= cell.level <= level() + 40, and the cell is less than 2^31 of its own away
    glm::dvec3 toCell(const Cell& cell) const;
    /// From the point to another place of the same terrain and level [cells], less than 2^31 away.
    glm::dvec3 to(const Place& other) const;
    /// Moves to exactly the point of another place of the same terrain and level, by carry from cell to cell.
    /// @pre less than 2^31 cells away, without leaving the root cell
    void moveTo(const Place& other);

    /// Makes the child in which the point lies the cell: the same point, of twice the coordinates.
    /// @throws Error (BadInput) at Address::kMaxLevels.
    void descend();
    /// Makes the parent the cell. What descend() did is undone exactly; of x and y the last bit is lost otherwise.
    /// @pre level() > 0
    void ascend();

    bool operator==(const Place& other) const;

  private:
    static constexpr std::int64_t kCheckpoint = 64;
    void pushBlock(const Block& block);
    /// Computes blocks anew from a level on (whose own is still right).
    void rebuild(std::int64_t level);
    void keepLive();
    /// Coordinate of the cell of any level from level() - kLiveLevels on that holds the point, and the point within it.
    std::pair<std::uint32_t, double> along(int axis, std::int64_t level) const;

    Shape shape_;
    Address address_;
    std::vector<Block> checkpoints_; ///< of levels 0, 64, 128, ...
    std::deque<Block> live_;         ///< the last levels' blocks, up to level()
    std::uint64_t x_ = 0;
    std::uint64_t y_ = 0;
    std::uint64_t height_ = 0;
};

/// From one place to another of the same terrain [cells of the latter's level]; nothing where they are more than 8
/// levels apart.
std::optional<glm::dvec3> offsetBetween(Place from, const Place& to);

/// The address of `levels` levels that starts with `start` and from there always takes the child of least slope: ground
/// that is flat at every scale, where slope, a random walk over the octaves, stays small (of interest for hurst 1000).
/// 0.4 us a level. @throws Error (BadInput) beyond Address::kMaxLevels.
Address flatSeekingAddress(const Shape& shape, Address start, std::int64_t levels);

/// The digit of the child with the least slope.
int flattestChild(const Shape& shape, const Cell& cell);

/// Mean slope of a cell by its corners [cells of height per cell].
double slopeOf(const Cell& cell);

/// Vertical scale for a picture at a depth between levels: by what heights [cells of `level`] are multiplied so that
/// self-affine terrain looks alike at any zoom, without a jump where a level changes the unit. 1 where hurst is 1000.
/// @param zoom the depth that the picture is about [levels], near `level`
double verticalScale(const Shape& shape, std::int64_t level, double zoom);

} // namespace apeiron::terrain
