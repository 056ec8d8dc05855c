#include "bracketing_contact.h"
#include "certified_contact.h"
#include "contact_checks.h"
#include "motion_checks.h"
#include "uniaxial_gauge.h"

#include <ed/time_of_contact.h>

#include <algorithm>
#include <optional>
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
  Ellipsoid ellipsoid;  ///< the axis of revolution along body z
  internal::TopMotion top;
};

Body make_body(const Ellipsoid& shape, const Motion& motion, const char* name) {
  internal::check_motion(motion);
  const int axis = common_axis(shape, motion, name);
  const double b = shape.semi_axes()[(axis + 1) % 3];
  const double a = shape.semi_axes()[axis];
  return {Spheroid(a, b, shape.min_curvature_radius()), Ellipsoid({b, b, a}), internal::top_motion(motion, axis)};
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

/// Bodies that have further to go than this many sizes before they can touch are moved most of the way at once.
constexpr double kFar = 100;

/// Moves bodies that start far apart to shortly before their bounding spheres meet, and sets their clocks to 0 there;
/// returns by how much. What is rounded on a long way is then the place and the time where the search starts, once, and
/// not every distance on the way into the contact.
double skip_the_way(Body& a, Body& b, double reach, double duration) {
  const Eigen::Vector3d r = b.top.axis.position_at(0) - a.top.axis.position_at(0);
  const Eigen::Vector3d v = b.top.axis.velocity - a.top.axis.velocity;
  const internal::Window window = internal::sphere_window(r, v, reach, 0, 0, duration);
  const double speed = v.norm();
  if (!(window.begin < window.end) || !(window.begin * speed > kFar * reach)) return 0;
  const double way = window.begin - reach / speed;
  for (Body* body : {&a, &b}) {
    internal::advance(body->top.inertia, way, body->top.axis, body->top.frame);
    body->top.axis.time = 0;
  }
  return way;
}

/// The search from time 0 on the bodies' clocks.
ContactResult search(const Body& a, const Body& b, double reach, double duration, const ContactOptions& options) {
  const internal::AxisMotion& m_a = a.top.axis;
  const internal::AxisMotion& m_b = b.top.axis;
  const Eigen::Vector3d r = m_b.position_at(0) - m_a.position_at(0);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  internal::FinderCounters count;
  const auto certified = [&](const auto& gauge) {
    return internal::certified_contact(gauge, 0, duration, kMaxEvaluations, n, count);
  };
  internal::Finding finding;
  if (options.finder == Finder::bracketing) {
    std::optional<internal::Unsolved> unsolved;  // counted as rescues, which is all that is told
    finding = internal::bracketing_contact({a.ellipsoid, b.ellipsoid, m_a, m_b, r, 0}, 0, duration, options, n, count,
                                           unsolved);
  } else if (a.top.inertia.spins || b.top.inertia.spins) {
    finding = certified(internal::UniaxialGauge<true>(a.shape, m_a, b.shape, m_b, r, 0, reach));
  } else {
    finding = certified(internal::UniaxialGauge<false>(a.shape, m_a, b.shape, m_b, r, 0, reach));
  }
  ContactResult result;
  result.status = status_of(finding.outcome);
  result.time = finding.time;
  result.evaluations = static_cast<int>(count.evaluations);
  result.rescues = options.finder == Finder::bracketing ? static_cast<int>(count.rescues) : 0;
  if (result.status == ContactStatus::hit) {
    const double t = finding.time;
    const Eigen::Vector3d p_a = m_a.position_at(t) + geom::internal::support_point(a.shape, m_a.axis_at(t), n);
    const Eigen::Vector3d p_b = m_b.position_at(t) - geom::internal::support_point(b.shape, m_b.axis_at(t), n);
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
                              double t_max, const ContactOptions& options) {
  internal::check_contact_options(options, std::min(a.inscribed_radius(), b.inscribed_radius()));
  Body body_a = make_body(a, motion_a, "A");
  Body body_b = make_body(b, motion_b, "B");
  const double now = std::max(motion_a.time, motion_b.time);
  if (!(t_max >= now)) {
    std::ostringstream message;
    message << "time_of_contact: t_max is " << t_max << "; accepted: at least the later of both motions' times";
    throw std::invalid_argument(message.str());
  }
  // The search counts from 0: a clock that shows a long time has few digits left for the contact.
  body_a.top.axis.time -= now;
  body_b.top.axis.time -= now;
  const double reach = a.bounding_radius() + b.bounding_radius();
  const double way = skip_the_way(body_a, body_b, reach, t_max - now);
  const double duration = t_max - now - way;
  ContactResult result = search(body_a, body_b, reach, duration, options);
  result.time = result.status == ContactStatus::separated ? t_max : std::min(t_max, now + (way + result.time));
  return result;
}

}  // namespace ed
