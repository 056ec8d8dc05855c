#include <ed/given/motion.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector4d;
using geom::Pose;

/// Least length of the quaternion of a spline before it is scaled.
constexpr double kLeastQuaternion = 0.4;
/// Cosine of half the largest rotation between way points: beyond, the other way round is about as short.
constexpr double kLargestTurn = 0.5;

/// Cubic polynomial of time between two way points, by its Bezier points.
template <class Vector>
struct Cubic {
  std::array<Vector, 4> point;

  /// Constructs it from both ends and the derivatives there times the duration.
  Cubic(const Vector& from, const Vector& out, const Vector& to, const Vector& in)
      : point{from, from + out / 3, to - in / 3, to} {}

  Vector at(double s) const {
    const double r = 1 - s;
    return r * r * r * point[0] + 3 * r * r * s * point[1] + 3 * r * s * s * point[2] + s * s * s * point[3];
  }
  /// Returns the largest length of the first derivative by s: derivatives are among the hulls of differences.
  double most_first() const {
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, 3 * (point[k + 1] - point[k]).norm());
    return most;
  }
  double most_second() const {
    double most = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      most = std::max(most, 6 * (point[k + 2] - 2 * point[k + 1] + point[k]).norm());
    }
    return most;
  }
};

struct Segment {
  Cubic<Eigen::Vector3d> position;
  Cubic<Vector4d> quaternion;
  MotionBounds bounds;
};

struct Spline {
  std::vector<double> times;
  std::vector<Segment> segments;
  Pose first, last;

  Pose at(double t) const {
    if (!(t > times.front())) return first;
    if (!(t < times.back())) return last;
    const std::size_t k = segment(t);
    const double s = (t - times[k]) / (times[k + 1] - times[k]);
    const Vector4d q = segments[k].quaternion.at(s);
    return Pose::normalized_quaternion(q[0], q[1], q[2], q[3], segments[k].position.at(s));
  }

  MotionBounds over(double from, double to) const {
    MotionBounds most{0, 0, 0, 0};
    if (!(to > times.front()) || !(from < times.back())) return most;
    for (std::size_t k = segment(from); k < segments.size() && times[k] <= to; ++k) {
      const MotionBounds& b = segments[k].bounds;
      most.speed = std::max(most.speed, b.speed);
      most.angular_speed = std::max(most.angular_speed, b.angular_speed);
      most.acceleration = std::max(most.acceleration, b.acceleration);
      most.angular_acceleration = std::max(most.angular_acceleration, b.angular_acceleration);
    }
    return most;
  }

 private:
  std::size_t segment(double t) const {
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - times.begin() - 1));
    return std::min(k, segments.size() - 1);
  }
};

/// Returns bounds of a piece of this duration; throws where rotations are too large.
MotionBounds piece_bounds(const Cubic<Eigen::Vector3d>& position, const Cubic<Vector4d>& quaternion, double from,
                          double duration) {
  constexpr double kRoundUp = 1 + 1e-9;
  const Vector4d middle = (quaternion.point[0] + quaternion.point[3]).normalized();
  double least = 1;
  for (const Vector4d& q : quaternion.point) least = std::min(least, middle.dot(q));
  if (quaternion.point[0].dot(quaternion.point[3]) < kLargestTurn - 1e-9 || least < kLeastQuaternion) {
    std::ostringstream message;
    message << "GivenMotion::spline: the rotation from time " << from << " to " << from + duration
            << " is too large; accepted: 120 degrees, less where neighbouring intervals differ";
    throw std::invalid_argument(message.str());
  }
  // q = Q / |Q|: omega = 2 q' q*, |q'| <= |Q'| / |Q|; the part of q'' across q is at most |Q''| / |Q| + (|Q'| / |Q|)^2.
  const double first = quaternion.most_first() / duration / least;
  const double second = quaternion.most_second() / (duration * duration) / least;
  return {position.most_first() / duration * kRoundUp, 2 * first * kRoundUp,
          position.most_second() / (duration * duration) * kRoundUp, 2 * (second + first * first) * kRoundUp};
}

/// Returns derivatives at way points: those of the neighbours' difference; 0 at both ends.
template <class Vector>
std::vector<Vector> derivatives(const std::vector<double>& times, const std::vector<Vector>& values) {
  std::vector<Vector> slopes(values.size(), Vector::Zero());
  for (std::size_t k = 1; k + 1 < values.size(); ++k) {
    slopes[k] = (values[k + 1] - values[k - 1]) / (times[k + 1] - times[k - 1]);
  }
  return slopes;
}

void check_times(const std::vector<double>& times, std::size_t poses) {
  if (times.size() != poses || poses < 2) {
    std::ostringstream message;
    message << "GivenMotion::spline: " << times.size() << " times and " << poses
            << " poses; accepted: as many of both, 2 or more";
    throw std::invalid_argument(message.str());
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::isfinite(times[k]) && (k == 0 || times[k] > times[k - 1])) continue;
    std::ostringstream message;
    message << "GivenMotion::spline: time " << k << " is " << times[k] << "; accepted: finite times in ascending order";
    throw std::invalid_argument(message.str());
  }
  if (!std::isfinite(times.back() - times.front())) {
    std::ostringstream message;
    message << "GivenMotion::spline: times are from " << times.front() << " to " << times.back()
            << "; accepted: a finite duration";
    throw std::invalid_argument(message.str());
  }
}

}  // namespace

GivenMotion GivenMotion::spline(std::vector<double> times, const std::vector<Pose>& X_WB) {
  check_times(times, X_WB.size());
  std::vector<Eigen::Vector3d> positions;
  std::vector<Vector4d> quaternions;
  for (const Pose& X : X_WB) {
    positions.push_back(X.position());
    const std::array<double, 4> q = geom::kernel::quaternion_of(X.rotation());
    quaternions.emplace_back(q[0], q[1], q[2], q[3]);
    // Of q and -q that one which is nearer to the last.
    const std::size_t k = quaternions.size() - 1;
    if (k > 0 && quaternions[k].dot(quaternions[k - 1]) < 0) quaternions[k] *= -1;
  }
  const std::vector<Eigen::Vector3d> velocity = derivatives(times, positions);
  const std::vector<Vector4d> slope = derivatives(times, quaternions);
  auto spline = std::make_shared<Spline>();
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const double h = times[k + 1] - times[k];
    const Cubic<Eigen::Vector3d> position(positions[k], h * velocity[k], positions[k + 1], h * velocity[k + 1]);
    const Cubic<Vector4d> quaternion(quaternions[k], h * slope[k], quaternions[k + 1], h * slope[k + 1]);
    spline->segments.push_back({position, quaternion, piece_bounds(position, quaternion, times[k], h)});
  }
  spline->times = std::move(times);
  spline->first = X_WB.front();
  spline->last = X_WB.back();
  const std::shared_ptr<const Spline> shared = std::move(spline);
  return {[shared](double t) { return shared->at(t); },
          [shared](double from, double to) { return shared->over(from, to); }};
}

}  // namespace ed
