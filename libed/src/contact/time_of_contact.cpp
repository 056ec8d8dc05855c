#include "contact/body_shapes.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "contact/checks.h"
#include "contact/pair_gaps.h"
#include "contact/swept_hull.h"
#include "contact/uniaxial_gap.h"
#include "motion/checks.h"

#include <ed/time_of_contact.h>
#include <ed/tolerances.h>

#include <geom/tolerances.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <variant>

namespace ed {
namespace {

using geom::Ellipsoid;
using internal::Outcome;
using internal::Spheroid;

/// Returns the axis about which both the shape and the inertia are symmetric, or -1.
int common_axis(const Ellipsoid& shape, const Motion& motion) {
  const Eigen::Vector3d& a = shape.semi_axes();
  const Eigen::Vector3d& I = motion.inertia;
  for (const int axis : {2, 0, 1}) {
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    if (a[i] == a[j] && I[i] == I[j]) return axis;
  }
  return -1;
}

/// A body of revolution.
struct UniaxialBody {
  Spheroid shape;
  Ellipsoid ellipsoid;  ///< the axis of revolution along body z
  internal::TopMotion top;

  Eigen::Vector3d position_at(double t) const { return top.axis.position_at(t); }
  const Eigen::Vector3d& velocity() const { return top.axis.velocity; }
  void rebase(double now) { top.axis.time -= now; }
  /// Moves the body to time t of its clock, which then shows 0.
  void restart_at(double t) {
    internal::advance(top.inertia, t, top.axis, top.frame);
    top.axis.time = 0;
  }
};

UniaxialBody uniaxial_body(const Ellipsoid& shape, const Motion& motion) {
  const int axis = common_axis(shape, motion);
  const double b = shape.semi_axes()[(axis + 1) % 3];
  const double a = shape.semi_axes()[axis];
  return {Spheroid(a, b, shape.min_curvature_radius()), Ellipsoid({b, b, a}), internal::top_motion(motion, axis)};
}

/// Any other.
struct GeneralBody {
  internal::GapShape body;
  internal::RigidMotion motion;
  Eigen::Vector3d inertia;

  Eigen::Vector3d position_at(double t) const { return motion.position_at(t); }
  const Eigen::Vector3d& velocity() const { return motion.velocity; }
  void rebase(double now) { motion.time -= now; }
  void restart_at(double t) {
    const internal::TopState top = motion.top.at(t - motion.time);
    motion.position = motion.position_at(t);
    motion.top = internal::FreeTop(inertia, top.R, top.omega);
    motion.time = 0;
  }
};

GeneralBody general_body(const BodyShape& shape, const Motion& motion) {
  internal::check_exponents(shape);
  return {internal::GapShape(shape),
          {motion.pose.position(), motion.velocity,
           internal::FreeTop(motion.inertia, motion.pose.rotation(), motion.angular_velocity), motion.time},
          motion.inertia};
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
      return ContactStatus::budget_exhausted;
    case Outcome::declined:
      break;
  }
  return ContactStatus::failed;
}

/// Bodies that have further to go than this many sizes before they can touch are moved most of the way at once.
constexpr double kFar = 100;

/// Moves bodies that start far apart to shortly before their bounding spheres meet, and sets their clocks to 0 there;
/// returns by how much. What is rounded on a long way is then the place and the time where the search starts, once, and
/// not every distance on the way into the contact.
template <class Body>
double skip_the_way(Body& a, Body& b, double reach, double duration) {
  const Eigen::Vector3d r = b.position_at(0) - a.position_at(0);
  const Eigen::Vector3d v = b.velocity() - a.velocity();
  const internal::Window window = internal::sphere_window(r, v, reach, 0.0, 0.0, duration);
  const double speed = v.norm();
  if (!(window.begin < window.end) || !(window.begin * speed > kFar * reach)) return 0;
  const double way = window.begin - reach / speed;
  a.restart_at(way);
  b.restart_at(way);
  return way;
}

ContactResult result_of(const internal::Finding& finding, const internal::FinderCounters& count) {
  ContactResult result;
  result.status = status_of(finding.outcome);
  result.time = finding.time;
  result.evaluations = static_cast<int>(count.evaluations);
  return result;
}

/// Does the certified search from time 0 on the bodies' clocks, within a budget of evaluations. It is interrupted now
/// and then, the earlier the first time: bodies that turn or slide without getting nearer would take it all, and are
/// moved on to where the hulls of what they sweep meet. `hulls()` makes these, once they are asked for.
template <class PairGap, class Hulls>
internal::Finding budgeted_contact(const PairGap& gap, double duration, int budget, const Hulls& hulls,
                                   Eigen::Vector3d& n, internal::FinderCounters& count) {
  constexpr int kFirstLooks = 32;
  constexpr int kMostLooks = 512;
  constexpr double kFutile = 0.1;  // there is no horizon here but t_max: steps fit a radian or so sooner than in a run
  std::optional<internal::SweptPair> swept;
  double t = 0;
  for (int looks = kFirstLooks; static_cast<int>(count.evaluations) < budget; looks = std::min(2 * looks, kMostLooks)) {
    const int left = budget - static_cast<int>(count.evaluations);
    const internal::Finding finding =
        internal::certified_contact(gap, t, duration, std::min(looks, left), n, count, kFutile);
    if (finding.outcome != Outcome::bound) return finding;
    t = finding.time;
    if (!swept) swept = hulls();
    const auto state = gap.at(t);
    const auto e = gap.evaluate(state, n);
    const bool touching = e.g <= state.rounding.gap;
    // Bodies that touch and approach are the search's: the next look tells.
    if (touching && internal::contact_rate(gap, state, e, n) < -kResting * gap.speed()) continue;
    t = std::max(t, swept->clear_until(t, n, state.rounding.gap, touching));
    if (!(t < duration)) return {Outcome::clear, duration};
  }
  return {Outcome::bound, t};
}

/// Does the search from time 0 on the bodies' clocks.
ContactResult search(const UniaxialBody& a, const UniaxialBody& b, double reach, double duration,
                     const ContactOptions& options) {
  const internal::AxisMotion& m_a = a.top.axis;
  const internal::AxisMotion& m_b = b.top.axis;
  const Eigen::Vector3d r = m_b.position_at(0) - m_a.position_at(0);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  internal::FinderCounters count;
  const auto hulls = [&] {
    return internal::SweptPair{internal::SweptHull(a.shape, m_a), internal::SweptHull(b.shape, m_b), r,
                               m_b.velocity - m_a.velocity, reach};
  };
  const auto certified = [&](const auto& gap) {
    return budgeted_contact(gap, duration, options.max_evaluations, hulls, n, count);
  };
  internal::Finding finding;
  if (options.finder == Finder::bracketing) {
    std::optional<internal::Unsolved> unsolved;  // counted as rescues, which is all that is told
    finding = internal::bracketing_contact({a.ellipsoid, b.ellipsoid, m_a, m_b, r, 0}, 0, duration, options, n, count,
                                           unsolved);
  } else if (a.top.inertia.spins || b.top.inertia.spins) {
    finding = certified(internal::UniaxialGap<true>(a.shape, m_a, b.shape, m_b, r, 0, reach));
  } else {
    finding = certified(internal::UniaxialGap<false>(a.shape, m_a, b.shape, m_b, r, 0, reach));
  }
  ContactResult result = result_of(finding, count);
  result.rescues = options.finder == Finder::bracketing ? static_cast<int>(count.rescues) : 0;
  if (result.status == ContactStatus::hit) {
    const double t = finding.time;
    const Eigen::Vector3d p_a = m_a.position_at(t) + geom::kernel::support_point(a.shape, m_a.axis_at(t), n);
    const Eigen::Vector3d p_b = m_b.position_at(t) - geom::kernel::support_point(b.shape, m_b.axis_at(t), n);
    result.point = 0.5 * (p_a + p_b);
    result.normal = n;
  }
  return result;
}

/// Searches by `find(n, count)`, a certified search or the paper's, and returns its result.
template <class PairGap, class Find>
ContactResult general_search(const PairGap& gap, const GeneralBody& a, const Find& find) {
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  internal::FinderCounters count;
  const internal::Finding finding = find(n, count);
  ContactResult result = result_of(finding, count);
  if (result.status != ContactStatus::hit) return result;
  result.point = a.position_at(finding.time) + gap.contact_points(gap.at(finding.time), n).a;
  result.normal = n;
  return result;
}

ContactResult search(const GeneralBody& a, const GeneralBody& b, double reach, double duration,
                     const ContactOptions& options) {
  const Eigen::Vector3d r = b.position_at(0) - a.position_at(0);
  const auto hulls = [&] {
    return internal::SweptPair{internal::SweptHull(a.body.convex.shape, a.motion, a.inertia),
                               internal::SweptHull(b.body.convex.shape, b.motion, b.inertia), r,
                               b.velocity() - a.velocity(), reach};
  };
  const auto certified = [&](const auto& gap) {
    return general_search(gap, a, [&](Eigen::Vector3d& n, internal::FinderCounters& count) {
      return budgeted_contact(gap, duration, options.max_evaluations, hulls, n, count);
    });
  };
  const auto with_gap = [&](const auto& f) {
    return internal::with_pair_gap(a.body, a.motion, b.body, b.motion, r, 0, f);
  };
  if (options.finder == Finder::certified) return with_gap(certified);
  std::uint64_t rescues = 0;
  const auto bracketing = [&](Eigen::Vector3d& n, internal::FinderCounters& count) {
    std::optional<internal::Unsolved> unsolved;
    const internal::Finding finding = internal::bracketing_contact(
        {*a.body.implicit, *b.body.implicit, a.motion, b.motion, r, 0}, 0, duration, options, n, count, unsolved);
    rescues = count.rescues;
    return finding;
  };
  ContactResult result = with_gap([&](const auto& gap) { return general_search(gap, a, bracketing); });
  result.rescues = static_cast<int>(rescues);
  return result;
}

/// Does the search on clocks that count from 0: one that shows a long time has few digits left for the contact.
template <class Body>
ContactResult search_from(double now, Body a, Body b, double reach, double t_max, const ContactOptions& options) {
  a.rebase(now);
  b.rebase(now);
  const double way = skip_the_way(a, b, reach, t_max - now);
  ContactResult result = search(a, b, reach, t_max - now - way, options);
  result.time = result.status == ContactStatus::separated ? t_max : std::min(t_max, now + (way + result.time));
  return result;
}

/// Throws std::invalid_argument if the body is too far away at the time when the search begins.
void check_position(const Motion& motion, double now) {
  const Eigen::Vector3d p = motion.pose.position() + (now - motion.time) * motion.velocity;
  if (p.cwiseAbs().maxCoeff() <= geom::kMaxCoordinate) return;
  std::ostringstream message;
  message << "time_of_contact: the position at time " << now << ", the later of both motions' times, is ("
          << p.transpose() << "); accepted: none beyond +-" << geom::kMaxCoordinate;
  throw std::invalid_argument(message.str());
}

/// Returns the later of both motions' times.
double checked_begin(const Motion& motion_a, const Motion& motion_b, double t_max) {
  internal::check_motion(motion_a);
  internal::check_motion(motion_b);
  const double now = std::max(motion_a.time, motion_b.time);
  check_position(motion_a, now);
  check_position(motion_b, now);
  if (t_max >= now) return now;
  std::ostringstream message;
  message << "time_of_contact: t_max is " << t_max << "; accepted: at least the later of both motions' times";
  throw std::invalid_argument(message.str());
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
    case ContactStatus::budget_exhausted:
      return "budget_exhausted";
    case ContactStatus::failed:
      return "failed";
  }
  return "unknown";
}

const char* to_string(Finder finder) {
  switch (finder) {
    case Finder::certified:
      return "certified";
    case Finder::bracketing:
      return "bracketing";
  }
  return "unknown";
}

const char* to_string(DistanceMethod method) {
  switch (method) {
    case DistanceMethod::dual:
      return "dual";
    case DistanceMethod::newton8:
      return "newton8";
    case DistanceMethod::newton5:
      return "newton5";
  }
  return "unknown";
}

const char* to_string(ContactRoot root) {
  switch (root) {
    case ContactRoot::newton:
      return "newton";
    case ContactRoot::one_dimensional:
      return "one_dimensional";
  }
  return "unknown";
}

ContactResult time_of_contact(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b,
                              double t_max, const ContactOptions& options) {
  internal::check_contact_options(options, std::min(a.inscribed_radius(), b.inscribed_radius()));
  const double now = checked_begin(motion_a, motion_b, t_max);
  const double reach = a.bounding_radius() + b.bounding_radius();
  if (common_axis(a, motion_a) >= 0 && common_axis(b, motion_b) >= 0) {
    return search_from(now, uniaxial_body(a, motion_a), uniaxial_body(b, motion_b), reach, t_max, options);
  }
  return search_from(now, general_body(a, motion_a), general_body(b, motion_b), reach, t_max, options);
}

ContactResult time_of_contact(const BodyShape& a, const Motion& motion_a, const BodyShape& b, const Motion& motion_b,
                              double t_max, const ContactOptions& options) {
  const auto* ellipsoid_a = std::get_if<Ellipsoid>(&a);
  const auto* ellipsoid_b = std::get_if<Ellipsoid>(&b);
  if (ellipsoid_a != nullptr && ellipsoid_b != nullptr) {
    return time_of_contact(*ellipsoid_a, motion_a, *ellipsoid_b, motion_b, t_max, options);
  }
  internal::check_contact_options(options, std::min(inscribed_radius(a), inscribed_radius(b)));
  for (const BodyShape* shape : {&a, &b}) internal::check_finder(options, *shape);
  const double now = checked_begin(motion_a, motion_b, t_max);
  return search_from(now, general_body(a, motion_a), general_body(b, motion_b), bounding_radius(a) + bounding_radius(b),
                     t_max, options);
}

}  // namespace ed
