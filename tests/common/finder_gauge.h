#pragma once

/// The finder under test, fed with a MovingPair.

#include <common/finder_ensemble.h>

#include <contact/certified.h>
#include <contact/uniaxial_gap.h>

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

namespace finder_test {

inline geom::kernel::Spheroid spheroid_of(const geom::Ellipsoid& shape) {
  return {shape.semi_axes().z(), shape.semi_axes().x()};
}

/// The state as libed's internals keep it. `spins`: false for bodies that never spin about their axis.
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

/// A gauge that owns what UniaxialGauge refers to.
template <bool kSpin>
class PairGauge {
 public:
  PairGauge(const Fluid& fluid, const MovingPair& pair)
      : shape_(spheroid_of(fluid.shape())),
        a_(axis_motion(pair.a, fluid.moments(), kSpin)),
        b_(axis_motion(pair.b, fluid.moments(), kSpin)),
        gauge_(shape_, a_, shape_, b_, pair.b.position - pair.a.position, 0, fluid.size()) {}
  PairGauge(const PairGauge&) = delete;
  PairGauge& operator=(const PairGauge&) = delete;

  const ed::internal::UniaxialGauge<kSpin>& gauge() const { return gauge_; }

 private:
  geom::kernel::Spheroid shape_;
  ed::internal::AxisMotion a_;
  ed::internal::AxisMotion b_;
  ed::internal::UniaxialGauge<kSpin> gauge_;
};

/// A gauge whose bounds of the curvature are wrong: `1 / divisor` of the right ones.
template <class Gauge>
class WeakenedGauge : public Gauge {
 public:
  WeakenedGauge(const Gauge& gauge, double divisor) : Gauge(gauge), divisor_(divisor) {}

  struct Certificate {
    typename Gauge::Certificate proper;
    double divisor;
    double curvature(double tau) const { return proper.curvature(tau) / divisor; }
  };
  Certificate certificate(const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                          const Eigen::Vector3d& n) const {
    return {Gauge::certificate(state, e, n), divisor_};
  }
  double curvature_limit() const { return Gauge::curvature_limit() / divisor_; }

 private:
  double divisor_;
};

/// More points in time than any search of these tests needs.
inline constexpr int kManyEvaluations = 100000;

template <class Gauge>
ed::internal::Finding search(const Gauge& gauge, double t_end, ed::internal::FinderCounters& count) {
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  return ed::internal::certified_contact(gauge, 0, t_end, kManyEvaluations, n, count);
}

/// The first contact of the pair up to t_end as libed finds it; with `divisor` other than 1, by a finder made wrong.
inline ed::internal::Finding find_contact(const Fluid& fluid, const MovingPair& pair, double t_end,
                                          ed::internal::FinderCounters& count, double divisor = 1) {
  const auto find = [&](const auto& gauge) {
    return divisor == 1 ? search(gauge, t_end, count) : search(WeakenedGauge(gauge, divisor), t_end, count);
  };
  return fluid.spins() ? find(PairGauge<true>(fluid, pair).gauge()) : find(PairGauge<false>(fluid, pair).gauge());
}

}  // namespace finder_test
