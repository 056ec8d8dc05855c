#pragma once

#include <ed/analysis.h>
#include <ed/export.h>
#include <ed/simulation.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace ed {

/// Time correlations at one lag. Errors are standard errors over blocks, corrected for the data that neighbouring
/// blocks share.
struct LagRow {
  double lag;
  Estimate msd;           ///< <|r(t) - r(0)|^2>
  Estimate rot_msd;       ///< <|Delta Phi|^2>, Delta Phi = integral of omega (spin excluded), world frame
  Estimate rot_msd_body;  ///< the same with the components along the body's axes accumulated
  Estimate c2;            ///< <P2(u(t).u(0))>
};

/// Averages over one stretch of the run.
struct BlockRow {
  double begin;
  double end;
  double collision_rate;
  double Z;
  double translational_kT;
  double rotational_kT;
  double S;
};

/// What a run measured. Errors are standard errors over blocks.
struct Results {
  double duration = 0;
  Estimate collision_rate;  ///< collisions a body takes part in, a time unit: 2 N_coll / (N t)
  Estimate Z;               ///< 1 + sum of r_AB.dp / (3 N kT t), kT the measured translational temperature
  Estimate translational_kT;
  Estimate rotational_kT;
  Estimate S;            ///< largest eigenvalue of Q, averaged over frames
  Estimate D_trans;      ///< slope of the MSD / 6 over [0.4, 1] of the longest lag
  Estimate D_rot;        ///< slope of rot_msd / 4 there (the paper's 4t, two components)
  Estimate D_rot_body;   ///< slope of rot_msd_body / 4
  Estimate t_C2_1overe;  ///< where C2 falls to 1/e
  Estimate tau_C2;       ///< of A exp[-(t/tau)^beta], ballistic part excluded
  Estimate beta_C2;
  std::vector<LagRow> lags;
  std::vector<BlockRow> blocks;
};

/// What `Observables` has to know beforehand.
struct ObservablesOptions {
  int number;              ///< of bodies
  double duration;         ///< planned; the run may be stopped earlier
  double longest_lag = 0;  ///< 0: a sixteenth of the duration, at most 40
};

/// Observables of a run, measured while it goes on, in memory that does not grow with its length.
///
/// Time origins follow each other at a sixteenth of the longest lag (more for very large systems); each is correlated
/// with the states at 20 lags a decade after it. Origins are gathered in blocks of one longest lag; when there are more
/// than 32 blocks, neighbours are merged. Diffusion coefficients are null until the mean square displacement grows
/// linearly (its logarithmic slope over the fit window within 0.2 of 1).
class ED_EXPORT Observables {
 public:
  /// Of a run that is about to start, at time 0.
  explicit Observables(const ObservablesOptions& options);
  ~Observables();
  Observables(Observables&&) noexcept;             ///< the one moved from can only be assigned to or destroyed
  Observables& operator=(Observables&&) noexcept;  ///< the same

  /// The next time (since the start) at which the state is wanted; infinite when the planned duration is covered.
  double next_time() const;

  /// Takes what is due: run `simulation`, started at time 0 together with this object, to next_time() first.
  void measure(const Simulation& simulation);

  /// All results so far; `simulation` gives the totals.
  Results results(const Simulation& simulation) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Largest eigenvalue of Q = 3/2 <u u^T> - 1/2 (averaged over bodies): the nematic order of one frame.
ED_EXPORT double nematic_order(const std::vector<Eigen::Vector3d>& axes);

/// <P2(u.u0)> between two snapshots.
ED_EXPORT double c2_between(const Snapshot& origin, const Snapshot& now);
/// <|r - r0|^2> between two snapshots.
ED_EXPORT double msd_between(const Snapshot& origin, const Snapshot& now);

}  // namespace ed
