#include "neighbours/general.h"

#include "base/periodic.h"
#include "contact/convex/features.h"
#include "neighbours/limits.h"
#include "neighbours/oriented_slack.h"

#include <geom/kernel/norm_body_pair.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::kernel::DualSample;
using geom::kernel::NormBodies;
using geom::kernel::NormBodyPair;

std::size_t slot(int i) {
  return static_cast<std::size_t>(i);
}

/// Returns an upper bound of the speed at which turning moves the surface.
double surface_speed(const GeneralBodies& bodies, int i) {
  return bodies.kind_of(i).lever * bodies.angular_speed_bound(i);
}

double worthwhile_time(const GeneralBodies& bodies, int i, double thickness) {
  return kWorthwhile * thickness / (bodies.velocity(i).norm() + surface_speed(bodies, i) + 1e-300);
}

/// Returns an upper bound of the angle of R R0^T: |R - R0| = sqrt(8) sin(angle / 2) in the Frobenius norm.
double angle_between(const Matrix3d& R, const Matrix3d& R0) {
  return angle_bound(std::sqrt(0.5 * (R - R0).squaredNorm()));
}

/// Returns whether two bodies may be within `limit` of each other; false is certain. `normal`: along r, then a better
/// one. `inscribed`: the sum of both inscribed radii. `elongated`: some body is; of others the cold normal is that
/// along r.
bool within(const NormBodyPair& pair, double inscribed, bool elongated, double limit, Vector3d& normal) {
  const Vector3d along = normal;
  const double apart = along.dot(pair.between());
  normal = pair.cold_normal();
  // The envelopes overlap, because the spheres within them do: no query is needed.
  if (apart - inscribed <= limit) return true;
  if (elongated) {
    const auto both_ways = geom::kernel::LaneVector::of(along, -along);
    if (apart - geom::kernel::sum(pair.bodies().heights(both_ways)) > limit) return false;
  }
  // A few Newton steps at the most; a pair that is still undecided is taken, which is always safe.
  DualSample sample = pair.sample(normal);
  for (int step = 0; step < 3; ++step) {
    if (sample.g > limit) return false;
    const NormBodyPair::Step newton = pair.newton_step(sample);
    if (!newton.lifted && sample.g + newton.decrement <= limit) break;
    if (!pair.advance(sample, newton)) break;
  }
  normal = sample.n;
  return !(sample.g > limit);
}

/// Returns the same as within(), for any shapes.
bool any_within(const PlacedPair& pair, double limit, Vector3d& normal) {
  const double cores = limit + pair.a.ball + pair.b.ball;
  const ClosestFeatures closest =
      closest_features(pair, normal, [&](double lower, double upper) { return lower > cores || upper <= cores; });
  if (closest.end == ClosestFeatures::End::inside || !(closest.n.squaredNorm() > 0)) return true;
  normal = closest.n;
  return !(closest.lower > cores);
}

}  // namespace

GeneralDilatedEnvelopes::GeneralDilatedEnvelopes(const GeneralBodies& bodies, double thickness, double exit_thickness)
    : bodies_(&bodies), thickness_(thickness), exit_thickness_(exit_thickness), places_(slot(bodies.number())) {}

void GeneralDilatedEnvelopes::place(int i, const GeneralBodies& bodies, double now) {
  places_[slot(i)] = {bodies.position_at(i, now), bodies.rotation_at(i, now)};
}

void GeneralDilatedEnvelopes::scale(double factor) {
  for (EnvelopePose& place : places_) place.centre *= factor;
}

double GeneralDilatedEnvelopes::exit_time(int i, const GeneralBodies& bodies, double now, double box) const {
  const EnvelopePose& place = places_[slot(i)];
  const Vector3d d = nearest_image(bodies.position_at(i, now) - place.centre, box);
  const double lever = bodies.kind_of(i).lever;
  const double left = exit_thickness_ - lever * angle_between(bodies.rotation_at(i, now), place.rotation);
  const double d2 = d.squaredNorm();
  if (!(left > 0) || d2 >= left * left) return now;
  // First root of |d + v s| + w s = left, w the fastest that turning can move the surface.
  const double w = surface_speed(bodies, i);
  const Vector3d& v = bodies.velocity(i);
  const double A = v.squaredNorm() - w * w;
  const double B = d.dot(v) + left * w;
  const double C = d2 - left * left;
  const double denominator = B + std::sqrt(std::max(0.0, B * B - A * C));
  return denominator > 0 ? now - C / denominator : kNever;
}

double GeneralDilatedEnvelopes::worthwhile(int i, const GeneralBodies& bodies) const {
  return worthwhile_time(bodies, i, exit_thickness_);
}

bool GeneralDilatedEnvelopes::may_overlap(int i, int k, const Vector3d& r, Vector3d& normal) const {
  const GeneralKind& a = bodies_->kind_of(i);
  const GeneralKind& b = bodies_->kind_of(k);
  const double limit = 2 * thickness_;
  const double r2 = r.squaredNorm();
  const double size = a.bounding_radius + b.bounding_radius;
  if (r2 > (size + limit) * (size + limit)) return false;
  normal = r2 > 0 ? Vector3d(r / std::sqrt(r2)) : Vector3d::UnitX();
  const Matrix3d& R_a = places_[slot(i)].rotation;
  const Matrix3d& R_b = places_[slot(k)].rotation;
  const std::optional<NormBodyShape>& norm_a = a.body.norm;
  const std::optional<NormBodyShape>& norm_b = b.body.norm;
  if (!norm_a || !norm_b) return any_within({a.body.convex, b.body.convex, R_a, R_b, r, size}, limit, normal);
  const NormBodyPair pair(NormBodies(norm_a->norm, R_a, norm_b->norm, R_b), r, size,
                          a.inscribed_radius + b.inscribed_radius);
  const auto elongated = [](const NormBodyShape& shape) {
    const Vector3d& axes = shape.norm.semi_axes;
    return axes.x() != axes.y() || axes.y() != axes.z();
  };
  return within(pair, a.inscribed_radius + b.inscribed_radius, elongated(*norm_a) || elongated(*norm_b), limit, normal);
}

double thickest_oriented_envelope(const GeneralBodies& bodies, double box) {
  std::vector<BodyShape> shapes;
  for (const GeneralKind& kind : bodies.kinds()) shapes.push_back(kind.body.convex.shape);
  double low = kThinnestOriented * bodies.inscribed_radius();
  const double least = smallest_oriented_box(shapes, low);
  if (box < least * (1 - 1e-12)) {
    std::ostringstream message;
    message << "neighbours = \"obp\": a periodic box of edge " << box
            << " is too short for boxes around bodies that can turn inside them; accepted: at least " << least
            << ", or \"dilated\"";
    throw std::invalid_argument(message.str());
  }
  double high = box;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (smallest_oriented_box(shapes, middle) < box ? low : high) = middle;
  }
  return low;
}

GeneralOrientedEnvelopes::GeneralOrientedEnvelopes(const GeneralBodies& bodies, double thickness)
    : thickness_(thickness), reach_(0), boxes_(slot(bodies.number())) {
  for (const GeneralKind& kind : bodies.kinds()) {
    const double diagonal = (kind.half_extents.array() + thickness).matrix().norm();
    reach_ = std::max(reach_,
                      2 * std::min(diagonal, kind.bounding_radius + oriented_slack(kind.body.convex.shape, thickness)));
  }
}

void GeneralOrientedEnvelopes::place(int i, const GeneralBodies& bodies, double now) {
  boxes_[slot(i)] = {bodies.position_at(i, now), bodies.rotation_at(i, now),
                     Vector3d(bodies.kind_of(i).half_extents.array() + thickness_)};
}

void GeneralOrientedEnvelopes::scale(double factor) {
  for (geom::OrientedBox& box : boxes_) box.centre *= factor;
}

/// Returns when the surface, at its highest speed along each normal, would have crossed one of the six planes.
double GeneralOrientedEnvelopes::exit_time(int i, const GeneralBodies& bodies, double now, double box) const {
  const geom::OrientedBox& envelope = boxes_[slot(i)];
  const BodyShape& shape = bodies.kind_of(i).body.convex.shape;
  const Vector3d d = nearest_image(bodies.position_at(i, now) - envelope.centre, box);
  const Matrix3d R = bodies.rotation_at(i, now);
  const double w = surface_speed(bodies, i);
  double earliest = kNever;
  for (int k = 0; k < 3; ++k) {
    const Vector3d n = envelope.axes.col(k);
    const Vector3d n_body = transposed_product(R, n);
    for (const double side : {1.0, -1.0}) {
      const double room = envelope.half_extents[k] - side * n.dot(d) - support(shape, side * n_body).height;
      const double speed = side * n.dot(bodies.velocity(i)) + w;
      if (room <= 0) return now;
      if (speed > 0) earliest = std::min(earliest, now + room / speed);
    }
  }
  return earliest;
}

double GeneralOrientedEnvelopes::worthwhile(int i, const GeneralBodies& bodies) const {
  return worthwhile_time(bodies, i, thickness_);
}

bool GeneralOrientedEnvelopes::may_overlap(int i, int k, const Vector3d& r, Vector3d& normal) const {
  const geom::OrientedBox& a = boxes_[slot(i)];
  geom::OrientedBox b = boxes_[slot(k)];
  b.centre = a.centre + r;
  if (!geom::boxes_meet(a, b)) return false;
  normal = r.squaredNorm() > 0 ? Vector3d(r.normalized()) : Vector3d::UnitX();
  return true;
}

}  // namespace ed::internal
