#pragma once

/// Judgement of certified steps in quadruple precision (rounding_test.cpp).

#include <common/finder/ensemble.h>
#include <common/geom/exact_bodies.h>

#include <contact/certified.h>

#include <ed/random.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <algorithm>

namespace ed::internal {

using Eigen::Vector3d;
using finder_test::log_uniform;
using quad::Quad;

inline constexpr double kHorizon = 0.1;

struct Tally {
  long states = 0;
  long touching = 0;       ///< g is below what rounding may hide: no step, as there is nothing to certify
  long stepped_over = 0;   ///< contacts of the exact bodies within the step
  long without_terms = 0;  ///< contacts stepped over by steps made without the terms
  long not_apart = 0;      ///< g was above what rounding may hide, but the exact gap was not positive
  long sunk = 0;           ///< the search passed an overlap deeper than what it promises
  long contacts = 0, clear = 0;
  double gap = 0, rate = 0, curvature = 0;  ///< the largest errors, in units of their bounds
};

inline double signed_log_uniform(Random& random, double low, double high) {
  return random.uniform() < 0.5 ? -log_uniform(random, low, high) : log_uniform(random, low, high);
}

/// The best normal at time t, from a good one.
template <class PairGap>
Vector3d best_normal(const PairGap& pair_gap, double t, Vector3d n) {
  const auto state = pair_gap.at(t);
  auto e = pair_gap.evaluate(state, n);
  int budget = geom::kMaxIterations;
  (void)ascend(
      pair_gap, state, [&](const auto& trial) { return settled(pair_gap, trial); }, budget, n, e);
  return geom::kernel::step_on_sphere(n, e.step);
}

/// The distance of the exact bodies, or if that is positive any lower bound that is.
template <class PairGap, class Exact>
Quad distance(const PairGap& pair_gap, const Exact& exact, Quad t, const Vector3d& n) {
  const Quad along_n = exact.gap(t, n);
  if (along_n > 0) return along_n;
  // The error of a normal counts in second order.
  const Quad along_best = exact.gap(t, best_normal(pair_gap, static_cast<double>(t), n));
  return std::max(along_n, along_best);
}

/// The least distance at some times of [t, end]: at the end, at shares of the way, and where the gap along n is least.
template <class PairGap, class Exact>
Quad least_distance(const PairGap& pair_gap, const Exact& exact, double t, double end, const Vector3d& n) {
  const Quad span = static_cast<Quad>(end) - t;
  Quad least = distance(pair_gap, exact, end, n);
  const auto look = [&](Quad time) { least = std::min(least, distance(pair_gap, exact, time, n)); };
  for (const double share : {1e-6, 1e-3, 0.1, 0.5, 0.9}) look(t + share * span);
  const Quad g0 = exact.gap(t, n);
  const Quad g1 = exact.gap(t + span / 2, n);
  const Quad g2 = exact.gap(end, n);
  const Quad bend = g0 - 2 * g1 + g2;
  const Quad vertex = bend > 0 ? (3 * g0 - 4 * g1 + g2) / (4 * bend) : Quad(0);
  if (vertex > 0 && vertex < 1) look(t + vertex * span);
  return least;
}

/// Errors of g and g', and of K if the pair gap has one, in units of their bounds.
template <class PairGap, class Exact>
void measure_errors(const PairGap& pair_gap, const typename PairGap::State& state,
                    const typename PairGap::Evaluation& e, const Exact& exact, double t, const Vector3d& n,
                    Tally& tally) {
  const auto worst = [](double& sofar, Quad error, double bound) {
    sofar = std::max(sofar, static_cast<double>(error) / bound);
  };
  const Quad g = exact.gap(t, n);
  worst(tally.gap, quad::abs(e.g - g), state.rounding.gap);
  if constexpr (CurvatureBounded<PairGap>) {
    // Central differences: truncation 1e-20 and 1e-16, rounding 1e-24 and 1e-18, of g in units of its fastest motion.
    const Quad unit = pair_gap.size() / pair_gap.speed();
    const Quad step = static_cast<Quad>(1e-10) * unit;
    const Quad wide = static_cast<Quad>(1e-8) * unit;
    const Quad rate = (exact.gap(t + step, n) - exact.gap(t - step, n)) / (2 * step);
    const Quad bend = (exact.gap(t + wide, n) - 2 * g + exact.gap(t - wide, n)) / (wide * wide);
    worst(tally.rate, quad::abs(pair_gap.rate(state, e, n) - rate), state.rounding.rate);
    const double K = pair_gap.certificate(state, e, n).curvature(0);
    worst(tally.curvature, -bend - K, state.rounding.curvature);
  }
}

template <class State>
State without_terms(State state) {
  state.rounding = {};
  return state;
}

/// One pair at t, with the normal that it was made with.
template <class PairGap, class Exact>
void judge(const PairGap& pair_gap, const Exact& exact, double t, const Vector3d& start, Tally& tally) {
  ++tally.states;
  const auto state = pair_gap.at(t);
  Vector3d n = start;
  auto e = pair_gap.evaluate(state, n);
  int budget = geom::kMaxIterations;
  (void)ascend(
      pair_gap, state, [&](const auto& trial) { return settled(pair_gap, trial); }, budget, n, e);
  measure_errors(pair_gap, state, e, exact, t, n, tally);
  const double gp = pair_gap.rate(state, e, n);
  const auto passes = [&](const typename PairGap::State& s) {
    if (!(e.g > kTouching * pair_gap.size())) return false;  // a contact, with or without the terms
    const double tau =
        clears(pair_gap, s, e, n, kHorizon) ? kHorizon : certified_step(pair_gap, s, e, n, e.g, gp, kHorizon);
    return t + tau > t && least_distance(pair_gap, exact, t, t + tau, n) < 0;
  };
  if (e.g > state.rounding.gap) {
    if (!(exact.gap(t, n) > 0)) ++tally.not_apart;
    if (passes(state)) ++tally.stepped_over;
  } else {
    ++tally.touching;
  }
  if (passes(without_terms(state))) ++tally.without_terms;
}

/// The whole search: how deep the exact bodies overlap before the time it reports.
template <class PairGap, class Exact>
void judge_search(const PairGap& pair_gap, const Exact& exact, double t, const Vector3d& start, Tally& tally) {
  Vector3d n = start;
  FinderCounters count;
  const Finding finding = certified_contact(pair_gap, t, t + kHorizon, 1000, n, count);
  EXPECT_NE(finding.outcome, Outcome::declined);
  if (finding.outcome == Outcome::contact) ++tally.contacts;
  if (finding.outcome == Outcome::clear) ++tally.clear;
  // At the start the bodies may overlap by what rounding hides.
  const Quad begun = std::min(Quad(0), distance(pair_gap, exact, t, start));
  const Quad deepest = least_distance(pair_gap, exact, t, finding.time, n) - begun;
  const double promised = pair_gap.at(finding.time).rounding.gap + 2 * kTouching * pair_gap.size();
  if (deepest < -promised) ++tally.sunk;
}

}  // namespace ed::internal
