#pragma once

/// Adapter of the finder under test for a MovingPair.

#include <common/finder/ensemble.h>

#include <contact/certified.h>
#include <contact/uniaxial_gap.h>

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

namespace finder_test {

inline geom::kernel::Spheroid spheroid_of(const geom::Ellipsoid& shape) {
  return {shape.semi_axes().z(), shape.semi_axes().x()};
}

/// Returns the state in the form of libed's internals. `spins`: false for bodies that never spin about their axis.
inline ed::internal::AxisMotion axis_motion(const BodyState& state, const Moments& moments, bool spins) {
  ed::internal::UniaxialInertia inertia;
  inertia.perpendicular = moments.perpendicular;
  inertia.axial = moments.axial;
  inertia.spins = spins;
  ed::internal::AxisMotion motion;
  ed::internal::BodyFrame frame;
  motion.position = state.position;
  motion.velocity = state.velocity;
  motion.time = 0;
  frame.spin = state.spin;
  ed::internal::set_rotation(inertia, state.axis(), state.across, motion, frame);
  return motion;
}

/// A pair gap that owns what UniaxialGap refers to.
template <bool kSpin>
class OwnedGap {
 public:
  OwnedGap(const Fluid& fluid, const MovingPair& pair)
      : shape_(spheroid_of(fluid.shape())),
        a_(axis_motion(pair.a, fluid.moments(), kSpin)),
        b_(axis_motion(pair.b, fluid.moments(), kSpin)),
        gap_(shape_, a_, shape_, b_, pair.b.position - pair.a.position, 0, fluid.size()) {}
  OwnedGap(const OwnedGap&) = delete;
  OwnedGap& operator=(const OwnedGap&) = delete;

  const ed::internal::UniaxialGap<kSpin>& gap() const { return gap_; }

 private:
  geom::kernel::Spheroid shape_;
  ed::internal::AxisMotion a_;
  ed::internal::AxisMotion b_;
  ed::internal::UniaxialGap<kSpin> gap_;
};

/// A pair gap whose bounds of the curvature are wrong: `1 / divisor` of the right ones.
template <class PairGap>
class WeakenedGap : public PairGap {
 public:
  WeakenedGap(const PairGap& gap, double divisor) : PairGap(gap), divisor_(divisor) {}

  struct Certificate {
    typename PairGap::Certificate proper;
    double divisor;
    double curvature(double tau) const { return proper.curvature(tau) / divisor; }
  };
  Certificate certificate(const typename PairGap::State& state, const typename PairGap::Evaluation& e,
                          const Eigen::Vector3d& n) const {
    return {PairGap::certificate(state, e, n), divisor_};
  }
  double curvature_limit() const { return PairGap::curvature_limit() / divisor_; }

 private:
  double divisor_;
};

/// Number of evaluations that no search of these tests exceeds.
inline constexpr int kManyEvaluations = 100000;

template <class PairGap>
ed::internal::Finding search(const PairGap& gap, double t_end, ed::internal::FinderCounters& count) {
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  return ed::internal::certified_contact(gap, 0, t_end, kManyEvaluations, n, count);
}

/// Returns the first contact of the pair up to t_end as libed finds it; if `divisor` is not 1, by a finder made wrong.
inline ed::internal::Finding find_contact(const Fluid& fluid, const MovingPair& pair, double t_end,
                                          ed::internal::FinderCounters& count, double divisor = 1) {
  const auto find = [&](const auto& gap) {
    return divisor == 1 ? search(gap, t_end, count) : search(WeakenedGap(gap, divisor), t_end, count);
  };
  return fluid.spins() ? find(OwnedGap<true>(fluid, pair).gap()) : find(OwnedGap<false>(fluid, pair).gap());
}

}  // namespace finder_test
