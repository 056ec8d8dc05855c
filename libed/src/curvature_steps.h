#pragma once

/// What certified_contact asks of a gauge whose g has a second derivative bounded from below for every n and t
/// (curvature_limit) and, better, over an interval ahead (certificate). Gauges without such a bound, of bodies with
/// flat faces, answer these questions by members of the same names: see support_gauge.h.

#include "neighbour_lists.h"
#include "select.h"

#include <ed/tolerances.h>

#include <geom/internal/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

/// First root tau > 0 of g + gp tau - K tau^2 / 2 for g >= 0; infinite if there is none, 0 if a number is not one.
inline double first_root(double g, double gp, double K) {
  const double discriminant = gp * gp + 2 * K * g;
  if (!(discriminant >= 0)) return discriminant < 0 ? kNever : 0;
  const double root = std::sqrt(discriminant);
  if (gp < 0) return 2 * g / (root - gp);
  return K > 0 ? (gp + root) / K : kNever;
}

template <class Gauge>
concept CurvatureBounded = requires(const Gauge& gauge) {
  gauge.curvature_limit();
};

/// Whether n certifies by itself that there is no contact within the horizon: a concave parabola that is positive at
/// both ends has no root between.
template <CurvatureBounded Gauge, class GapOrEvaluation>
bool clears(const Gauge& gauge, const typename Gauge::State& state, const GapOrEvaluation& e, const Eigen::Vector3d& n,
            double horizon) {
  const double worst_turn = 0.5 * gauge.curvature_limit() * horizon;
  return e.g > kTouching * gauge.size() && e.g + horizon * (gauge.rate(state, e, n) - worst_turn) > 0;
}

/// Improves n until done(e), as geom::internal::ascend.
template <CurvatureBounded Gauge, class Done>
geom::internal::Ascent ascend(const Gauge& gauge, const typename Gauge::State& state, const Done& done, int& budget,
                              Eigen::Vector3d& n, typename Gauge::Evaluation& e) {
  const auto evaluate = [&](const Eigen::Vector3d& m) { return gauge.evaluate(state, m); };
  return geom::internal::ascend(evaluate, geom::kRoundingFactor * gauge.size(), done, budget, n, e);
}

/// The rate of g that says whether bodies that touch approach.
template <CurvatureBounded Gauge>
double contact_rate(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                    const Eigen::Vector3d& n) {
  return gauge.rate(state, e, n);
}

/// A time, at most `horizon`, up to which there is certainly no contact, for a gap g >= 0 that changes at rate gp.
template <CurvatureBounded Gauge>
double certified_step(const Gauge& gauge, const typename Gauge::State& state, const typename Gauge::Evaluation& e,
                      const Eigen::Vector3d& n, double g, double gp, double horizon) {
  const auto certificate = gauge.certificate(state, e, n);
  double tau = smaller(horizon, first_root(g, gp, certificate.curvature(horizon)));
  for (int attempt = 0; attempt < 2 && tau < horizon; ++attempt) {
    const double reach = smaller(horizon, 2 * tau);
    tau = larger(tau, smaller(reach, first_root(g, gp, certificate.curvature(reach))));
  }
  return tau;
}

/// How far bodies that touch and do not approach may be moved, certified up to tau: the overlap on the way stays below
/// what g resolves. By the bound that holds over any reach: certificates may be those of a short one.
template <CurvatureBounded Gauge>
double least_step(const Gauge& gauge, const typename Gauge::State& /*state*/, const Eigen::Vector3d& /*n*/,
                  double /*tau*/) {
  return std::sqrt(2 * kTouching * gauge.size() / gauge.curvature_limit());
}

/// Whether Newton's method on d(t) is likely to be certified at a contact `spread` or so behind a certified bound.
template <CurvatureBounded Gauge>
bool worth_refining(const Gauge& gauge, double gp, double spread) {
  return spread <= kTangentAgreement * gauge.size() / gauge.speed() && 8 * spread * gauge.curvature_limit() < -gp;
}

/// Whether the distance, 0 now and changing at `rate` < 0 with the best normal, certainly was positive all the time
/// `span` before.
///
/// d, a maximum of functions with second derivatives >= -K, has d'(s) <= d'(t) + K (t - s) for s < t. So if d'(t) < -K
/// span, the distance falls all the way to t.
template <CurvatureBounded Gauge>
bool falls_since(const Gauge& gauge, const typename Gauge::State& /*state*/, const typename Gauge::Evaluation& /*e*/,
                 const Eigen::Vector3d& /*n*/, double rate, double span) {
  return rate < -kResting * gauge.speed() - gauge.curvature_limit() * span;
}

// Gauges that answer themselves.

template <class Gauge, class... Arguments>
bool clears(const Gauge& gauge, const typename Gauge::State& state, const Arguments&... arguments) {
  return gauge.clears(state, arguments...);
}
template <class Gauge, class Done>
geom::internal::Ascent ascend(const Gauge& gauge, const typename Gauge::State& state, const Done& done, int& budget,
                              Eigen::Vector3d& n, typename Gauge::Evaluation& e) {
  return gauge.ascend(state, done, budget, n, e);
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
