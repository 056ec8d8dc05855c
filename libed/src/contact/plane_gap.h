#pragma once

/// The gap of a body of revolution inside a half-space and its plane (uniaxial_gap.h defines pair gaps). The normal n
/// is that of the plane, outward, and never changes: g(t) = offset - n.r(t) - h(n, u(t)).

#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "contact/uniaxial_gap.h"
#include "motion/axis_motion.h"

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace ed::internal {

template <bool kSpin>
class PlaneGap {
 public:
  struct State {
    Eigen::Vector3d r, u, du;
    Rounding rounding;
  };
  struct Sample {
    double g;
    double x;
    double lever;
  };
  struct Evaluation : geom::kernel::Evaluation {
    double x;
    double lever;
  };
  struct Certificate {
    const PlaneGap& gap;
    SupportCurvature<kSpin> body;
    double curvature(double tau) const { return body.bound(gap.shape_, tau); }
  };

  /// The half-space is {x : n.x <= offset}, with positions in the image of `r_now`, the body's centre at `now`.
  PlaneGap(const Spheroid& shape, const AxisMotion& motion, const Eigen::Vector3d& r_now, double now, double offset,
           double reach)
      : shape_(shape), motion_(motion), r_now_(r_now), now_(now), offset_(offset), reach_(reach), scales_(scales()) {}

  State at(double t) const {
    State s;
    s.r = r_now_ + (t - now_) * motion_.velocity;
    turn<kSpin>(motion_, t, s.u, s.du);
    s.rounding = scales_.rounding(t);
    return s;
  }

  Sample sample(const State& s, const Eigen::Vector3d& n) const {
    const double x = s.u.dot(n);
    const double h = std::sqrt(shape_.b2 * (s.u - x * n).squaredNorm() + shape_.a2 * (x * x));
    return {offset_ - n.dot(s.r) - h, x, shape_.c * x / h};
  }

  /// No better normal is to be had: the step is zero.
  Evaluation complete(const State& /*s*/, const Sample& sample, const Eigen::Vector3d& /*n*/) const {
    Evaluation e;
    e.g = sample.g;
    e.decrement = 0;
    e.step2 = 0;
    e.step.setZero();
    e.x = sample.x;
    e.lever = sample.lever;
    return e;
  }

  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return complete(s, sample(s, n), n); }

  template <class SampleOrEvaluation>
  double rate(const State& s, const SampleOrEvaluation& e, const Eigen::Vector3d& n) const {
    return -n.dot(motion_.velocity) - e.lever * n.dot(s.du);
  }

  Certificate certificate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const {
    return {*this, support_curvature<kSpin>(motion_, s.du, e.x, n)};
  }

  Eigen::Vector3d cold_normal(const State& /*s*/) const { return Eigen::Vector3d::Zero(); }
  Separation separating_normal(const State& /*s*/, Eigen::Vector3d& /*n*/) const { return Separation::overlapping; }
  Window window(double t_begin, double t_end) const { return {t_begin, t_end}; }
  double curvature_limit() const { return shape_.turning_limit * (motion_.rate * motion_.rate); }
  double rate_slope() const { return 0; }  // n never changes
  double size() const { return reach_; }
  double certified_depth() const { return std::numeric_limits<double>::infinity(); }
  double speed() const { return motion_.velocity.norm() + reach_ * motion_.rate; }

 private:
  /// Returns the scales as for a pair; the plane is as far away as the body, and the offset twice rounded.
  PairScalesOf<double> scales() const {
    return {.size = reach_,
            .places = 2 * (sum_of_magnitudes(r_now_) + std::abs(offset_)),
            .speed = sum_of_magnitudes(motion_.velocity),
            .surface_speed = reach_ * motion_.axis_rate(),
            .bending = shape_.turning_limit * motion_.axis_rate(),
            .limit = curvature_limit(),
            .origin = larger(std::abs(now_), std::abs(motion_.time))};
  }

  const Spheroid& shape_;
  const AxisMotion& motion_;
  Eigen::Vector3d r_now_;
  double now_;
  double offset_;
  double reach_;
  PairScalesOf<double> scales_;
};

}  // namespace ed::internal
