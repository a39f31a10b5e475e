#include "terrain/flight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace apeiron::terrain {
namespace {

constexpr double kLeastClearance = 1.0; ///< [cells], below which the level is made deeper
constexpr double kMostClearance = 4.0;  ///< [cells]; well over twice the least, so that levels do not alternate
constexpr int kOctaves = 14;

constexpr double kGlide = -0.45;        ///< slope at which a dive approaches its target
constexpr double kGaze = -0.2;          ///< slope at which it looks ahead meanwhile, from that of the horizon
constexpr double kLowestGaze = -1.2;    ///< not straight down ...
constexpr double kHighestGaze = 0.6;    ///< ... nor up a wall
constexpr std::int64_t kAhead = 2;      ///< levels below the place's that the target of a dive is at
constexpr double kFarthestTarget = 8.0; ///< [cells]; a wall is in between: another one is looked for

double partOf(double speed, double seconds) {
    return 1.0 - std::exp(-std::max(0.0, speed * seconds));
}

} // namespace

double scalePower(double level) {
    return -level * std::log10(2.0);
}

Flight::Flight(Place place, const glm::dquat& orientation, double relief)
    : place_(std::move(place)), orientation_(glm::normalize(orientation)), ownRelief_(relief),
      zoom_(static_cast<double>(place_.level())), clearance_(selection_.clearance(place_, relief, kOctaves)) {
    if (clearance_ > 0.0) zoom_ -= std::log2(clearance_);
    ownRelief_ = relief / verticalScale(place_.shape(), place_.level(), zoom_);
}

double Flight::relief() const {
    return ownRelief_ * verticalScale(place_.shape(), place_.level(), zoom_);
}

void Flight::measure() {
    clearance_ = selection_.clearance(place_, relief(), kOctaves);
}

void Flight::look(double yaw, double pitch, double roll) {
    orientation_ =
        glm::normalize(orientation_ * glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) *
                       glm::angleAxis(pitch, glm::dvec3(1, 0, 0)) * glm::angleAxis(roll, glm::dvec3(0, 0, 1)));
}

void Flight::fitLevel() {
    while (clearance_ > 0.0 && clearance_ < kLeastClearance && place_.level() < Address::kMaxLevels) {
        place_.descend();
        clearance_ *= 2.0;
    }
    while (clearance_ > kMostClearance && place_.level() > 0) {
        place_.ascend();
        clearance_ *= 0.5;
    }
    // The scale of heights follows the clearance smoothly; where the ground is does not depend on it.
    if (clearance_ > 0.0) zoom_ = static_cast<double>(place_.level()) - std::log2(clearance_);
}

void Flight::step(const glm::dvec3& direction, double length) {
    // The place has no relief: its heights are the terrain's own.
    glm::dvec3 offset = direction * length;
    offset.z /= relief();
    place_.move(offset);
    measure();
    fitLevel();
    measure();
}

void Flight::fly(const glm::dvec3& direction, double speed, double seconds) {
    const double length = glm::length(direction);
    if (!(length > 0.0)) return;
    target_.reset();
    step(orientation_ * (direction / length), partOf(speed, seconds) * clearance_);
}

void Flight::aim() {
    const Shape& shape = place_.shape();
    const auto isFar = [&] {
        return target_->level > place_.level() + 20 || target_->level < place_.level() - 4 ||
               glm::length(place_.toCell(*target_)) > kFarthestTarget;
    };
    const glm::dvec3 forward = orientation_ * glm::dvec3(0, 0, -1);
    const double level = std::hypot(forward.x, forward.y);
    const glm::dvec2 heading = level > 1e-6 ? glm::dvec2(forward) / level : glm::dvec2(0, 1);
    if (!target_ || isFar()) {
        // Some cells ahead, where a glide would end.
        const glm::dvec2 ahead = heading * std::min(kFarthestTarget / 4.0, clearance_ / -kGlide);
        const glm::dvec3 here = place_.position();
        target_ = place_.cellNear(place_.level(), static_cast<std::int64_t>(std::floor(here.x + ahead.x)),
                                  static_cast<std::int64_t>(std::floor(here.y + ahead.y)));
    }
    while (target_->level < place_.level() + kAhead) {
        // The child that is flat and lies well: not steeper below than the glide, nor aside.
        std::optional<Cell> best;
        double least = 0.0;
        for (int digit = 0; digit < 4; ++digit) {
            const Cell child = childCell(shape, *target_, digit);
            const glm::dvec3 way = place_.toCell(child) * glm::dvec3(1, 1, relief());
            const glm::dvec3 wanted = glm::normalize(glm::dvec3(heading, kGlide));
            const double aside = glm::length(way / std::max(glm::length(way), 1e-9) - wanted);
            const double badness = slopeOf(child) * relief() + aside;
            if (best && badness >= least) continue;
            best = child;
            least = badness;
        }
        target_ = best;
    }
}

void Flight::face(const glm::dvec3& direction, double part) {
    const glm::dvec3 backward = -glm::normalize(direction);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 0, 1), backward));
    const glm::dquat wanted = glm::quat_cast(glm::dmat3(right, glm::cross(backward, right), backward));
    orientation_ = glm::normalize(glm::slerp(orientation_, wanted, part));
}

double Flight::horizon(const glm::dvec2& heading) const {
    double highest = -std::numeric_limits<double>::infinity();
    for (std::int64_t up = 0; up <= 4 && up <= place_.level(); ++up) {
        // Two cells, of the place's own size or coarser ones, ahead: four to 64 clearances or so.
        const double edge = std::ldexp(1.0, static_cast<int>(up));
        const glm::dvec2 ahead = heading * (2.0 * std::max(1.0, clearance_));
        const Cell cell = place_.cellNear(place_.level() - up, std::llround(ahead.x), std::llround(ahead.y));
        const glm::dvec3 way = place_.toCell(cell);
        highest = std::max(highest, way.z * relief() / std::max(std::hypot(way.x, way.y), edge));
    }
    return highest;
}

void Flight::dive(double speed, double seconds) {
    if (clearance_ <= 0.0) return;
    aim();
    const glm::dvec3 way = place_.toCell(*target_) * glm::dvec3(1, 1, relief());
    const double distance = glm::length(way);
    if (distance <= 0.0) return;
    const double part = partOf(speed, seconds);
    // Looks ahead over the ground rather than down on it.
    const double flat = std::hypot(way.x, way.y);
    if (flat > 0.2 * distance) {
        const glm::dvec2 heading(way.x / flat, way.y / flat);
        face({heading.x, heading.y, std::clamp(horizon(heading) + kGaze, kLowestGaze, kHighestGaze)}, 0.25 * part);
    }
    step(way / distance, part * clearance_);
}

void Flight::rise(double speed, double seconds) {
    target_.reset();
    if (clearance_ <= 0.0) return;
    const glm::dvec3 backward = orientation_ * glm::dvec3(0, 0, 1);
    step(glm::normalize(glm::dvec3(0.3 * backward.x, 0.3 * backward.y, 1.0)), partOf(speed, seconds) * clearance_);
}

bool Flight::flyHome(const Place& home, double speed, double seconds) {
    if (place_.level() > home.level()) {
        rise(speed, seconds);
        return false;
    }
    target_.reset();
    // From here on at home's level, whatever the clearance.
    while (place_.level() < home.level())
        place_.descend();
    measure();
    const glm::dvec3 way = place_.to(home) * glm::dvec3(1, 1, relief());
    const double distance = glm::length(way);
    const double reach = partOf(speed, seconds) * clearance_;
    if (distance <= reach) {
        place_.moveTo(home);
        measure();
        return true;
    }
    glm::dvec3 offset = way * (reach / distance);
    offset.z /= relief();
    place_.move(offset);
    measure();
    return false;
}

} // namespace apeiron::terrain
