#pragma once

/// What certified_contact asks of a gauge whose g has a second derivative bounded from below for every n and t
/// (curvature_limit) and, better, over an interval ahead (certificate). Gauges without such a bound, of bodies with
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

template <class Gauge>
concept CurvatureBounded = requires(const Gauge& gauge) {
  gauge.curvature_limit();
};

/// Whether n certifies by itself that there is no contact within the horizon. Here and below with what rounding may
/// hide taken off (rounding.h).
template <CurvatureBounded Gauge, class GapOrEvaluation>
bool clears(const Gauge& gauge, const typename Gauge::State& state, const GapOrEvaluation& e, const Eigen::Vector3d& n,
            double horizon) {
  return clear_by_parabola(e.g, gauge.rate(state, e, n), gauge.curvature_limit(), state.rounding, horizon);
}

/// Improves n until done(e), as geom::kernel::ascend.
template <CurvatureBounded Gauge, class Done>
geom::kernel::Ascent ascend(const Gauge& gauge, const typename Gauge::State& state, const Done& done, int& budget,
                            Eigen::Vector3d& n, typename Gauge::Evaluation& e) {
  const auto evaluate = [&](const Eigen::Vector3d& m) { return gauge.evaluate(state, m); };
  return geom::kernel::ascend(evaluate, geom::kRoundingFactor * gauge.size(), done, budget, n, e);
}

/// Whether g and half the decrement are the distance to rounding: what is left is of third order in the step.
template <CurvatureBounded Gauge>
bool settled(const Gauge& /*gauge*/, const typename Gauge::Evaluation& e) {
  return e.step2 <= geom::kNormalTolerance2;
}

/// The rate of g that says whether bodies that touch approach.
template <CurvatureBounded Gauge>
double contact_rate(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                    const Eigen::Vector3d& n) {
  return gauge.rate(state, e, n);
}

/// A time, at most `horizon`, up to which there is certainly no contact, for a gap g >= 0 that changes at rate gp, both
/// as computed.
template <CurvatureBounded Gauge>
double certified_step(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                      const Eigen::Vector3d& n, double g, double gp, double horizon) {
  const auto certificate = gauge.certificate(state, e, n);
  return step_by_parabola(g, gp, state.rounding, horizon, [&](double reach) { return certificate.curvature(reach); });
}

/// How far bodies that do not approach may be moved, certified up to tau: if they touch, as far as the overlap on the
/// way stays below what g resolves, kTouching * size for the turning and as much for a rate whose sign is rounding. By
/// the bound that holds over any reach: certificates may be those of a short one.
template <CurvatureBounded Gauge>
double least_step(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& /*e*/,
                  const Eigen::Vector3d& /*n*/, bool touching, double tau) {
  if (!touching) return tau;
  const double allowed = kTouching * gauge.size();
  return smaller(std::sqrt(2 * allowed / gauge.curvature_limit()),
                 allowed / (kResting * gauge.speed() + state.rounding.rate));
}

template <CurvatureBounded Gauge>
bool worth_refining(const Gauge& gauge, double gp, double spread) {
  return nearly_straight(gp, spread, gauge.size(), gauge.speed(), gauge.curvature_limit());
}

/// Whether the distance, 0 now and changing at `rate` < 0 with the best normal, certainly was positive all the time
/// `span` before.
///
/// d, a maximum of functions with second derivatives >= -K, has d'(s) <= d'(t) + K (t - s) for s < t. So if d'(t) < -K
/// span, the distance falls all the way to t. d'(t) is the rate at the best normal, a Newton step from n (two allow for
/// its error).
template <CurvatureBounded Gauge>
bool falls_since(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                 const Eigen::Vector3d& /*n*/, double rate, double span) {
  const Rounding& hidden = state.rounding;
  const double best_rate = rate + 2 * std::sqrt(e.step2) * gauge.rate_slope() + hidden.rate;
  return best_rate < -kResting * gauge.speed() - (gauge.curvature_limit() + hidden.curvature) * span;
}

// Gauges that answer themselves.

template <class Gauge, class... Arguments>
bool clears(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.clears(state, arguments...);
}
template <class Gauge, class Done>
geom::kernel::Ascent ascend(const Gauge& gauge, const typename Gauge::State& state, const Done& done, int& budget,
                            Eigen::Vector3d& n, typename Gauge::Evaluation& e) {
  return gauge.ascend(state, done, budget, n, e);
}
template <class Gauge>
bool settled(const Gauge& gauge, const typename Gauge::Evaluation& e) {
  return gauge.settled(e);
}
template <class Gauge, class... Arguments>
double contact_rate(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.contact_rate(state, arguments...);
}
template <class Gauge, class... Arguments>
double certified_step(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.certified_step(state, arguments...);
}
template <class Gauge, class... Arguments>
double least_step(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.least_step(state, arguments...);
}
template <class Gauge>
bool worth_refining(const Gauge& gauge, double gp, double spread) {
  return gauge.worth_refining(gp, spread);
}
template <class Gauge, class... Arguments>
bool falls_since(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.falls_since(state, arguments...);
}

}  // namespace ed::internal
