#pragma once

#include "parameter/node.hpp"

#include <span>

namespace apeiron::scene {

/// The camera of a scene: a typed view of its node that knows how it moves.
///
/// The world is right-handed with +z up. Camera space is OpenGL's: +x right, +y up, looking along -z; `orientation`
/// turns camera space into world space. Positions are decimals of any length: no move loses digits.
///
/// Node parameters: `mode` {orbit, free}; `position` (Decimal3); `target` (Decimal3), `up` (vec3) and `roll` [deg]
/// decide the orientation in orbit mode; `orientation` (vec4 quaternion x y z w) does in free mode; `fov` vertical
/// [deg]; `projection` {perspective, orthographic}; `aperture`, `focus` and `blades` of the lens.
class Camera {
  public:
    /// @pre node.type().role == "camera"
    explicit Camera(parameter::Node node);

    const parameter::Node& node() const { return node_; }

    bool orbiting() const;
    const parameter::Decimal3& position() const;
    const parameter::Decimal3& target() const;
    /// Camera to world. In orbit mode looks at the target with `up` upwards; when these are parallel or
    /// the target is at the position, a fixed other axis takes up's place.
    glm::dquat orientation() const;
    glm::dvec3 forward() const;
    glm::dvec3 right() const;
    glm::dvec3 up() const;
    double fov() const; ///< vertical [rad]
    /// Height of the picture at distance 1 in perspective, anywhere in parallel projection [world units].
    double extent() const;
    /// From position to target [world units], computed without cancellation at any zoom.
    double distance() const;
    /// From the camera to the plane that is sharp, along the view direction [world units]: `focus`, or distance() where
    /// that is 0.
    double focus() const;
    /// Makes the plane sharp in which something lies that is seen at a point of the picture: from (-1, -1), the bottom
    /// left, to (1, 1). @param distance to it along the ray through that point [world units] @param aspect of the
    /// picture: width / height
    void focusOn(double distance, glm::dvec2 place, double aspect);

    /// Moves to where a sphere fills the picture and aims at its centre. @param aspect of the picture: width / height
    /// @param front direction from the centre to the camera; 0: where it is looked from now @pre radius > 0
    void frame(const glm::dvec3& center, double radius, double aspect, const glm::dvec3& front = glm::dvec3(0.0));

    /// Moves to where all points just fit into the picture and aims at their middle in it.
    /// @param points from `center` [world units], at least one @param front direction from the centre to the camera,
    /// not 0
    void frame(const glm::dvec3& center, std::span<const glm::dvec3> points, double aspect, const glm::dvec3& front);

    /// Turns around the target: positive yaw moves the camera to its right, positive pitch up [rad]. Stays clear
    /// of the poles. In free mode the target is first put `distance()` ahead, `roll` becomes what the free
    /// orientation has, and the mode becomes orbit: the picture does not jump.
    void orbit(double yaw, double pitch);
    /// Multiplies the distance to the target. In free mode that moves the camera forward by (1 - factor) * distance()
    /// and first puts the target ahead, so that distance() is always the scale of moves. @pre factor > 0
    void zoom(double factor);
    /// Moves position and target together in the picture plane, in fractions of the picture height at the target.
    void pan(double right, double up);
    /// Flies by an offset in camera space [world units] (x right, y up, z backwards), together with the target; the
    /// mode becomes free.
    void fly(const glm::dvec3& offset);
    /// Turns the view in place [rad]: yaw to the left, pitch up, roll counter-clockwise; the mode becomes free and the
    /// target stays ahead.
    void look(double yaw, double pitch, double roll);

  private:
    void makeFree();
    void makeOrbit();
    void aimTarget();

    parameter::Node node_;
};

} // namespace apeiron::scene
