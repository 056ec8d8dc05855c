#include "contact/swept_hull.h"

#include "contact/rounding.h"
#include "motion/checks.h"

#include <ed/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ed::internal {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Directions on each cone about an axis.
constexpr int kSweptTurns = 64;

/// Bound of the rounding error of a height, relative to the bounding radius (rounding.h: 80 for a support function, 24
/// for a direction).
constexpr double kHeightRounding = 128 * kRoundoff;

/// Returns whether omega is constant at all times, but for rounding. It is not for a body that now turns about the axis
/// of its middle moment: that rotation is unstable.
bool turns_uniformly(const FreeTop& top) {
  return top.max_alpha() <= 8 * kRoundoff * (top.max_omega() * top.max_omega());
}

}  // namespace

SweptHull::SweptHull(const geom::kernel::Spheroid& shape, const AxisMotion& motion)
    : hull_(Spheroid{shape.b2, shape.c, motion.e0, motion.e1, motion.e2}) {
  if (motion.axis_rate() == 0) hull_ = Spheroid{shape.b2, shape.c, motion.axis(), Vector3d::Zero(), Vector3d::Zero()};
}

SweptHull::SweptHull(const BodyShape& shape, const RigidMotion& motion, const Vector3d& inertia)
    : hull_(Ball{bounding_radius(shape)}) {
  if (is_sphere(shape)) return;
  const TopState now = motion.top.at(-motion.time);
  const double rate = now.omega.norm();
  if (rate == 0) {
    hull_ = Resting{&shape, now.R};
    return;
  }
  const Vector3d L = now.R * inertia.cwiseProduct(now.R.transpose() * now.omega);
  if (turns_uniformly(motion.top)) {
    hull_ = about_an_axis(shape, now.R, now.omega / rate);
  } else if (const int axis = symmetry_axis_of_inertia(inertia); axis >= 0) {
    hull_ = about_an_axis(shape, now.R, now.R.col(axis)).turned_about(L.normalized());
  }
}

/// The hull is one of revolution, and its support function sublinear. So it is enough to know it at some directions:
/// for those between two, n = (n1 + n2) / (2 cos(delta)) at the middle, h(n) <= max(h(n1), h(n2)) / cos(delta). Of the
/// cone at the angle theta about the axis the part across it is divided so, of which no height is above that of the
/// body itself across the axis: h <= max + sin(theta) (1 / cos(delta) - 1) R.
SweptHull::AboutAnAxis SweptHull::about_an_axis(const BodyShape& shape, const Matrix3d& rotation,
                                                const Vector3d& axis) {
  const double R = bounding_radius(shape);
  const Vector3d l = rotation.transpose() * axis;
  const Vector3d e = l.unitOrthogonal();
  const Vector3d f = l.cross(e);
  const double missed = 1 / std::cos(std::numbers::pi / kSweptTurns) - 1;
  AboutAnAxis hull{axis, {}};
  for (int node = 0; node < kSweptNodes; ++node) {
    const double theta = std::numbers::pi * node / (kSweptNodes - 1);
    const bool on_the_axis = node == 0 || node == kSweptNodes - 1;
    const double across = on_the_axis ? 0 : std::sin(theta);
    double& most = hull.heights[static_cast<std::size_t>(node)];
    for (int turn = 0; turn < (on_the_axis ? 1 : kSweptTurns); ++turn) {
      const double phi = 2 * std::numbers::pi * turn / kSweptTurns;
      const Vector3d m = std::cos(theta) * l + across * (std::cos(phi) * e + std::sin(phi) * f);
      most = std::max(most, support(shape, m).height);
    }
    most += across * missed * R;
  }
  return hull;
}

double SweptHull::Spheroid::height(const Vector3d& n) const {
  const double middle = std::abs(n.dot(e0));
  const double reach = std::hypot(n.dot(e1), n.dot(e2));
  // h^2 is largest where |x| is, for a rod, or where it is least, for a disc.
  const double x = c > 0 ? middle + reach : std::max(0.0, middle - reach);
  return std::sqrt(b2 + c * (x * x));
}

double SweptHull::Resting::height(const Vector3d& n) const {
  return support(*shape, rotation.transpose() * n).height;
}

namespace {

/// Angle between the directions of a table.
constexpr double kSweptStep = std::numbers::pi / (kSweptNodes - 1);

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

/// n = (sin(theta2 - theta) n1 + sin(theta - theta1) n2) / sin(theta2 - theta1), and so is an upper bound of h.
double SweptHull::AboutAnAxis::height_at(double angle) const {
  const int node = std::clamp(static_cast<int>(angle / kSweptStep), 0, kSweptNodes - 2);
  const double from = angle - node * kSweptStep;
  const auto k = static_cast<std::size_t>(node);
  return (std::sin(kSweptStep - from) * heights[k] + std::sin(from) * heights[k + 1]) / std::sin(kSweptStep);
}

double SweptHull::AboutAnAxis::height(const Vector3d& n) const {
  return height_at(angle_between(n, axis));
}

/// Height between two directions, half a step from their middle: at most the larger one over the cosine of that.
double SweptHull::AboutAnAxis::highest(double least, double most) const {
  double found = std::max(height_at(least), height_at(most));
  for (int node = 0; node < kSweptNodes; ++node) {
    const double angle = node * kSweptStep;
    if (angle > least && angle < most) found = std::max(found, heights[static_cast<std::size_t>(node)]);
  }
  return found / std::cos(0.5 * std::min(kSweptStep, most - least));
}

/// A direction at theta from the other axis is at theta - alpha to theta + alpha from this one while it turns, alpha
/// the angle between the axes.
SweptHull::AboutAnAxis SweptHull::AboutAnAxis::turned_about(const Vector3d& other) const {
  const double alpha = angle_between(axis, other);
  AboutAnAxis hull{other, {}};
  for (int node = 0; node < kSweptNodes; ++node) {
    const double theta = node * kSweptStep;
    const double sum = theta + alpha;
    hull.heights[static_cast<std::size_t>(node)] =
        highest(std::abs(theta - alpha), std::min(sum, 2 * std::numbers::pi - sum));
  }
  return hull;
}

double SweptHull::height(const Vector3d& n) const {
  return std::visit([&](const auto& hull) { return hull.height(n); }, hull_);
}

double SweptPair::gap(const Vector3d& n, double t) const {
  return n.dot(r + t * v) - a.height(n) - b.height(-n);
}

/// Unit vector of a large gap, by a pattern search from the best of the guess, the line of centres and the normal of
/// the relative velocity nearest to that line.
Vector3d SweptPair::best_normal(const Vector3d& guess, double t) const {
  Vector3d best = guess;
  double most = gap(best, t);
  const auto improve = [&](const Vector3d& trial) {
    if (!(trial.squaredNorm() > 0)) return false;
    const Vector3d n = trial.normalized();
    const double g = gap(n, t);
    if (!(g > most)) return false;
    most = g;
    best = n;
    return true;
  };
  const Vector3d between = r + t * v;
  improve(between);
  if (v.squaredNorm() > 0) improve(between - (between.dot(v) / v.squaredNorm()) * v);
  // Steps along the sphere, shorter where they do not help. (Hulls have kinks.)
  constexpr double kLongest = 0.5;
  constexpr double kShortest = 1e-6;
  for (double step = kLongest; step > kShortest;) {
    const Vector3d e = best.unitOrthogonal();
    const Vector3d f = best.cross(e);
    bool better = false;
    for (const Vector3d& way : {e, Vector3d(-e), f, Vector3d(-f)}) better = improve(best + step * way) || better;
    if (!better) step *= 0.5;
  }
  return best;
}

double SweptPair::clear_until(double t, const Vector3d& guess, double hidden, bool touching) const {
  constexpr int kSteps = 30;
  constexpr double kLeastGain = 1e-3;  // of the size: from there on the search itself goes on
  constexpr double kSinking = 4 * kTouching;
  const double speed = v.norm();
  const double least = hidden + kHeightRounding * size;
  const double allowed = touching ? kSinking * size : 0;
  Vector3d n = guess;
  for (int step = 0; step < kSteps; ++step) {
    n = best_normal(n, t);
    const double g = gap(n, t);
    if (!(touching ? g >= -least : g > least)) return t;
    // n.v errs by some roundings of |v|.
    const double falling = 16 * kRoundoff * speed - n.dot(v);
    if (!(falling > 0)) return std::numeric_limits<double>::infinity();
    const double gained = (std::max(0.0, g - least) + allowed) / falling;
    t += gained;
    if (touching || gained * speed < kLeastGain * size) return t;
  }
  return t;
}

}  // namespace ed::internal
