#include "certified_contact.h"
#include "motion_checks.h"
#include "uniaxial_gauge.h"

#include <ed/time_of_contact.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace ed {
namespace {

using geom::Ellipsoid;
using internal::Outcome;
using internal::Spheroid;

/// More points in time than any search has been seen to need by a factor of a thousand.
constexpr int kMaxEvaluations = 100000;

/// The axis about which both the shape and the inertia are symmetric.
int common_axis(const Ellipsoid& shape, const Motion& motion, const char* name) {
  const Eigen::Vector3d& a = shape.semi_axes();
  const Eigen::Vector3d& I = motion.inertia;
  for (const int axis : {2, 0, 1}) {
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    if (a[i] == a[j] && I[i] == I[j]) return axis;
  }
  std::ostringstream message;
  message << "body " << name << " with semi-axes [" << a.transpose() << "] and inertia [" << I.transpose()
          << "] has no axis of revolution; others are not available yet";
  throw std::invalid_argument(message.str());
}

struct Body {
  Spheroid shape;
  internal::TopMotion top;
};

Body make_body(const Ellipsoid& shape, const Motion& motion, const char* name) {
  internal::check_motion(motion);
  const int axis = common_axis(shape, motion, name);
  const double b = shape.semi_axes()[(axis + 1) % 3];
  return {Spheroid(shape.semi_axes()[axis], b, shape.min_curvature_radius()), internal::top_motion(motion, axis)};
}

ContactStatus status_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::contact:
      return ContactStatus::hit;
    case Outcome::clear:
      return ContactStatus::separated;
    case Outcome::overlapping:
      return ContactStatus::overlapping;
    case Outcome::bound:
      break;
  }
  return ContactStatus::failed;
}

template <bool kSpin>
ContactResult search(const Body& a, const Body& b, double reach, double t_max) {
  const double now = std::max(a.top.axis.time, b.top.axis.time);
  const Eigen::Vector3d r = b.top.axis.position_at(now) - a.top.axis.position_at(now);
  const internal::UniaxialGauge<kSpin> gauge(a.shape, a.top.axis, b.shape, b.top.axis, r, now, reach);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  internal::FinderCounters count;
  const internal::Finding finding = internal::certified_contact(gauge, now, t_max, kMaxEvaluations, n, count);
  ContactResult result;
  result.status = status_of(finding.outcome);
  result.time = finding.time;
  result.evaluations = static_cast<int>(count.evaluations);
  if (result.status == ContactStatus::hit) {
    const auto state = gauge.at(finding.time);
    const Eigen::Vector3d p_a =
        a.top.axis.position_at(finding.time) + geom::internal::support_point(a.shape, state.u_a, n);
    const Eigen::Vector3d p_b =
        a.top.axis.position_at(finding.time) + state.r - geom::internal::support_point(b.shape, state.u_b, n);
    result.point = 0.5 * (p_a + p_b);
    result.normal = n;
  }
  return result;
}

}  // namespace

const char* to_string(ContactStatus status) {
  switch (status) {
    case ContactStatus::hit:
      return "hit";
    case ContactStatus::separated:
      return "separated";
    case ContactStatus::overlapping:
      return "overlapping";
    case ContactStatus::failed:
      return "failed";
  }
  return "unknown";
}

ContactResult time_of_contact(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b,
                              double t_max) {
  const Body body_a = make_body(a, motion_a, "A");
  const Body body_b = make_body(b, motion_b, "B");
  if (!(t_max >= std::max(motion_a.time, motion_b.time))) {
    std::ostringstream message;
    message << "time_of_contact: t_max is " << t_max << "; accepted: at least the later of both motions' times";
    throw std::invalid_argument(message.str());
  }
  const double reach = a.bounding_radius() + b.bounding_radius();
  const bool spin = body_a.top.inertia.spins || body_b.top.inertia.spins;
  return spin ? search<true>(body_a, body_b, reach, t_max) : search<false>(body_a, body_b, reach, t_max);
}

}  // namespace ed
