#include "base/console.h"
#include "base/errors.h"
#include "base/shapes.h"
#include "commands/commands.h"
#include "run/files/failure_file.h"

#include <ed/impulse.h>
#include <ed/motion.h>
#include <ed/time_of_contact.h>
#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/newton.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr int kStepsBefore = 5;
constexpr int kStepsAfter = 15;

/// Budget of the search (ContactOptions::max_evaluations): the pair may be one that exhausted the run's own budget.
constexpr int kReplayBudget = 100000;

std::string text(const Vector3d& v) {
  return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x(), v.y(), v.z());
}

struct Pair {
  ed::BodyShape a;
  ed::BodyShape b;
  ed::Motion motion_a;
  ed::Motion motion_b;

  /// Returns the pair at another time.
  Pair at(double t) const { return {a, b, ed::propagate(motion_a, t), ed::propagate(motion_b, t)}; }

  geom::DistanceResult distance() const { return ed::distance(a, motion_a.pose, b, motion_b.pose); }

  double size() const { return ed::bounding_radius(a) + ed::bounding_radius(b); }

  /// Returns a bound of the speed of any point of a body relative to the other body.
  double speed() const {
    return (motion_b.velocity - motion_a.velocity).norm() + motion_a.angular_velocity.norm() * ed::bounding_radius(a) +
           motion_b.angular_velocity.norm() * ed::bounding_radius(b);
  }
};

ed::ContactBody contact_body(const ed::Motion& motion, const Vector3d& point) {
  ed::ContactBody body;
  body.arm = point - motion.pose.position();
  body.velocity = motion.velocity;
  body.angular_velocity = motion.angular_velocity;
  return body;
}

/// Returns the rate of change of the distance: the relative normal velocity of the closest points.
double distance_rate(const Pair& pair, const geom::DistanceResult& d) {
  return ed::normal_velocity(contact_body(pair.motion_a, d.point_a), contact_body(pair.motion_b, d.point_b), d.normal);
}

std::string shape_text(const ed::BodyShape& shape) {
  const ShapeNumbers numbers = numbers_of(shape);
  if (!has_semi_axes(numbers.kind)) return ed::describe(shape);
  const Eigen::Vector2d& e = numbers.exponents;
  std::string axes = "semi-axes " + text(ed::half_extents(shape));
  if (!has_exponents(numbers.kind)) return axes;
  return fmt::format("{}, {}, exponents ({:.9g}, {:.9g})", to_string(numbers.kind), axes, e.x(), e.y());
}

std::string bodies(const Failure& failure, const Pair& pair) {
  const ed::FailedPair& failed = failure.pair;
  std::string out = fmt::format("reason: {}\n", failure.reason.empty() ? "none given" : failure.reason);
  for (const std::string& notice : failure.notices) out += fmt::format("notice: {}\n", notice);
  out += fmt::format("time {:.17g}, bodies {} (a) and {} (b)\n", failed.time, failed.i, failed.j);
  const auto add = [&](const char* name, const ed::BodyShape& shape, const ed::Motion& motion) {
    out += fmt::format("{}: {}, inertia {}\n   position {}\n   velocity {}\n   angular velocity {}\n", name,
                       shape_text(shape), text(motion.inertia), text(motion.pose.position()), text(motion.velocity),
                       text(motion.angular_velocity));
  };
  add("a", pair.a, pair.motion_a);
  add("b", pair.b, pair.motion_b);
  return out;
}

std::string distance_now(const Pair& pair) {
  const geom::DistanceResult d = pair.distance();
  std::string out = fmt::format("\nstep 1, distance at that time: {:.17g} ({}, {} iterations, residual {:.2g})\n",
                                d.distance, geom::to_string(d.status), d.iterations, d.residual);
  if (!std::isfinite(d.distance)) return out;
  out += fmt::format("   normal from a to b {}\n   closest point of a {}\n   closest point of b {}\n", text(d.normal),
                     text(d.point_a), text(d.point_b));
  return out + fmt::format("   the distance changes by {:.9g} a time unit\n", distance_rate(pair, d));
}

std::string value_of(const geom::DistanceResult& d) {
  return std::isfinite(d.distance) ? fmt::format("{:.17g}", d.distance) : "no answer";
}

/// Repeats the call that failed, bit for bit.
std::string failed_call(const ed::FailedPair& failed) {
  if (!failed.distance) return "";
  const ed::FailedDistance& call = *failed.distance;
  const bool eight = call.method == ed::DistanceMethod::newton8;
  const auto system = eight ? geom::NewtonSystem::eight : geom::NewtonSystem::five;
  const geom::DistanceResult d =
      geom::kernel::newton_distance_unchecked(call.shape_a, call.X_WA, call.shape_b, call.X_WB, system, call.seed);
  const std::string points = call.seed.status == geom::SeedStatus::usable
                                 ? fmt::format("{} and {}", text(call.seed.point_a), text(call.seed.point_b))
                                 : "no points";
  return fmt::format("   the call that failed, {} from {}: {} ({}, {} iterations; in the run: {})\n",
                     eight ? "newton8" : "newton5", points, value_of(d), geom::to_string(d.status), d.iterations,
                     geom::to_string(call.status));
}

/// Solves the paper's equations for the same pair.
std::string newton_now(const Pair& pair) {
  std::string out;
  const geom::Shape a = geom_shape(pair.a);
  const geom::Shape b = geom_shape(pair.b);
  for (const geom::Shape& shape : {a, b}) {
    if (geom::has_equations(shape)) continue;
    return fmt::format("   newton8, newton5: not tried, the paper has no equations of a {}\n",
                       geom::description(shape));
  }
  const geom::Pose& X_WA = pair.motion_a.pose;
  const geom::Pose& X_WB = pair.motion_b.pose;
  const auto line = [&](const char* name, geom::NewtonSystem system, const char* seed_name,
                        const geom::WitnessPair& seed) {
    const geom::DistanceResult d = geom::newton_distance(a, X_WA, b, X_WB, system, seed);
    out += fmt::format("   {} from the {}: {} ({}, {} iterations)\n", name, seed_name, value_of(d),
                       geom::to_string(d.status), d.iterations);
  };
  const auto both = [&](const char* seed_name, const geom::WitnessPair& found) {
    const geom::WitnessPair seed = geom::checked_seed(a, X_WA, b, X_WB, found);
    line("newton8", geom::NewtonSystem::eight, seed_name, seed);
    line("newton5", geom::NewtonSystem::five, seed_name, seed);
  };
  both("dual's points", geom::dual_seed(a, X_WA, b, X_WB));
  both("line of centres", geom::centre_seed(a, X_WA, b, X_WB));
  return out;
}

std::string contact(const Pair& pair, double from, double until) {
  ed::ContactOptions options;
  options.max_evaluations = kReplayBudget;
  const ed::ContactResult found = ed::time_of_contact(pair.a, pair.motion_a, pair.b, pair.motion_b, until, options);
  std::string out = fmt::format("\nstep 2, time of contact, searched for {:.6g} time units: {}, {} looks\n",
                                until - from, ed::to_string(found.status), found.evaluations);
  if (found.status == ed::ContactStatus::overlapping) return out;
  if (found.status != ed::ContactStatus::hit) {
    return out + fmt::format("   certified: no contact before {:.17g} time units\n", found.time - from);
  }
  const geom::DistanceResult d = pair.at(found.time).distance();
  return out + fmt::format(
                   "   they touch after {:.17g}\n   point {}\n   normal from a to b {}\n"
                   "   distance there {:.3g} ({})\n",
                   found.time - from, text(found.point), text(found.normal), d.distance, geom::to_string(d.status));
}

/// Repeats the search with the finder of the run, if that was the paper's.
std::string contact_by_bracketing(const ed::FailedPair& failed, const Pair& pair, double from, double until) {
  if (failed.finder != ed::Finder::bracketing) return "";
  ed::ContactOptions options;
  options.finder = failed.finder;
  options.eps_d = failed.eps_d;
  if (failed.distance) options.distance = failed.distance->method;
  const ed::ContactResult found = ed::time_of_contact(pair.a, pair.motion_a, pair.b, pair.motion_b, until, options);
  return fmt::format("   by bracketing, eps_d = {:g}: {} after {:.17g}, {} looks, {} rescues\n", failed.eps_d,
                     ed::to_string(found.status), found.time - from, found.evaluations, found.rescues);
}

std::string course(const Pair& pair, double from, double step) {
  std::string out = "\nstep 3, the distance over time (free motion, no collision)\n";
  out += fmt::format("  {:>14} {:>24} {:>14}  {:<14} {}\n", "time", "distance", "rate", "status", "normal");
  for (int k = -kStepsBefore; k <= kStepsAfter; ++k) {
    const Pair now = pair.at(from + k * step);
    const geom::DistanceResult d = now.distance();
    const bool answered = std::isfinite(d.distance);
    out += fmt::format("  {:>14.6g} {:>24} {:>14}  {:<14} {}\n", k * step,
                       answered ? fmt::format("{:.16g}", d.distance) : "-",
                       answered ? fmt::format("{:.6g}", distance_rate(now, d)) : "-", geom::to_string(d.status),
                       answered ? text(d.normal) : "-");
  }
  return out;
}

/// Composes the whole text before anything is printed: a pair that the library refuses gives one line and no more.
std::string replayed(const Failure& failure) {
  const ed::FailedPair& failed = failure.pair;
  const double from = std::max(failed.motion_i.time, failed.motion_j.time);
  const Pair pair = Pair{failed.shape_i, failed.shape_j, failed.motion_i, failed.motion_j}.at(from);
  // In twenty steps the fastest points move by about the size of the pair; for bodies at rest any time will do.
  const double window = pair.speed() > 0 ? pair.size() / pair.speed() : 1.0;
  return bodies(failure, pair) + distance_now(pair) + failed_call(failed) + newton_now(pair) +
         contact(pair, from, from + 2 * window) + contact_by_bracketing(failed, pair, from, from + 2 * window) +
         course(pair, from, window / (kStepsBefore + kStepsAfter));
}

}  // namespace

int replay(const std::string& path) {
  const Failure failure = read_failure(path);
  try {
    console().print(replayed(failure));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
  return 0;
}

}  // namespace hardbody
