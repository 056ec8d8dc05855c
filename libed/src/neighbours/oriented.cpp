#include "neighbours/oriented.h"

#include "base/periodic.h"
#include "contact/certified.h"
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

}  // namespace

double thickest_oriented_envelope(const Spheroid& shape, double bounding_radius, double box) {
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

double thickest_oriented_envelope(const UniaxialBodies& bodies, double box) {
  double thickest = box;
  for (const UniaxialKind& kind : bodies.kinds()) {
    thickest = std::min(thickest, thickest_oriented_envelope(kind.shape, bodies.bounding_radius(), box));
  }
  return thickest;
}

OrientedEnvelopes::OrientedEnvelopes(const UniaxialBodies& bodies, double thickness)
    : thickness_(thickness), boxes_(static_cast<std::size_t>(bodies.number())) {
  for (const UniaxialKind& kind : bodies.kinds()) add_kind(kind.shape, kind.bounding_radius, kind.inertia.spins);
  for (int i = 0; i < bodies.number(); ++i) kind_.push_back(bodies.kind_index(i));
}

OrientedEnvelopes::OrientedEnvelopes(int number, const Spheroid& shape, double bounding_radius, double thickness,
                                     bool spins)
    : thickness_(thickness), kind_(static_cast<std::size_t>(number), 0), boxes_(static_cast<std::size_t>(number)) {
  add_kind(shape, bounding_radius, spins);
}

void OrientedEnvelopes::add_kind(const Spheroid& shape, double bounding_radius, bool spins) {
  kinds_.push_back({shape, bounding_radius, spins, half_extents(shape, thickness_)});
  reach_ = std::max(
      reach_, 2 * std::min(half_extents(shape, thickness_).norm(), bounding_radius + slack(shape, thickness_).norm()));
}

void OrientedEnvelopes::place(int i, const UniaxialBodies& bodies, double now) {
  const AxisMotion& motion = bodies.axis_motion(i);
  place(i, motion.position_at(now), motion.axis_at(now), bodies.frame(i).x_axis);
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

double OrientedEnvelopes::exit_time(int i, const UniaxialBodies& bodies, double now, double box) const {
  const AxisMotion& motion = bodies.axis_motion(i);
  return exit_time(i, motion, motion.position_at(now), now, box);
}

double OrientedEnvelopes::exit_time(int i, const AxisMotion& motion, const Vector3d& position, double now,
                                    double box) const {
  const geom::OrientedBox& envelope = boxes_[static_cast<std::size_t>(i)];
  const Vector3d here = envelope.centre + nearest_image(position - envelope.centre, box);
  return kind_of(i).spins ? exit<true>(i, motion, here, now) : exit<false>(i, motion, here, now);
}

double OrientedEnvelopes::crossing_time(const Kind& kind, const AxisMotion& motion) const {
  const double surface_speed = std::abs(std::sqrt(kind.shape.a2) - std::sqrt(kind.shape.b2)) * motion.rate;
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
  normal = geom::kernel::cold_normal(kind_of(i).shape, kind_of(k).shape, r, a.axes.col(2), b.axes.col(2));
  return true;
}

}  // namespace ed::internal
