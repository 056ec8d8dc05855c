#pragma once

/// Questions of certified_contact about a pair gap whose g has a second derivative bounded from below for every n and t
/// (curvature_limit) and, better, over an interval ahead (certificate). Pair gaps without such a bound, of bodies with
/// flat faces, answer these questions by members of the same names: see support_gap.h.

#include "base/select.h"
#include "contact/parabola_steps.h"
#include "contact/rounding.h"

#include <ed/tolerances.h>

#include <geom/kernel/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

template <class PairGap>
concept CurvatureBounded = requires(const PairGap& gap) {
  gap.curvature_limit();
};

/// Returns whether n certifies by itself that no contact comes within the horizon. What rounding may hide (rounding.h)
/// is taken off, here and below.
template <CurvatureBounded PairGap, class SampleOrEvaluation>
bool clears(const PairGap& gap, const typename PairGap::State& state, const SampleOrEvaluation& e,
            const Eigen::Vector3d& n, double horizon) {
  return clear_by_parabola(e.g, gap.rate(state, e, n), gap.curvature_limit(), state.rounding, horizon);
}

/// Improves n until done(e), as geom::kernel::ascend.
template <CurvatureBounded PairGap, class Done>
geom::kernel::Ascent ascend(const PairGap& gap, const typename PairGap::State& state, const Done& done, int& budget,
                            Eigen::Vector3d& n, typename PairGap::Evaluation& e) {
  const auto evaluate = [&](const Eigen::Vector3d& m) { return gap.evaluate(state, m); };
  return geom::kernel::ascend(evaluate, geom::kRoundingFactor * gap.size(), done, budget, n, e);
}

/// Whether g and half the decrement are the distance to rounding: what is left is of third order in the step.
template <CurvatureBounded PairGap>
bool settled(const PairGap& /*gap*/, const typename PairGap::Evaluation& e) {
  return e.step2 <= geom::kNormalTolerance2;
}

/// The rate of g that says whether bodies that touch approach.
template <CurvatureBounded PairGap>
double contact_rate(const PairGap& gap, const typename PairGap::State& state, const typename PairGap::Evaluation& e,
                    const Eigen::Vector3d& n) {
  return gap.rate(state, e, n);
}

/// A time, at most `horizon`, up to which there is certainly no contact, for a gap g >= 0 that changes at rate gp, both
/// as computed.
template <CurvatureBounded PairGap>
double certified_step(const PairGap& gap, const typename PairGap::State& state, const typename PairGap::Evaluation& e,
                      const Eigen::Vector3d& n, double g, double gp, double horizon) {
  const auto certificate = gap.certificate(state, e, n);
  return step_by_parabola(g, gp, state.rounding, horizon, [&](double reach) { return certificate.curvature(reach); });
}

/// Returns the time by which bodies that do not approach may be moved, certified up to tau. Bodies that touch may be
/// moved while the overlap on the way stays below what g resolves, kTouching * size for the turning and as much for a
/// rate whose sign is rounding. By the bound that holds over any reach: certificates may be those of a short one.
template <CurvatureBounded PairGap>
double least_step(const PairGap& gap, const typename PairGap::State& state, const typename PairGap::Evaluation& /*e*/,
                  const Eigen::Vector3d& /*n*/, bool touching, double tau) {
  if (!touching) return tau;
  const double allowed = kTouching * gap.size();
  return smaller(std::sqrt(2 * allowed / gap.curvature_limit()),
                 allowed / (kResting * gap.speed() + state.rounding.rate));
}

template <CurvatureBounded PairGap>
bool worth_refining(const PairGap& gap, double gp, double spread) {
  return nearly_straight(gp, spread, gap.size(), gap.speed(), gap.curvature_limit());
}

/// Whether the distance, 0 now and changing at `rate` < 0 with the best normal, certainly was positive all the time
/// `span` before.
///
/// d, a maximum of functions with second derivatives >= -K, has d'(s) <= d'(t) + K (t - s) for s < t. So if d'(t) < -K
/// span, the distance falls all the way to t. d'(t) is the rate at the best normal, a Newton step from n (two allow for
/// its error).
template <CurvatureBounded PairGap>
bool falls_since(const PairGap& gap, const typename PairGap::State& state, const typename PairGap::Evaluation& e,
                 const Eigen::Vector3d& /*n*/, double rate, double span) {
  const Rounding& hidden = state.rounding;
  const double best_rate = rate + 2 * std::sqrt(e.step2) * gap.rate_slope() + hidden.rate;
  return best_rate < -kResting * gap.speed() - (gap.curvature_limit() + hidden.curvature) * span;
}

// Pair gaps that answer themselves.

template <class PairGap, class... Arguments>
bool clears(const PairGap& gap, const typename PairGap::State& state, const Arguments&... arguments) {
  return gap.clears(state, arguments...);
}
template <class PairGap, class Done>
geom::kernel::Ascent ascend(const PairGap& gap, const typename PairGap::State& state, const Done& done, int& budget,
                            Eigen::Vector3d& n, typename PairGap::Evaluation& e) {
  return gap.ascend(state, done, budget, n, e);
}
template <class PairGap>
bool settled(const PairGap& gap, const typename PairGap::Evaluation& e) {
  return gap.settled(e);
}
template <class PairGap, class... Arguments>
double contact_rate(const PairGap& gap, const typename PairGap::State& state, const Arguments&... arguments) {
  return gap.contact_rate(state, arguments...);
}
template <class PairGap, class... Arguments>
double certified_step(const PairGap& gap, const typename PairGap::State& state, const Arguments&... arguments) {
  return gap.certified_step(state, arguments...);
}
template <class PairGap, class... Arguments>
double least_step(const PairGap& gap, const typename PairGap::State& state, const Arguments&... arguments) {
  return gap.least_step(state, arguments...);
}
template <class PairGap>
bool worth_refining(const PairGap& gap, double gp, double spread) {
  return gap.worth_refining(gp, spread);
}
template <class PairGap, class... Arguments>
bool falls_since(const PairGap& gap, const typename PairGap::State& state, const Arguments&... arguments) {
  return gap.falls_since(state, arguments...);
}

}  // namespace ed::internal
