#pragma once

#include <ed/analysis.h>
#include <ed/export.h>
#include <ed/simulation.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ed {

/// Bodies whose observables are also wanted by themselves: a species. The groups of a system stand one after the other
/// in the order of its bodies.
struct BodyGroup {
  int number;
  /// Components of the rotation: 2 of bodies that shape and inertia make bodies of revolution (symmetry_axis of their
  /// Species; spin excluded), 3 of others.
  int rotation_axes = 2;
};

/// Time correlations at one lag. Errors are standard errors over blocks, corrected for the data that neighbouring
/// blocks share.
struct LagRow {
  double lag;
  Estimate msd;           ///< <|r(t) - r(0)|^2>
  Estimate rot_msd;       ///< <|Delta Phi|^2>, Delta Phi = integral of omega (spin excluded), world frame
  Estimate rot_msd_body;  ///< the same with the components along the body's axes accumulated
  Estimate c1;            ///< <u(t).u(0)>, u the axis of revolution; of bodies that have none: body z
  Estimate c2;            ///< <P2(u(t).u(0))>
  Estimate alpha2;        ///< 3 <|dr|^4> / (5 <|dr|^2>^2) - 1: 0 where displacements are Gaussian
  Estimate vacf;          ///< <v(t).v(0)>
  Estimate wacf;          ///< <omega(t).omega(0)>, spin excluded, world frame
  /// Of groups with three rotation axes, each body axis by itself; NaN for others.
  /// @{
  std::array<Estimate, 3> rot_msd_axis{};  ///< the share of rot_msd_body
  std::array<Estimate, 3> c1_axis{};       ///< c1 of that axis
  std::array<Estimate, 3> c2_axis{};       ///< c2 of that axis
  /// @}
  std::vector<Estimate> f_self{};  ///< F_self(q, t) at each of the wave numbers asked for
};

/// A symmetric tensor, element by element.
struct TensorEstimate {
  Eigen::Matrix3d value = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix3d error = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// The eigenvector of the largest eigenvalue of Q, averaged over frames first. n and -n are the same: its largest
/// component is positive.
struct Director {
  Eigen::Vector3d axis = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Standard error, an angle: sqrt(sum of sin^2 of the blocks' angles to it / (n (n - 1))). Of an isotropic state it
  /// is large.
  double error = std::numeric_limits<double>::quiet_NaN();
};

/// The lags that a fit has used; NaN: there is none.
struct FitWindow {
  double from = std::numeric_limits<double>::quiet_NaN();
  double to = std::numeric_limits<double>::quiet_NaN();
};

/// Pairs of bodies whose centres are about r apart.
struct PairRow {
  double r;     ///< the middle of the bin
  Estimate g;   ///< g(r): their number over that in an ideal gas
  Estimate g2;  ///< <P2(u_i.u_j)>; NaN where there are none
};

/// S(q) over wave vectors of the box of about that length.
struct WaveRow {
  double q;  ///< their mean length
  Estimate S;
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
  Eigen::Vector3d director;
  Eigen::Matrix3d pressure;  ///< as in Results
};

/// Results from the correlations of some of the bodies.
///
/// Diffusion coefficients are slopes of displacements over [0.4, 1] of the longest lag. They exist where motion is
/// diffusive there; otherwise Estimate::missing says why they do not:
/// - the logarithmic slope over these lags is 1 +- 0.2;
/// - D_trans: bodies have left their cages at the first of these lags: x = MSD q^2 / 6 >= 1, and F_self(q) to the order
///   of alpha2, exp(-x) (1 + alpha2 x^2 / 2), is at most 1/e. q is the wave number of the first peak of S(q) of all
///   bodies, measured with the rest whatever wave numbers F_self is wanted at; where scatter hides it, that of spheres
///   of the same packing fraction; where sizes are unknown, 2 pi (N / V)^(1/3). A group of several whose own S(q) has a
///   clear peak at a smaller wave number takes that one;
/// - D_rot and D_rot_body of c components: <|Delta Phi|^2> >= c / 3 rad^2 at the longest lag; where it is less than
///   that at the first of these lags, the logarithmic slope is at most 1.1. Single axes have c = 1.
///
/// All data decide this; errors are from blocks, which decide nothing.
///
/// Where nothing turns bodies, as with spheres, rotational diffusion and fits of C2 are meaningless, and what is left
/// of rotation alone has no error (NaN): blocks hold the same motion. The same for D_rot of all bodies where nothing
/// turns those of one group.
///
/// A decay falls to 1/e, or has no time; its fit has an amplitude of at most 1.3, tau no smaller than the first fitted
/// lag, and beta of at least 0.3, or is none. Where the correlation is above 1/4 at the longest lag, tau is also that
/// of the lags without the first third of them, to 25 %.
struct Correlations {
  Estimate D_trans;      ///< slope of the MSD / 6
  Estimate D_rot;        ///< slope of rot_msd / (2 rotation_axes): the paper's 4t for two components
  Estimate D_rot_body;   ///< slope of rot_msd_body / (2 rotation_axes)
  Estimate t_C2_1overe;  ///< where C2 falls to 1/e
  Estimate tau_C2;       ///< of A exp[-(t/tau)^beta], ballistic part excluded
  Estimate beta_C2;
  Estimate t_F_1overe;  ///< the same of F_self at the first of the wave numbers
  Estimate tau_F;
  Estimate beta_F;
  FitWindow window_D;                    ///< of D_trans, D_rot and D_rot_body
  FitWindow window_C2;                   ///< of tau_C2 and beta_C2: from five mean collision intervals on, down to 0.03
  FitWindow window_F;                    ///< of tau_F and beta_F, the same
  std::array<Estimate, 3> D_rot_axis{};  ///< slope of rot_msd_axis / 2; NaN for bodies of revolution
  std::array<Estimate, 3> t_C2_1overe_axis{};  ///< of c2_axis
  std::vector<LagRow> lags;
  std::vector<PairRow> pairs;      ///< up to half the box, at most 6 l
  std::vector<WaveRow> structure;  ///< up to 12 / l
  Estimate q_peak;                 ///< where S(q) has its first peak: the highest value between 1.5 and 7 / l
  Estimate S_peak;                 ///< and how high it is
  Estimate v2;                     ///< <v^2>: vacf at lag 0
  Estimate w2;                     ///< <omega^2>, spin excluded: wacf at lag 0
};

/// What was measured of the bodies of one group.
struct GroupResults : Correlations {
  Estimate collision_rate;  ///< collisions a body of the group takes part in, with bodies of any, a time unit
  /// On 3 (N_k - M_k / M) degrees of freedom, M_k the group's share of all mass M: what momentum zero leaves it.
  Estimate translational_kT;
  Estimate rotational_kT;
  std::array<Estimate, 3> axis_kT{};  ///< of the rotation about body x, y, z; NaN where there is none
  Estimate S;
  Director director;
};

/// What a run measured. Errors are standard errors over blocks. The correlations are averages over all bodies; where
/// some rotate about two axes and others about three, rot_msd is divided by twice their mean number.
struct Results : Correlations {
  double duration = 0;
  Estimate collision_rate;  ///< collisions a body takes part in, a time unit: 2 N_coll / (N t)
  Estimate Z;               ///< 1 + sum of r_AB.dp / (3 N kT t), kT the measured translational temperature
  Estimate translational_kT;
  Estimate rotational_kT;
  Estimate S;  ///< largest eigenvalue of Q, averaged over frames
  Director director;
  /// P V / (N kT): K + sum of r_AB dp^T / (N kT t), symmetrised, with K = 3 sum m v v^T / sum m v^2. Its trace is 3 Z.
  TensorEstimate pressure;
  std::vector<BlockRow> blocks;
  std::vector<GroupResults> groups;  ///< of one group too
};

/// Wave numbers that F_self is measured at, at most.
inline constexpr std::size_t kMostWaveNumbers = 8;

/// Where F_self is measured unless other wave numbers are asked for: at the first peak of S(q), whose decay is fitted,
/// and at a quarter, half and twice of it.
inline std::vector<double> wave_numbers_about(double first_peak) {
  return {first_peak, first_peak / 4, first_peak / 2, 2 * first_peak};
}

/// What `Observables` has to know beforehand.
struct ObservablesOptions {
  int number;              ///< of bodies
  double duration;         ///< planned; the run may be stopped earlier
  double longest_lag = 0;  ///< 0: a sixteenth of the duration, at most 40 time units
  /// Their numbers add up to `number`; empty: one group of bodies of revolution.
  std::vector<BodyGroup> groups{};
  /// Wave numbers q at which F_self is measured, at most kMostWaveNumbers; the decay of the first one is fitted.
  std::vector<double> wave_numbers{};
  double time_unit = 1;  ///< ed::time_unit of the bodies
};

/// Observables of a run, measured while it goes on, in memory that does not grow with its length.
///
/// Time origins follow each other at a sixteenth of the longest lag (more for very large systems); each is correlated
/// with the states at 20 lags a decade after it (from a thousandth of the longest on; 10 a decade below, down to
/// 0.002 time units). Origins are gathered in blocks of one longest lag; when there are more than 32 blocks, neighbours
/// are merged. Correlations says where diffusion coefficients exist.
class ED_EXPORT Observables {
 public:
  /// Of a run that is about to start, at time 0. Throws std::invalid_argument for a duration that is not positive, no
  /// bodies, or groups that are not groups of them.
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

  /// All that was measured as bytes, see Simulation::save.
  std::string save() const;
  void save(const std::function<void(std::string_view)>& sink) const;  ///< the same piece by piece

  /// The observables that were saved. Throws std::invalid_argument, `state: ..`, if the bytes are none of a run with
  /// these options.
  static Observables restore(std::string_view state, const ObservablesOptions& options);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The wave number at which S(q) of one state has its first peak: the highest value between 1.5 and 7 / l, l the radius
/// of the sphere whose volume is the bodies' mean one. Of a gas, whose S(q) has none, anywhere between.
ED_EXPORT double structure_peak(const System& system);

/// Largest eigenvalue of Q = 3/2 <u u^T> - 1/2 (averaged over bodies): the nematic order of one frame.
ED_EXPORT double nematic_order(const std::vector<Eigen::Vector3d>& axes);

/// <P2(u.u0)> between two snapshots.
ED_EXPORT double c2_between(const Snapshot& origin, const Snapshot& now);
/// <|r - r0|^2> between two snapshots.
ED_EXPORT double msd_between(const Snapshot& origin, const Snapshot& now);
/// F_self(q) between two snapshots, averaged over the directions of q: <sin(q |r - r0|) / (q |r - r0|)>.
ED_EXPORT double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number);
/// The same of bodies first, first + 1, .. alone, so many of them.
/// @{
ED_EXPORT double c2_between(const Snapshot& origin, const Snapshot& now, int first, int number);
ED_EXPORT double msd_between(const Snapshot& origin, const Snapshot& now, int first, int number);
ED_EXPORT double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number, int first, int number);
/// @}

}  // namespace ed
