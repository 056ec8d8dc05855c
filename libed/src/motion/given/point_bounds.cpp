#include "motion/given/point_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace ed::internal {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Relative excess that is rounding of a bound.
constexpr double kSlack = 1e-9;
/// Roundings of a pose, of its numbers and of the way during the rounding of a time.
constexpr double kPoseRoundings = 64;

/// Lengths and angles that are rounding of what is compared.
struct PoseRounding {
  PoseRounding(const MotionBounds& bounds, double from, const geom::Pose& X, double to, const geom::Pose& Y,
               const MotionScales& scales) {
    const double clock = kPoseRoundings * kEpsilon * (std::max(std::abs(from), std::abs(to)) + scales.time);
    const double reach = X.position().cwiseAbs().maxCoeff() + Y.position().cwiseAbs().maxCoeff();
    way =
        kPoseRoundings * kEpsilon * (reach + scales.length) + (std::isfinite(bounds.speed) ? clock * bounds.speed : 0);
    angle = kPoseRoundings * kEpsilon + (std::isfinite(bounds.angular_speed) ? clock * bounds.angular_speed : 0);
  }

  double way, angle;
};

std::string broken(const char* what, double found, double bound, const char* name, double from, double to) {
  std::ostringstream message;
  message << what << " by " << found << " from time " << from << " to " << to << ", beyond its bound of the " << name
          << ", which allows " << bound;
  return message.str();
}

}  // namespace

std::string broken_speed(const MotionBounds& bounds, double from, const geom::Pose& X, double to, const geom::Pose& Y,
                         const MotionScales& scales) {
  const double duration = to - from;
  const PoseRounding rounding(bounds, from, X, to, Y, scales);
  const double way = (Y.position() - X.position()).norm();
  if (way > bounds.speed * duration * (1 + kSlack) + rounding.way) {
    return broken("it moves", way, bounds.speed * duration, "speed", from, to);
  }
  // A rotation by an angle differs from none by 2 sqrt(2) sin(angle / 2) in the norm of all entries.
  const double turn = (Y.rotation() - X.rotation()).norm() / std::numbers::sqrt2;
  if (turn > bounds.angular_speed * duration * (1 + kSlack) + rounding.angle) {
    return broken("it turns", 2 * std::asin(std::min(1.0, 0.5 * turn)), bounds.angular_speed * duration,
                  "angular speed", from, to);
  }
  return "";
}

std::string broken_acceleration(const MotionBounds& bounds, double from, const geom::Pose& X, const geom::Pose& middle,
                                double to, const geom::Pose& Y, const MotionScales& scales) {
  const double duration2 = (to - from) * (to - from) / 8;
  const PoseRounding rounding(bounds, from, X, to, Y, scales);
  const double bend = (0.5 * (X.position() + Y.position()) - middle.position()).norm();
  if (std::isfinite(bounds.acceleration) && bend > bounds.acceleration * duration2 * (1 + kSlack) + rounding.way) {
    return broken("its way is bent", bend, bounds.acceleration * duration2, "acceleration", from, to);
  }
  // |R''| <= sqrt(2) (|angular acceleration| + |angular velocity|^2) in the norm of all entries.
  const double most = bounds.angular_acceleration + bounds.angular_speed * bounds.angular_speed;
  const double twist = (0.5 * (X.rotation() + Y.rotation()) - middle.rotation()).norm() / std::numbers::sqrt2;
  if (std::isfinite(most) && twist > most * duration2 * (1 + kSlack) + rounding.angle) {
    return broken("its turn is bent", twist, most * duration2, "angular acceleration", from, to);
  }
  return "";
}

}  // namespace ed::internal
