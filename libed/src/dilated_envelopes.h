#pragma once

/// Dilated envelopes: the region within a distance delta of where a body of revolution was when its list was made.
///
/// A body at (r, u) lies inside the envelope of (r0, u0) while |r - r0| + |a - b| theta <= delta, theta the angle
/// between u and u0, because the support function changes by at most |a - b| a radian. Two bodies whose envelopes do
/// not meet, gap of the bodies at (r0, u0) > 2 delta, cannot touch.

#include "axis_motion.h"
#include "envelopes.h"
#include "neighbour_lists.h"
#include "periodic.h"

#include <geom/internal/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace ed::internal {

/// The thinnest envelope in use, in units of the bounding radius.
inline constexpr double kThinnestEnvelope = 0.02;

/// The smallest box in which the nearest image of a neighbour is the only one that can touch. Neighbours' envelope
/// centres are within 2 R + 2 delta of each other, their centres then within 2 R + 4 delta, which must be below half
/// the box.
inline double smallest_box(double bounding_radius) {
  return 2 * (2 + 4 * kThinnestEnvelope) * bounding_radius;
}

/// The thickest envelope for which the nearest image is safe in this box.
inline double thickest_envelope(double box, double bounding_radius) {
  return (0.5 * box - 2 * bounding_radius) / 4;
}

/// An upper bound of the angle between unit vectors a chord apart: 2 asin(c/2) = c + c^3/24 + 3 c^5/640 + ..., whose
/// tail after the second term is below c^5/120 for c <= 1.
inline double angle_bound(double chord) {
  if (!(chord <= 1)) return 3.1416;
  const double c2 = chord * chord;
  return chord * (1 + c2 * (1.0 / 24 + c2 / 120));
}

class DilatedEnvelopes final : public Envelopes {
 public:
  /// `thickness`: delta. Bodies leave at `exit_thickness` <= delta already, which is what a shrinking box eats up.
  DilatedEnvelopes(int number, const geom::internal::Spheroid& shape, double axis_difference, double bounding_radius,
                   double thickness, double exit_thickness)
      : shape_(shape),
        axis_difference_(axis_difference),
        bounding_radius_(bounding_radius),
        thickness_(thickness),
        exit_thickness_(exit_thickness),
        centre_(static_cast<std::size_t>(number)),
        axis_(static_cast<std::size_t>(number)) {}

  double thickness() const override { return thickness_; }
  double exit_thickness() const { return exit_thickness_; }
  double reach() const override { return 2 * (bounding_radius_ + thickness_); }
  /// See Envelopes.
  ///
  /// Pairs outside the lists had a gap above 2 delta when the lists were made. Shrinking by s brings a pair of gap G
  /// and hA + hB = h down to s (G + h) - h, which stays above 2 delta_exit while 1 - s <= 2 (delta - delta_exit) / (2
  /// delta + h).
  double least_scale() const override { return 1 - 2 * (thickness_ - exit_thickness_) / reach(); }
  const Eigen::Vector3d& centre(int i) const { return centre_[static_cast<std::size_t>(i)]; }

  void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
             const Eigen::Vector3d& /*x_axis*/) override {
    centre_[static_cast<std::size_t>(i)] = position;
    axis_[static_cast<std::size_t>(i)] = axis;
  }

  void scale(double factor) override {
    for (Eigen::Vector3d& c : centre_) c *= factor;
  }

  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
                   double now, double box) const override {
    const std::size_t k = static_cast<std::size_t>(i);
    const Eigen::Vector3d d = nearest_image(position - centre_[k], box);
    const double left = exit_thickness_ - axis_difference_ * angle_bound((axis - axis_[k]).norm());
    const double d2 = d.squaredNorm();
    if (!(left > 0) || d2 >= left * left) return now;
    // First root of |d + v s| + w s = left, w the fastest that turning can move the surface.
    const double w = surface_speed(motion);
    const double A = motion.velocity.squaredNorm() - w * w;
    const double B = d.dot(motion.velocity) + left * w;
    const double C = d2 - left * left;
    const double denominator = B + std::sqrt(std::max(0.0, B * B - A * C));
    return denominator > 0 ? now - C / denominator : kNever;
  }

  double worthwhile(const AxisMotion& motion) const override {
    return 0.15 * exit_thickness_ / (motion.velocity.norm() + surface_speed(motion) + 1e-300);
  }

  bool may_meet(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override {
    const Eigen::Vector3d& u_i = axis_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d& u_k = axis_[static_cast<std::size_t>(k)];
    const double limit = 2 * thickness_;
    // Most pairs are told apart by the gap along the line of centres already.
    const double r2 = r.squaredNorm();
    const double distance = std::sqrt(r2);
    const double r_i = u_i.dot(r);
    const double r_k = u_k.dot(r);
    const double h_i = std::sqrt(shape_.b2 * r2 + shape_.c * (r_i * r_i));
    const double h_k = std::sqrt(shape_.b2 * r2 + shape_.c * (r_k * r_k));
    // Both sides times the distance; the share of 1e-9 covers the cancellation in h for discs.
    if (r2 - h_i - h_k > limit * distance + 1e-9 * r2) return false;
    normal = geom::internal::cold_normal(shape_, shape_, r, u_i, u_k);
    auto e = geom::internal::evaluate_uniaxial(shape_, shape_, r, u_i, u_k, normal);
    if (e.g > limit) return false;
    // Two more Newton steps at the most; a pair that is still undecided is taken, which is always safe.
    for (int step = 0; step < 2 && e.g + e.decrement > limit; ++step) {
      normal = geom::internal::step_on_sphere(normal, e.step);
      e = geom::internal::evaluate_uniaxial(shape_, shape_, r, u_i, u_k, normal);
      if (e.g > limit) return false;
    }
    normal = geom::internal::step_on_sphere(normal, e.step);
    return true;
  }

 private:
  double surface_speed(const AxisMotion& motion) const { return axis_difference_ * motion.rate * motion.e2.norm(); }

  geom::internal::Spheroid shape_;
  double axis_difference_;  ///< |a - b|
  double bounding_radius_;
  double thickness_;
  double exit_thickness_;
  std::vector<Eigen::Vector3d> centre_;
  std::vector<Eigen::Vector3d> axis_;
};

}  // namespace ed::internal
