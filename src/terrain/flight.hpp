#pragma once

#include "terrain/selection.hpp"

#include <optional>

namespace apeiron::terrain {

/// Power of ten of a length of one cell of that level, in cells of level 0: -level log10(2).
/// @param level may be between levels
double scalePower(double level);

/// A camera that flies over a terrain at any depth: without a limit, and without ever touching the ground.
///
/// A step goes (1 - e^(-speed seconds)) of the clearance at most, a lower bound of the distance to the ground: however
/// long it is aimed at the ground, it comes nearer for ever. The place's level follows, so that the clearance stays
/// around one to four cells.
class Flight {
  public:
    /// @param relief vertical scale of the terrain at first, > 0; that of self-affine terrain follows the depth
    explicit Flight(Place place, const glm::dquat& orientation = glm::dquat(1, 0, 0, 0), double relief = 1.0);

    const Place& place() const { return place_; }
    /// From camera space (x right, y up, z backward) to the world.
    const glm::dquat& orientation() const { return orientation_; }
    /// The vertical scale of now: self-affine terrain looks alike at any depth (see verticalScale()).
    double relief() const;
    /// Lower bound of the distance to the ground [cells of the place's level]; 0 under ground.
    double clearance() const { return clearance_; }

    /// Turns the view in place [rad]: yaw to the left, pitch up, roll counter-clockwise.
    void look(double yaw, double pitch, double roll);
    /// Flies on. @param direction in camera space; its length does not matter
    /// @param speed [clearances per second] @param seconds [s]
    void fly(const glm::dvec3& direction, double speed, double seconds);

    /// Dives by itself, for ever: glides towards flat ground ahead, which it looks for at every depth.
    void dive(double speed, double seconds);
    /// Rises by itself, backwards and up, until level 0.
    void rise(double speed, double seconds);
    /// Rises to the level of `home` and flies to exactly its point. @returns whether it is there
    /// @pre the same terrain; home is not far from the way that was flown
    bool flyHome(const Place& home, double speed, double seconds);

  private:
    /// Moves by at most a part of the clearance and makes the level fit. @param direction in the world, of length 1
    void step(const glm::dvec3& direction, double length);
    void fitLevel();
    void measure();
    void aim();
    void face(const glm::dvec3& direction, double part);
    /// Slope under which the highest ground ahead is seen. @param heading of length 1
    double horizon(const glm::dvec2& heading) const;

    Place place_;
    glm::dquat orientation_;
    double ownRelief_;    ///< relief() without verticalScale()
    double zoom_;         ///< the depth that the vertical scale is for [levels]
    Selection selection_; ///< for clearances: its cells are remembered
    double clearance_ = 0.0;
    std::optional<Cell> target_;
};

} // namespace apeiron::terrain
