#include "neighbours/oriented.h"

#include "base/periodic.h"
#include "contact/certified.h"
#include "contact/first_root.h"
#include "contact/plane_gap.h"
#include "neighbours/limits.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using geom::kernel::Spheroid;

/// Looks at each plane when a body's exit is predicted; a bound that is not final is renewed when it comes up.
constexpr int kLooks = 2;

/// Longest time ahead for which an exit is predicted, in units of the time in which the surface can cross the
/// thickness. The exit is predicted again then.
constexpr double kHorizon = 10;

Vector3d half_extents(const Spheroid& shape, double thickness) {
  const double b = std::sqrt(shape.b2) + thickness;
  return {b, b, std::sqrt(shape.a2) + thickness};
}

/// Returns how far a body's centre can be from that of its box while it stays inside, along each of the box's axes.
///
/// Along axis e_k the centre is within extent_k - h(e_k, u). The squares of the three h add up to a^2 + 2 b^2 whatever
/// u, and none exceeds its extent, which bounds each from below by what the other two leave; min(a, b) does too.
Vector3d slack(const Spheroid& shape, double thickness) {
  const Vector3d extents = half_extents(shape, thickness);
  const double trace = shape.a2 + 2 * shape.b2;
  const double least2 = std::min(shape.a2, shape.b2);
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    const double others = extents.squaredNorm() - extents[k] * extents[k];
    result[k] = extents[k] - std::sqrt(std::max(least2, trace - others));
  }
  return result;
}

Vector3d half_extents(const Rod& rod, double thickness) {
  const double across = rod.radius + thickness;
  return {across, across, across + rod.half_length};
}

/// Returns the same of a rod: the squares of the three heights of its axis, |u_k| times the half-length, add up to that
/// of the half-length.
Vector3d slack(const Rod& rod, double thickness) {
  const Vector3d extents = half_extents(rod, thickness);
  const Vector3d heights = extents.array() - rod.radius;
  const double length2 = rod.half_length * rod.half_length;
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    const double others = heights.squaredNorm() - heights[k] * heights[k];
    result[k] = heights[k] - std::sqrt(std::max(0.0, length2 - others));
  }
  return result;
}

}  // namespace

template <class Shape>
static double thickest_envelope_of(const Shape& shape, double bounding_radius, double box) {
  // Bodies that touch while both are in their boxes have centres within 2 R; each centre moves by at most 2 |slack|
  // inside its box, so that before and after they are within 2 R + 4 |slack|, which must be below half the periodic
  // box.
  const double room = 0.25 * (0.5 * box - 2 * bounding_radius);
  double low = 0;
  double high = box;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (slack(shape, middle).norm() < room ? low : high) = middle;
  }
  return low;
}

double thickest_oriented_envelope(const Spheroid& shape, double bounding_radius, double box) {
  return thickest_envelope_of(shape, bounding_radius, box);
}

double thickest_oriented_envelope(const UniaxialBodies& bodies, double box) {
  double thickest = box;
  for (const UniaxialKind& kind : bodies.kinds()) {
    const double radius = bodies.bounding_radius();
    thickest = std::min(thickest, kind.is_rod ? thickest_envelope_of(kind.rod, radius, box)
                                              : thickest_envelope_of(kind.shape, radius, box));
  }
  return thickest;
}

OrientedEnvelopes::OrientedEnvelopes(const UniaxialBodies& bodies, double thickness)
    : thickness_(thickness), boxes_(static_cast<std::size_t>(bodies.number())) {
  for (const UniaxialKind& kind : bodies.kinds()) {
    if (kind.is_rod) {
      add_rod(kind);
    } else {
      add_kind(kind.shape, kind.bounding_radius, kind.inertia.spins);
    }
  }
  for (int i = 0; i < bodies.number(); ++i) kind_.push_back(bodies.kind_index(i));
}

OrientedEnvelopes::OrientedEnvelopes(int number, const Spheroid& shape, double bounding_radius, double thickness,
                                     bool spins)
    : thickness_(thickness), kind_(static_cast<std::size_t>(number), 0), boxes_(static_cast<std::size_t>(number)) {
  add_kind(shape, bounding_radius, spins);
}

void OrientedEnvelopes::add_kind(const Spheroid& shape, double bounding_radius, bool spins) {
  const double axis_difference = std::abs(std::sqrt(shape.a2) - std::sqrt(shape.b2));
  kinds_.push_back({shape, {}, bounding_radius, axis_difference, false, spins, half_extents(shape, thickness_)});
  add_reach(half_extents(shape, thickness_), slack(shape, thickness_), bounding_radius);
}

void OrientedEnvelopes::add_rod(const UniaxialKind& kind) {
  const Rod& rod = kind.rod;
  kinds_.push_back({kind.shape, rod, kind.bounding_radius, rod.half_length, true, true, half_extents(rod, thickness_)});
  add_reach(half_extents(rod, thickness_), slack(rod, thickness_), kind.bounding_radius);
}

void OrientedEnvelopes::add_reach(const Vector3d& half_extents, const Vector3d& slack, double bounding_radius) {
  reach_ = std::max(reach_, 2 * std::min(half_extents.norm(), bounding_radius + slack.norm()));
}

void OrientedEnvelopes::place(int i, const UniaxialBodies& bodies, double now) {
  place(i, bodies.position_at(i, now), bodies.axis_at(i, now), bodies.frame(i).x_axis);
}

void OrientedEnvelopes::place(int i, const Vector3d& position, const Vector3d& axis, const Vector3d& x_axis) {
  geom::OrientedBox& box = boxes_[static_cast<std::size_t>(i)];
  box.centre = position;
  box.axes.col(0) = x_axis;
  box.axes.col(1) = axis.cross(x_axis);
  box.axes.col(2) = axis;
  box.half_extents = kind_of(i).half_extents;
}

void OrientedEnvelopes::scale(double factor) {
  for (geom::OrientedBox& box : boxes_) box.centre *= factor;
}

template <bool kSpin>
double OrientedEnvelopes::exit(int i, const AxisMotion& motion, const Vector3d& position, double now) const {
  const geom::OrientedBox& box = boxes_[static_cast<std::size_t>(i)];
  const Kind& kind = kind_of(i);
  FinderCounters count;
  double earliest = now + kHorizon * crossing_time(kind, motion);
  for (int k = 0; k < 3; ++k) {
    for (const double side : {1.0, -1.0}) {
      Vector3d n = side * box.axes.col(k);
      const double offset = n.dot(box.centre) + box.half_extents[k];
      const PlaneGap<kSpin> gap(kind.shape, motion, position, now, offset, kind.bounding_radius);
      const Finding finding = certified_contact(gap, now, earliest, kLooks, n, count);
      if (finding.outcome == Outcome::overlapping) return now;
      earliest = std::min(earliest, finding.time);
    }
  }
  return earliest;
}

/// Returns a lower bound of the time when a rod leaves: the balls at its ends, at p = r +- l u, whose distances from a
/// plane have no second derivative above l Omega^2.
double OrientedEnvelopes::rod_exit(int i, const AxisMotion& motion, const Vector3d& position, double now) const {
  const geom::OrientedBox& box = boxes_[static_cast<std::size_t>(i)];
  const Rod& rod = kind_of(i).rod;
  const double rate = motion.axis_rate();
  const double K = rod.half_length * (rate * rate);
  Vector3d u, du;
  turn<true>(motion, now, u, du);
  const Vector3d from_centre = position - box.centre;
  const double hidden = 64 * kRoundoff * (sum_of_magnitudes(position) + box.half_extents.sum());
  double earliest = kHorizon * crossing_time(kind_of(i), motion);
  for (int k = 0; k < 3; ++k) {
    const double room = box.half_extents[k] - rod.radius;
    for (const double end : {rod.half_length, -rod.half_length}) {
      const double at = box.axes.col(k).dot(from_centre + end * u);
      const double speed = box.axes.col(k).dot(motion.velocity + end * du);
      for (const double side : {1.0, -1.0}) {
        const double left = (room - side * at) - hidden;
        if (!(left > 0)) return now;
        earliest = std::min(earliest, first_root(left, -side * speed, K));
      }
    }
  }
  return now + earliest;
}

double OrientedEnvelopes::exit_time(int i, const UniaxialBodies& bodies, double now, double box) const {
  const AxisMotion& motion = bodies.axis_motion(i);
  return exit_time(i, motion, motion.position_at(now), now, box);
}

double OrientedEnvelopes::exit_time(int i, const AxisMotion& motion, const Vector3d& position, double now,
                                    double box) const {
  const geom::OrientedBox& envelope = boxes_[static_cast<std::size_t>(i)];
  const Vector3d here = envelope.centre + nearest_image(position - envelope.centre, box);
  if (kind_of(i).is_rod) return rod_exit(i, motion, here, now);
  return kind_of(i).spins ? exit<true>(i, motion, here, now) : exit<false>(i, motion, here, now);
}

double OrientedEnvelopes::crossing_time(const Kind& kind, const AxisMotion& motion) const {
  const double surface_speed = kind.axis_difference * motion.rate;
  return thickness_ / (motion.velocity.norm() + surface_speed + 1e-300);
}

double OrientedEnvelopes::worthwhile(int i, const AxisMotion& motion) const {
  return kWorthwhile * crossing_time(kind_of(i), motion);
}

bool OrientedEnvelopes::may_overlap(int i, int k, const Vector3d& r, Vector3d& normal) const {
  const geom::OrientedBox& a = boxes_[static_cast<std::size_t>(i)];
  geom::OrientedBox b = boxes_[static_cast<std::size_t>(k)];
  b.centre = a.centre + r;
  if (!geom::boxes_meet(a, b)) return false;
  if (kind_of(i).is_rod || kind_of(k).is_rod) {
    normal = r.squaredNorm() > 0 ? Vector3d(r.normalized()) : Vector3d(a.axes.col(2));
    return true;
  }
  normal = geom::kernel::cold_normal(kind_of(i).shape, kind_of(k).shape, r, a.axes.col(2), b.axes.col(2));
  return true;
}

}  // namespace ed::internal
