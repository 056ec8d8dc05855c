#include "start/nematic.h"

#include "base/poll.h"
#include "cells/levels.h"
#include "start/parts.h"
#include "system/bounding_radii.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
/// Quaternion that is not aligned: the same layout for every -march (see geom/kernel/small_solve.h).
using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Returns the inverse of the distribution function of the proposal, u = 1 - |cos(theta)| with density ~ 1 / (1 + m
/// u)^2 on [0, 1].
double proposed(double m, double r) {
  return r / (1 + m * (1 - r));
}

/// Returns exp(m (cos^2 - 1)) / proposal, at most 4/e: the exponent is -m u (2 - u) <= -m u, and (1 + y)^2 exp(-y) has
/// its maximum at y = 1.
double weight(double m, double u) {
  return std::exp(-m * u * (2 - u)) * (1 + m * u) * (1 + m * u);
}
constexpr double kLargestWeight = 1.4715177646857694;  // 4 / e, rounded up

/// Returns 1 - S by Simpson's rule in r, where the weight is smooth for any m.
double disorder(double m) {
  constexpr int kIntervals = 512;
  double all = 0;
  double sum = 0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double u = proposed(m, static_cast<double>(i) / kIntervals);
    const double w = weight(m, u) * (i == 0 || i == kIntervals ? 1 : i % 2 == 1 ? 4 : 2);
    all += w;
    sum += w * u * (2 - u);
  }
  return 1.5 * sum / all;
}

/// Returns m by bisection: libm only decides which half is taken, far from rounding.
double strength_for(double order) {
  double high = 1;
  while (disorder(high) > 1 - order) high *= 2;
  double low = 0;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (disorder(middle) > 1 - order ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void check_order(double order) {
  if (order >= 0 && order < 1) return;
  std::ostringstream message;
  message << "nematic_order is " << order << "; accepted: at least 0, below 1";
  throw std::invalid_argument(message.str());
}

// ---- Rotations in place

/// Number of sweeps over all bodies in one round, after which it is tested whether the order still falls; and of the
/// sweeps after the order is reached, in which the orientations decorrelate from the start.
constexpr int kRound = 50;
/// Smallest decrease in a round, relative to 1 - S, that counts as progress.
constexpr double kLeastFall = 4e-3;

/// Limit of the tilt of the director: bodies that all rotate together would lower the order about z too. Elements xz
/// and yz of the order tensor stay below kMostTilt / sqrt(number of bodies); their standard deviation for independent
/// bodies is at most 0.39 of that each.
constexpr double kMostTilt = 1;

/// Bodies that rotate about their centres.
class RotationMoves {
 public:
  RotationMoves(System& system, const std::vector<int>& axes, double order, const std::function<void()>& poll)
      : system_(system),
        axes_(axes),
        poll_(poll),
        least_(order),
        most_tilt_(kMostTilt / std::sqrt(system.size())),
        cells_(bounding_radii(system), system.box) {
    for (int i = 0; i < system.size(); ++i) {
      const Body& body = system.bodies[static_cast<std::size_t>(i)];
      cells_.place(i, body.position);
      turns_.emplace_back(body.rotation);
      order_ += p2(body.rotation, axis_of(body)) / system.size();
    }
  }

  double order() const { return order_; }
  bool arrived() const { return arrived_; }

  void sweep(Random& random) {
    int accepted = 0;
    for (int i = 0; i < system_.size(); ++i) {
      poll_at(i, poll_);
      accepted += try_turn(i, random) ? 1 : 0;
    }
    // The step is adjusted to accept a third of the rotations, or limited to the largest meaningful one.
    step_ = std::min(1.0, step_ * (3 * accepted > system_.size() ? 1.1 : 0.9));
  }

 private:
  /// Returns elements xz and yz of the order tensor.
  static Vector2d tilt_of(const Matrix3d& rotation, int axis) {
    return 1.5 * rotation(2, axis) * rotation.col(axis).head<2>();
  }
  static double p2(const Matrix3d& rotation, int axis) { return 1.5 * rotation(2, axis) * rotation(2, axis) - 0.5; }
  int axis_of(const Body& body) const { return axes_[static_cast<std::size_t>(body.species)]; }

  bool try_turn(int i, Random& random) {
    Body& body = system_.bodies[static_cast<std::size_t>(i)];
    Quaternion& turn = turns_[static_cast<std::size_t>(i)];
    const Vector3d small = step_ * random.normal3();
    const Quaternion next = (Quaternion(1, small.x(), small.y(), small.z()) * turn).normalized();
    const Matrix3d rotation = next.toRotationMatrix();
    const double change = (p2(rotation, axis_of(body)) - p2(body.rotation, axis_of(body))) / system_.size();
    if (order_ + change < least_) {
      arrived_ = true;
      return false;
    }
    const Vector2d tilt =
        tilt_ + (tilt_of(rotation, axis_of(body)) - tilt_of(body.rotation, axis_of(body))) / system_.size();
    if (tilt.norm() > most_tilt_ || blocked(i, rotation)) return false;
    order_ += change;
    tilt_ = tilt;
    turn = next;
    body.rotation = rotation;
    return true;
  }

  bool blocked(int i, const Matrix3d& rotation) {
    const geom::Pose pose(rotation, system_.bodies[static_cast<std::size_t>(i)].position);
    bool blocked = false;
    cells_.search(i, pose.position(), near_, [&](std::span<const NearBody> others) {
      blocked = blocked || std::any_of(others.begin(), others.end(), [&](const NearBody& other) {
                  if (other.body == i) return false;
                  const Matrix3d& R = system_.bodies[static_cast<std::size_t>(other.body)].rotation;
                  return overlaps(system_.species_of(i).shape, pose, system_.species_of(other.body).shape,
                                  geom::Pose(R, pose.position() + other.r));
                });
    });
    return blocked;
  }

  System& system_;
  const std::vector<int>& axes_;
  const std::function<void()>& poll_;
  double least_;
  double order_ = 0;
  Vector2d tilt_ = Vector2d::Zero();
  double most_tilt_;
  bool arrived_ = false;
  double step_ = 0.1;
  CellLevels cells_;
  std::vector<Quaternion> turns_;  ///< unit quaternions: products of rotation matrices would drift
  std::vector<NearBody> near_;
};

/// Returns an order near 1 with two digits of its difference from 1; at least three digits.
std::string shown(double order) {
  const double digits = std::clamp(1 - std::floor(std::log10(1 - order)), 3.0, 15.0);
  std::ostringstream text;
  text << std::fixed << std::setprecision(static_cast<int>(digits)) << order;
  return text.str();
}

/// Throws for an order that is not reached. The value in the message is accepted: the same rotations pass it on their
/// way to `reached`.
[[noreturn]] void refuse_order(const System& system, double order, double reached, const std::string& numbers) {
  const double from_one = 0.9 * (1 - reached);
  std::ostringstream message;
  message << "nematic_order is " << order << ": at packing fraction " << packing_fraction(system)
          << " bodies on these sites cannot rotate beyond an order of " << shown(reached) << "; accepted: ";
  if (from_one > 1e-9) {
    const double unit = std::pow(10, std::floor(std::log10(from_one)) - 1);
    message << "at least " << std::setprecision(12) << 1 - std::floor(from_one / unit) * unit << ", ";
  }
  if (!numbers.empty()) message << "a number of " << numbers << ", whose cells fit the bodies, ";
  message << "no nematic_order (all aligned), or a lower packing fraction";
  throw std::invalid_argument(message.str());
}

}  // namespace

void turn_to_order(System& system, const std::vector<int>& axes, double order, Random& random,
                   const std::function<std::string()>& other_numbers, const std::function<void()>& poll) {
  check_order(order);
  RotationMoves moves(system, axes, order, poll);
  for (double before = 2; !moves.arrived();) {
    double mean = 0;
    for (int k = 0; k < kRound && !moves.arrived(); ++k) {
      moves.sweep(random);
      mean += moves.order() / kRound;
    }
    if (!moves.arrived() && mean > before - kLeastFall * (1 - mean)) {
      refuse_order(system, order, mean, other_numbers());
    }
    before = mean;
  }
  for (int k = 0; k < kRound; ++k) moves.sweep(random);
}

NematicOrientations::NematicOrientations(double order) {
  check_order(order);
  m_ = order == 0 ? 0 : strength_for(order);
}

Matrix3d NematicOrientations::draw(int axis, Random& random) const {
  double u = 0;
  do {
    u = proposed(m_, random.uniform());
  } while (random.uniform() * kLargestWeight > weight(m_, u));
  const double z = random.bits() >> 63 == 0 ? 1 - u : u - 1;
  // Directions across z, and then across the axis, are uniform like those of a random vector.
  const Vector3d around = random.direction();
  const Vector3d across = Vector3d(around.x(), around.y(), 0).normalized();
  const Vector3d direction = (std::sqrt(u * (2 - u)) * across + z * Vector3d::UnitZ()).normalized();
  Vector3d other = random.direction();
  while (direction.cross(other).squaredNorm() < 1e-4) other = random.direction();
  Matrix3d rotation;
  rotation.col(axis) = direction;
  rotation.col((axis + 1) % 3) = direction.cross(other).normalized();
  rotation.col((axis + 2) % 3) = direction.cross(Vector3d(rotation.col((axis + 1) % 3)));
  return rotation;
}

int ordered_axis(const Species& species) {
  return symmetry_axis(species).value_or(2);
}

Matrix3d aligned(int axis) {
  Matrix3d rotation;
  rotation.col(axis) = Vector3d::UnitZ();
  rotation.col((axis + 1) % 3) = Vector3d::UnitX();
  rotation.col((axis + 2) % 3) = Vector3d::UnitY();
  return rotation;
}

}  // namespace ed::internal
