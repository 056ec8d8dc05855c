#pragma once

/// Brute-force contact finder, and the free motion that it needs. It shares no code with the finder under test except
/// `geom::distance`: the motion is implemented independently with rotation matrices and the C library's sine.

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/pose.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace finder_test {

/// State of a body of revolution about its z axis, world frame, at time 0.
struct BodyState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d across = Eigen::Vector3d::Zero();  ///< part of omega across the axis
  double spin = 0;                                   ///< omega.axis

  Eigen::Vector3d axis() const { return rotation.col(2); }
  Eigen::Vector3d omega() const { return across + spin * axis(); }
};

/// Principal moments across the axis and about it.
struct Moments {
  double perpendicular = 1;
  double axial = 1;
};

/// Free motion from a state at time 0. The body rotates about its constant angular momentum L at |L| / I_perp and about
/// its own axis at (1 - I_3 / I_perp) spin.
class FreeMotion {
 public:
  FreeMotion(const BodyState& start, const Moments& moments) : start_(start) {
    const Eigen::Vector3d L = moments.perpendicular * start.across + moments.axial * start.spin * start.axis();
    const double length = L.norm();
    momentum_direction_ = length > 0 ? Eigen::Vector3d(L / length) : Eigen::Vector3d::UnitX();
    precession_ = length / moments.perpendicular;
    own_ = (1 - moments.axial / moments.perpendicular) * start.spin;
  }

  BodyState at(double t) const {
    BodyState s = start_;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(precession_ * t, momentum_direction_).toRotationMatrix();
    s.position = position(t);
    s.rotation = turn * Eigen::AngleAxisd(own_ * t, start_.axis()).toRotationMatrix() * start_.rotation;
    const Eigen::Vector3d u = s.axis();
    s.across = precession_ * (momentum_direction_ - momentum_direction_.dot(u) * u);
    return s;
  }

  /// Returns the centre and axis, on which alone the distance of a body of revolution depends. Rotation about the axis
  /// has no effect, so that any frame will do; brute force spends most of its time here.
  geom::Pose pose(double t) const {
    const double angle = precession_ * t;
    const Eigen::Vector3d along = momentum_direction_.dot(start_.axis()) * momentum_direction_;
    const Eigen::Vector3d u =
        (along + std::cos(angle) * (start_.axis() - along) + std::sin(angle) * momentum_direction_.cross(start_.axis()))
            .normalized();
    Eigen::Matrix3d frame;
    frame.col(2) = u;
    frame.col(0) = u.unitOrthogonal();
    frame.col(1) = u.cross(frame.col(0));
    return {frame, position(t)};
  }

  Eigen::Vector3d position(double t) const { return start_.position + t * start_.velocity; }
  const Eigen::Vector3d& velocity() const { return start_.velocity; }
  double axis_rate() const { return start_.across.norm(); }  ///< |d axis / dt|, constant

 private:
  BodyState start_;
  Eigen::Vector3d momentum_direction_;
  double precession_;
  double own_;
};

struct BruteContact {
  bool found = false;
  double time = std::numeric_limits<double>::infinity();
  double least_gap = std::numeric_limits<double>::infinity();  ///< smallest local minimum of d before it (t > 0)
};

/// Finds the first contact of two bodies by steps d / (largest possible |dd/dt|).
///
/// The step is certified, but vanishes with d; below `floor` it is floor / rate instead, over which d changes by at
/// most floor. A contact between two such steps is found by minimising d(t) around every sampled minimum below ten
/// floors.
class BruteForce {
 public:
  /// Constructs the finder with `floor` in units of size(), the sum of both bounding radii.
  BruteForce(const geom::Ellipsoid& shape_a, const FreeMotion& a, const geom::Ellipsoid& shape_b, const FreeMotion& b,
             double floor)
      : shape_a_(shape_a), shape_b_(shape_b), a_(a), b_(b) {
    const auto tip_rate = [](const geom::Ellipsoid& s, const FreeMotion& m) {
      return (s.bounding_radius() - s.inscribed_radius()) * m.axis_rate();
    };
    size_ = shape_a.bounding_radius() + shape_b.bounding_radius();
    rate_ = (b.velocity() - a.velocity()).norm() + tip_rate(shape_a, a) + tip_rate(shape_b, b);
    floor_ = floor * size_;
  }

  /// Limit of overlap: d below -kPenetration * size is an overlap and not the rounding error of a touch.
  static constexpr double kPenetration = 1e-14;

  double size() const { return size_; }
  double rate() const { return rate_; }
  long evaluations() const { return evaluations_; }
  const Eigen::Vector3d& normal() const { return normal_; }  ///< normal of the last distance

  double distance(double t) {
    ++evaluations_;
    const geom::DistanceResult d = geom::distance(shape_a_, a_.pose(t), shape_b_, b_.pose(t), {.start = normal_});
    if (d.status == geom::DistanceStatus::separated || d.status == geom::DistanceStatus::overlapping) {
      normal_ = d.normal;
      return d.distance;
    }
    return -std::numeric_limits<double>::infinity();  // too deep to be answered
  }

  BruteContact first_contact(double t_end) {
    BruteContact result;
    double t_before = 0;
    double d_before = std::numeric_limits<double>::infinity();
    double t = 0;
    double d = distance(0);
    while (t < t_end && !parted_for_good(t) && rate_ > 0) {
      const double t_next = std::min(t_end, t + std::max(d, floor_) / rate_);
      const double d_next = distance(t_next);
      if (d_next < -kPenetration * size_) return contact_between(t, t_next, result);
      if (d <= d_before && d < d_next) {
        Minimum least{t, d};
        if (d < 10 * floor_) least = minimum(t_before, t_next);
        if (least.value < -kPenetration * size_) return contact_between(t_before, least.time, result);
        if (t > 0) result.least_gap = std::min(result.least_gap, least.value);
      }
      t_before = t;
      d_before = d;
      t = t_next;
      d = d_next;
    }
    return result;
  }

  /// Returns the first time at which d is at most the floor, or t_end, by plain conservative advancement. For
  /// comparison of costs; it cannot distinguish a contact from a near miss.
  double advance(double t_end) {
    double t = 0;
    while (t < t_end && !parted_for_good(t)) {
      const double d = distance(t);
      if (d <= floor_) return t;
      t += d / rate_;
    }
    return t_end;
  }

  /// Returns how deep the bodies overlap after they have touched at time t: the largest -d until they are apart again.
  /// Stops when it is more than `enough`.
  double depth_after(double t, double enough) {
    double deepest = 0;
    double before = t;
    double now = t;
    for (double step = 1e-9 * size_ / rate_;; step *= 1.3) {
      const double next = now + step;
      const double d = distance(next);
      deepest = std::max(deepest, -d);
      if (deepest > enough) return deepest;
      if (d > 0) return std::max(deepest, -minimum(before, next).value);
      before = now;
      now = next;
    }
  }

 private:
  struct Minimum {
    double time;
    double value;
  };

  bool parted_for_good(double t) const {
    const Eigen::Vector3d r = b_.position(t) - a_.position(t);
    return r.squaredNorm() > size_ * size_ && r.dot(b_.velocity() - a_.velocity()) >= 0;
  }

  /// Returns the first crossing of zero between a time with d >= -rounding and one with d < 0, by bisection.
  BruteContact contact_between(double apart, double inside, BruteContact result) {
    while (true) {
      const double middle = 0.5 * (apart + inside);
      if (!(middle > apart && middle < inside)) break;
      (distance(middle) < 0 ? inside : apart) = middle;
    }
    (void)distance(inside);  // sets the normal there
    result.found = true;
    result.time = inside;
    return result;
  }

  /// Finds a minimum by golden-section search. The minimum of d is at least parabolic: a relative width of 1e-9 is well
  /// below where rounding of d makes further steps pointless.
  Minimum minimum(double lo, double hi) {
    constexpr double kGolden = 0.6180339887498949;
    double x1 = hi - kGolden * (hi - lo);
    double x2 = lo + kGolden * (hi - lo);
    double d1 = distance(x1);
    double d2 = distance(x2);
    const double width = 1e-9 * (hi - lo);
    while (hi - lo > width && x2 > x1) {
      if (d1 <= d2) {
        hi = x2;
        x2 = x1;
        d2 = d1;
        x1 = hi - kGolden * (hi - lo);
        d1 = distance(x1);
      } else {
        lo = x1;
        x1 = x2;
        d1 = d2;
        x2 = lo + kGolden * (hi - lo);
        d2 = distance(x2);
      }
    }
    return d1 <= d2 ? Minimum{x1, d1} : Minimum{x2, d2};
  }

  const geom::Ellipsoid& shape_a_;
  const geom::Ellipsoid& shape_b_;
  const FreeMotion& a_;
  const FreeMotion& b_;
  double size_;
  double rate_;
  double floor_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  long evaluations_ = 0;
};

}  // namespace finder_test
