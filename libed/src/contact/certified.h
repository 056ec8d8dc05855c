#pragma once

/// The contact finder: one function over pair gaps, which uniaxial_gap.h defines.
///
/// Why no contact is ever stepped over. For a fixed unit n let g(tau) be the gap along n at time t + tau; the distance
/// is the maximum over n, so d(t + tau) >= g(tau) for every n. Let K >= -g'' on [0, T]. Integrating twice,
///
///     g(tau) >= q(tau) = g + g' tau - K tau^2 / 2   on [0, T],
///
/// so that no contact comes before the first root of q in [0, T]. The search goes there and starts again with a
/// better n. Near a contact d ~ |g'| (tc - t) and q's root falls short of tc by K (tc - t)^2 / (2 |g'|) at most:
/// convergence is quadratic. No resolution parameter enters; a grazing contact costs more steps, not a wrong answer.
///
/// The end. When the root of q and that of its tangent are close, Newton's method on d(t) takes over; its contact is
/// accepted only with a proof that none comes between the certified bound and it (see refine_contact).
///
/// Rounding. The step is made of g, g' and K less (K: and) all that rounding may hide of them, rounding.h, so that what
/// is said above is true of the exact bodies. Bodies whose g is no larger than that touch. If they approach, that is
/// the contact, its time improved by Newton's method where that succeeds. If they part, or rest (|g'| within kResting *
/// speed, where its sign is rounding), g and g' are set to 0 if below, and the step is at least the least_step of the
/// pair gap. docs/time-of-contact.md says what is promised then.

#include "base/archive.h"
#include "base/select.h"
#include "contact/curvature_steps.h"
#include "contact/least_step.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"

#include <ed/tolerances.h>

#include <geom/distance.h>
#include <geom/kernel/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <limits>

namespace ed::internal {

struct FinderCounters {
  std::uint64_t predictions = 0;         ///< calls
  std::uint64_t evaluations = 0;         ///< points in time at which a pair was evaluated
  std::uint64_t newton_evaluations = 0;  ///< evaluations of the final Newton on d(t) alone
  std::uint64_t kernel_calls = 0;        ///< evaluations of g along a normal
  std::uint64_t cold_restarts = 0;       ///< a warm normal had led to a spurious maximum
  std::uint64_t rescues = 0;             ///< the pair gap's last resort was needed
};

template <class Archive, Is<FinderCounters> T>
void fields(Archive& archive, T& c) {
  archive(c.predictions, c.evaluations, c.newton_evaluations, c.kernel_calls, c.cold_restarts, c.rescues);
}

enum class Outcome {
  contact,      ///< contact at `time`: the bodies touch and approach along the normal
  clear,        ///< certified: no contact up to t_end
  bound,        ///< certified: no contact before `time`; the budget of evaluations is spent
  overlapping,  ///< proved: at `time` the bodies overlap by more than kOverlap * size
  declined,     ///< certified: no contact before `time`, at which no method tells whether the bodies overlap
};

struct Finding {
  Outcome outcome;
  double time;
  bool approaching = false;  ///< whether the overlap grows, if the bodies overlap
};

enum class Quality {
  usable,    ///< the normal certifies a step, or says that the bodies touch
  clear,     ///< certified: no contact within the horizon
  overlap,   ///< the bodies overlap by more than kOverlap * size
  declined,  ///< no method tells
};

/// Improves n at one point in time until it certifies the whole horizon (by the pair gap's crude bound), or is good
/// enough for a step, or it is proved that the bodies overlap, or nothing more can be done.
template <class PairGap>
Quality improve_normal(const PairGap& gap, const typename PairGap::State& state, double horizon, Eigen::Vector3d& n,
                       typename PairGap::Evaluation& e, FinderCounters& count) {
  using geom::kernel::Ascent;
  const double size = gap.size();
  ++count.evaluations;
  ++count.kernel_calls;
  // Most pairs end here, with the normal they came with and no Newton step computed.
  const typename PairGap::Sample sample = gap.sample(state, n);
  if (clears(gap, state, sample, n, horizon)) return Quality::clear;
  e = gap.complete(state, sample, n);

  bool clear = false;
  const auto done = [&](const typename PairGap::Evaluation& trial) {
    clear = clears(gap, state, trial, n, horizon);
    if (clear) return true;
    const bool converged = trial.decrement <= kTightDecrement * size;
    // Only a converged normal may declare a contact.
    if (!(trial.g > state.rounding.gap)) return converged && settled(gap, trial);
    return converged || trial.decrement <= kLooseDecrement * trial.g;
  };
  for (int attempt = 0; attempt < 2; ++attempt) {
    int budget = geom::kMaxIterations;
    const Ascent ascent = ascend(gap, state, done, budget, n, e);
    count.kernel_calls += static_cast<std::uint64_t>(geom::kMaxIterations - budget);
    if (clear) return Quality::clear;
    // Any normal with g > 0 is a valid certificate, converged or not; that bodies touch takes the best one.
    const bool best = ascent == Ascent::converged || settled(gap, e);
    if (e.g > state.rounding.gap || (best && e.g >= -kOverlap * size)) return Quality::usable;
    // A stationary point no deeper than this is the global maximum (see geom/distance.h).
    if (ascent == Ascent::converged && -e.g <= gap.certified_depth()) return Quality::overlap;
    if (attempt == 0) {
      ++count.cold_restarts;
      n = gap.cold_normal(state);
      e = gap.evaluate(state, n);
      ++count.kernel_calls;
    }
  }
  ++count.rescues;
  switch (gap.separating_normal(state, n)) {
    case Separation::overlapping:
      return Quality::overlap;
    case Separation::declined:
      return Quality::declined;
    case Separation::apart:
      break;
  }
  e = gap.evaluate(state, n);
  ++count.kernel_calls;
  // If the bodies touch, the resort's normal is right to within its own error, and the ascent often succeeds from
  // there: without it a third more of bodies that part are taken to approach (finder_support_contact_test, "once
  // more").
  if (!(e.g > state.rounding.gap)) {
    int budget = geom::kMaxIterations;
    ascend(gap, state, done, budget, n, e);
    count.kernel_calls += static_cast<std::uint64_t>(geom::kMaxIterations - budget);
    if (clear) return Quality::clear;
  }
  return Quality::usable;
}

/// Evaluations for one converged normal near a contact, where the normal is nearly right to begin with.
inline constexpr int kRefineBudget = 12;

/// Newton's method on d(t) = 0 with converged normals, from `t`. True if it ended on a contact in `near` that is
/// certainly the first one after near.begin; t and n are changed only then.
template <class PairGap>
bool refine_contact(const PairGap& gap, const Window& near, double& t, Eigen::Vector3d& n, FinderCounters& count) {
  const double size = gap.size();
  double time = t;
  Eigen::Vector3d normal = n;
  const auto done = [&](const auto& trial) { return settled(gap, trial); };
  for (int iteration = 0; iteration < 6 && time >= near.begin && time <= near.end; ++iteration) {
    const auto state = gap.at(time);
    typename PairGap::Evaluation e = gap.evaluate(state, normal);
    int budget = kRefineBudget;
    const auto ascent = ascend(gap, state, done, budget, normal, e);
    count.kernel_calls += static_cast<std::uint64_t>(1 + kRefineBudget - budget);
    ++count.evaluations;
    ++count.newton_evaluations;
    if (ascent != geom::kernel::Ascent::converged) return false;
    const double d = e.g + 0.5 * e.decrement;
    const double rate = contact_rate(gap, state, e, normal);
    if (!(rate < 0) || !falls_since(gap, state, e, normal, rate, time - near.begin)) return false;
    normal = geom::kernel::step_on_sphere(normal, e.step);
    if (std::abs(d) <= kTouching * size) {
      t = time;
      n = normal;
      return true;
    }
    time -= d / rate;
  }
  return false;
}

/// Newton's method for the contact that the tangent of g promises, where the motion goes on nearly straight: between
/// the certified bound t + tau and a little beyond the tangent's root. True if it was worth trying and succeeded; then
/// `contact_time` and n are those of the contact.
template <class PairGap>
bool refine_tangent(const PairGap& gap, const typename PairGap::Evaluation& e, double t, double tau, double g,
                    double gp, double& contact_time, Eigen::Vector3d& n, FinderCounters& count) {
  const double spread = -g / gp - tau;
  if (!(gp < 0) || !worth_refining(gap, gp, spread)) return false;
  const double resolved = kTouching * gap.size();
  const Window near{larger(t, t + tau - resolved / gap.speed()), t + tau + 3 * spread + resolved / -gp};
  double time = t - g / gp;
  Eigen::Vector3d normal = geom::kernel::step_on_sphere(n, e.step);
  if (!refine_contact(gap, near, time, normal, count)) return false;
  contact_time = time;
  n = normal;
  return true;
}

/// Steps shorter than this share of certain_step() are made anew with bounds over a shorter time. Dimensionless; far
/// below what bounds over a fitting time ever give, so that nothing else changes.
inline constexpr double kFutileStep = 1e-3;

/// Certified step for which nothing has to be known but that no point of a surface moves faster than gap.speed():
/// not positive for bodies that touch.
template <class PairGap>
double certain_step(const PairGap& gap, const typename PairGap::State& state, double g) {
  return 0.9 * (g - state.rounding.gap) / gap.speed();
}

/// Returns the certified step, or a longer one. Bounds over a horizon in which bodies turn many times are very weak
/// (cubes with a horizon of 10,000 radian: steps of 1e-19), or are not a number (an infinite horizon). Where the step
/// is below the share `futile` of certain_step(), those of a radian or so do better.
template <class PairGap>
double fitting_step(const PairGap& gap, const typename PairGap::State& state, const typename PairGap::Evaluation& e,
                    const Eigen::Vector3d& n, double g, double gp, double horizon, double futile) {
  const double tau = certified_step(gap, state, e, n, g, gp, horizon);
  const double certain = certain_step(gap, state, g);
  if (!(tau < futile * certain)) return tau;
  const double within = smaller(horizon, gap.size() / gap.speed());
  return larger(certain, certified_step(gap, state, e, n, g, gp, within));
}

/// Finds the first contact in [t_begin, t_end], or proves that none comes, or, after `max_evaluations` points in time,
/// returns a time before which certainly none comes.
///
/// `n` (from A to B) is the warm start and is left at the last normal; zero: cold start. `futile`: see fitting_step.
template <class PairGap>
Finding certified_contact(const PairGap& gap, double t_begin, double t_end, int max_evaluations, Eigen::Vector3d& n,
                          FinderCounters& count, double futile = kFutileStep) {
  ++count.predictions;
  const Window window = gap.window(t_begin, t_end);
  const double size = gap.size();
  double t = window.begin;
  bool cold = n.isZero(0);
  for (int evaluation = 0; evaluation < max_evaluations; ++evaluation) {
    if (!(t < window.end)) return {Outcome::clear, t_end};
    const auto state = gap.at(t);
    if (cold) n = gap.cold_normal(state);
    cold = false;
    typename PairGap::Evaluation e;
    const double horizon = window.end - t;
    const Quality quality = improve_normal(gap, state, horizon, n, e, count);
    if (quality == Quality::clear) return {Outcome::clear, t_end};
    if (quality == Quality::declined) return {Outcome::declined, t};
    double g = e.g;
    double gp = gap.rate(state, e, n);
    const bool touching = g <= state.rounding.gap;
    if (quality == Quality::overlap || touching) {
      const bool approaching = contact_rate(gap, state, e, n) < -kResting * gap.speed();
      if (quality == Quality::overlap) return {Outcome::overlapping, t, approaching};
      if (approaching) {
        // What rounding may hide is the worst case: Newton's method usually knows the time better.
        double contact_time = t;
        const bool refined = g > kTouching * size && refine_tangent(gap, e, t, 0, g, gp, contact_time, n, count);
        // A decrement at the level of rounding leaves an error of its square root in the normal: one more step.
        if (!refined) n = geom::kernel::step_on_sphere(n, e.step);
        if (contact_time > t_end) return {Outcome::clear, t_end};
        return {Outcome::contact, contact_time};
      }
      g = larger(g, 0.0);
      gp = larger(gp, 0.0);
    }
    double tau = fitting_step(gap, state, e, n, g, gp, horizon, futile);
    if (tau >= horizon) return {Outcome::clear, t_end};
    // Along edges that are flat the support point, and with it g', is lost to rounding; that of the contact is not.
    const bool doubtful = !(gp < 0) && !touching && tau <= kShortStep * size / gap.speed();
    const double rate = doubtful ? contact_rate(gap, state, e, n) : gp;
    if (rate < 0) {
      double contact_time = t;
      if (refine_tangent(gap, e, t, tau, g, rate, contact_time, n, count)) {
        if (contact_time > t_end) return {Outcome::clear, t_end};
        return {Outcome::contact, contact_time};
      }
    }
    if (!(gp < 0)) tau = larger(tau, least_step(gap, state, e, n, touching, tau));
    if (t + tau > t) {
      t += tau;
    } else {
      // The step is below the resolution of time (late times only: g is above that of distance). If the bodies approach
      // and are not certainly apart until the next double, they touch before it; else the search continues there.
      if (gp < 0 && !(t + certain_step(gap, state, g) > t)) return {Outcome::contact, t};
      t = std::nextafter(t, std::numeric_limits<double>::infinity());
    }
  }
  return {t < window.end ? Outcome::bound : Outcome::clear, t};
}

}  // namespace ed::internal
