#pragma once

/// Bodies and motions that pair gaps hold.

#include <Eigen/Core>

namespace ed::internal {

/// Base of the pair gaps of two bodies with centres in uniform motion. Refers to the bodies and their motions.
template <class Body, class Motion>
class PairGapBase {
 protected:
  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  PairGapBase(const Body& A, const Motion& a, const Body& B, const Motion& b, const Eigen::Vector3d& r_now, double now)
      : A_(A), B_(B), a_(a), b_(b), r_now_(r_now), v_(b.velocity - a.velocity), now_(now) {}

  /// Returns the vector from A's centre to B's at time t.
  Eigen::Vector3d r_at(double t) const { return r_now_ + (t - now_) * v_; }

  const Body& A_;
  const Body& B_;
  const Motion& a_;
  const Motion& b_;
  Eigen::Vector3d r_now_;
  Eigen::Vector3d v_;
  double now_;
};

}  // namespace ed::internal
