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

/// Group of bodies whose observables are also computed separately: a species. The groups of a system follow each other
/// in the order of its bodies.
struct BodyGroup {
  int number;
  /// Number of components of the rotation: 2 for bodies whose shape and inertia are of revolution (symmetry_axis of
  /// their Species; spin excluded), 3 for others.
  int rotation_axes = 2;
  /// False for spheres: they have no orientation, and averages over all bodies of what depends on one are over the
  /// other groups; missing, if no group has one.
  bool oriented = true;
};

/// Time correlations at one lag. Errors are standard errors over blocks, corrected for the data that neighbouring
/// blocks share.
struct LagRow {
  double lag;
  Estimate msd;           ///< <|r(t) - r(0)|^2>
  Estimate rot_msd;       ///< <|Delta Phi|^2>, Delta Phi = integral of omega (spin excluded), world frame
  Estimate rot_msd_body;  ///< <|Delta Phi|^2> with the components of omega along the body's axes accumulated
  Estimate c1;            ///< <u(t).u(0)>, u the axis of revolution; for bodies without one: body z
  Estimate c2;            ///< <P2(u(t).u(0))>
  Estimate alpha2;        ///< 3 <|dr|^4> / (5 <|dr|^2>^2) - 1: 0 where displacements are Gaussian
  Estimate vacf;          ///< <v(t).v(0)>
  Estimate wacf;          ///< <omega(t).omega(0)>, spin excluded, world frame
  /// Values for each body axis separately, in groups with three rotation axes; NaN for others.
  /// @{
  std::array<Estimate, 3> rot_msd_axis{};  ///< contribution to rot_msd_body
  std::array<Estimate, 3> c1_axis{};       ///< c1 of this axis
  std::array<Estimate, 3> c2_axis{};       ///< c2 of this axis
  /// @}
  std::vector<Estimate> f_self{};  ///< F_self(q, t) at each of the requested wave numbers
  /// F(q, t) / S(q) at each of these wave numbers, of all bodies; empty unless ObservablesOptions::collective.
  std::vector<Estimate> f_collective{};
  Estimate overlap{};                 ///< mean of Q, the share of bodies that have moved by less than 0.3 diameters
  Estimate chi4{};                    ///< N times the variance of Q over time origins
  Estimate msd_parallel{};            ///< <(dr.n)^2>, n the director at the time origin; in a nematic state only
  Estimate msd_perp{};                ///< <|dr|^2 - (dr.n)^2>: both directions across the director together
  std::array<Estimate, 3> msd_box{};  ///< <dx^2>, <dy^2>, <dz^2> along the edges of the box
};

/// Symmetric tensor with an error for each element.
struct TensorEstimate {
  Eigen::Matrix3d value = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix3d error = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// Eigenvector of the largest eigenvalue of Q, of the average over frames. n and -n are equivalent: its largest
/// component is positive.
struct Director {
  Eigen::Vector3d axis = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool exists = false;  ///< whether the state is nematic, or a crystal of aligned bodies: see Correlations, D_parallel
  /// Standard error, an angle: sqrt(sum of sin^2 of the blocks' angles to it / (n (n - 1))). Large in an isotropic
  /// state.
  double error = std::numeric_limits<double>::quiet_NaN();
};

/// Range of lags used in a fit; NaN if there is no fit.
struct FitWindow {
  double from = std::numeric_limits<double>::quiet_NaN();
  double to = std::numeric_limits<double>::quiet_NaN();
};

/// Decay of F_self, or of F / S, at one wave number.
struct ScatteringDecay {
  double q;
  Estimate t_1overe;  ///< lag at which the function falls to 1/e
  Estimate tau;       ///< tau of A exp[-(t/tau)^beta], ballistic part excluded
  Estimate beta;
  FitWindow window;
};

/// Pair correlations of bodies whose centres are about r apart.
struct PairRow {
  double r;     ///< the middle of the bin
  Estimate g;   ///< g(r): their number over that in an ideal gas
  Estimate g2;  ///< <P2(u_i.u_j)>; NaN if there are no such pairs
};

/// S(q) averaged over wave vectors of the box of about this length.
struct WaveRow {
  double q;  ///< mean length of these wave vectors
  Estimate S;
};

/// A wave vector of the box with a large S(q).
struct BraggRow {
  Eigen::Vector3i n;   ///< wave vector in units of 2 pi / box
  double q;            ///< length of this vector
  Estimate intensity;  ///< S(q) / N: 1 for bodies on planes perpendicular to it
  double angle;        ///< angle to the director, 0 to pi/2; NaN if there is none
};

/// Self part of the van Hove function at displacements of about r, at each of its lags.
struct DisplacementRow {
  double r;                 ///< the middle of the bin
  std::vector<Estimate> G;  ///< G_s(r, t): number density of displacements, of integral 1 over space
};

/// Averages over one block of the run.
struct BlockRow {
  double begin;
  double end;
  double collision_rate;
  double Z;
  double translational_kT;
  double rotational_kT;
  double S;
  Eigen::Vector3d director;
  Eigen::Matrix3d pressure;  ///< tensor as in Results
};

/// Results from the correlations of a group of bodies, or of all.
///
/// Diffusion coefficients are slopes of displacements over [0.4, 1] of the longest lag. They exist if the motion is
/// diffusive there; otherwise Estimate::missing gives the reason. Conditions:
/// - the logarithmic slope over these lags is 1 +- 0.2;
/// - D_trans: bodies have left their cages at the first of these lags: x = MSD q^2 / 6 >= 1, and F_self(q) to the order
///   of alpha2, exp(-x) (1 + alpha2 x^2 / 2), is at most 1/e. q is the wave number of the first peak of S(q) of all
///   bodies, measured in any case, whatever wave numbers F_self is measured at. If scatter hides the peak, it is that
///   of spheres of the same packing fraction; if sizes are unknown, 2 pi (N / V)^(1/3). A group of several whose own
///   S(q) has a clear peak at a smaller wave number uses that one;
/// - D_parallel, D_perp and D_box are treated as D_trans, in c = 1, 2 and 1 directions: x = MSD q^2 / (2 c), and alpha2
///   is 0 where their displacements are Gaussian. D_parallel and D_perp also need a director, which a state has if S is
///   at least 0.3 and 4 times that of an isotropic state, 0.81 / sqrt(N). It is that of all bodies at the time origin;
/// - D_rot and D_rot_body of c components: <|Delta Phi|^2> >= c / 3 rad^2 at the longest lag; if it is less than that
///   at the first of these lags, the logarithmic slope is at most 1.1. Single axes have c = 1.
///
/// These conditions are tested on all data; the errors come from blocks, which are not tested.
///
/// If nothing changes the bodies' rotation, as for spheres, rotational diffusion and fits of C2 are meaningless, and
/// the other rotational results have no error (NaN), because all blocks contain the same motion. The same holds for
/// the results of all bodies if nothing changes the rotation of those of one group.
///
/// A decay time exists only if the correlation falls to 1/e. A fit exists only if its amplitude is at most 1.3, tau is
/// no smaller than the first fitted lag, and beta is at least 0.3. If the correlation is above 1/4 at the longest lag,
/// tau must also agree to 25 % with that of a fit without the first third of the lags.
struct Correlations {
  Estimate D_trans;      ///< slope of the MSD / 6
  Estimate D_rot;        ///< slope of rot_msd / (2 rotation_axes): the paper's 4t for two components
  Estimate D_rot_body;   ///< slope of rot_msd_body / (2 rotation_axes)
  Estimate t_C2_1overe;  ///< lag at which C2 falls to 1/e
  Estimate tau_C2;       ///< tau of A exp[-(t/tau)^beta] fitted to C2, ballistic part excluded
  Estimate beta_C2;
  Estimate t_F_1overe;  ///< lag at which F_self at the first of the wave numbers falls to 1/e; tau_F, beta_F: its fit
  Estimate tau_F;
  Estimate beta_F;
  FitWindow window_D;   ///< fit window of D_trans, D_rot and D_rot_body
  FitWindow window_C2;  ///< fit window of tau_C2 and beta_C2: from five mean collision intervals on, down to C2 = 0.03
  FitWindow window_F;   ///< fit window of tau_F and beta_F, chosen in the same way
  std::array<Estimate, 3> D_rot_axis{};        ///< slope of rot_msd_axis / 2; NaN for bodies of revolution
  std::array<Estimate, 3> t_C2_1overe_axis{};  ///< lag at which c2_axis falls to 1/e
  std::vector<LagRow> lags;
  std::vector<PairRow> pairs;      ///< g(r) up to half the box, at most 6 l
  std::vector<WaveRow> structure;  ///< S(q) up to 12 / l
  Estimate q_peak;                 ///< first peak of S(q): position of the highest value between 1.5 and 7 / l
  Estimate S_peak;                 ///< height of this peak
  std::vector<DisplacementRow> displacements;  ///< van Hove function, up to 6 l
  std::vector<double> displacement_lags;       ///< lags of these, 4 per decade: the longest, and up to 11 shorter ones
  std::vector<ScatteringDecay> decays_F;       ///< decays at all wave numbers; the first one is that of t_F_1overe
  std::vector<ScatteringDecay> decays_collective;  ///< decays of f_collective; empty like it
  /// MSD where it grows most slowly, if that is as t^(1/2) or more slowly: the square of a cage's width.
  Estimate msd_plateau;
  Estimate chi4_peak;  ///< largest chi4, and its lag
  Estimate t_chi4;
  Estimate D_parallel;              ///< slope of msd_parallel / 2
  Estimate D_perp;                  ///< slope of msd_perp / 4
  std::array<Estimate, 3> D_box{};  ///< slopes of msd_box / 2
  Estimate v2;                      ///< <v^2>: vacf at lag 0
  Estimate w2;                      ///< <omega^2>, spin excluded: wacf at lag 0
};

/// Structure of the bodies of two groups, a < b.
struct CrossStructure {
  int a;
  int b;
  /// g_ab(r): number of pairs of a body of each over that in an ideal gas; g2: <P2(u_a.u_b)> of these pairs, NaN if
  /// some have no orientation.
  std::vector<PairRow> pairs;
  /// S_ab(q) by the definition of Ashcroft and Langreth: <sum cos q.(r_i - r_j)> / sqrt(N_a N_b), i of a, j of b. S of
  /// a group alone is S_aa, and S(q) of all is the sum of sqrt(x_a x_b) S_ab over all a and b, x_a = N_a / N.
  std::vector<WaveRow> structure;
};

/// Results for the bodies of one group.
struct GroupResults : Correlations {
  bool oriented = true;  ///< BodyGroup::oriented
  /// Collisions that a body of the group takes part in, with bodies of any group, per time unit.
  Estimate collision_rate;
  /// Temperature on 3 (N_k - M_k / M) degrees of freedom, M_k the group's share of all mass M: what momentum zero
  /// leaves it.
  Estimate translational_kT;
  Estimate rotational_kT;
  std::array<Estimate, 3> axis_kT{};  ///< temperature of the rotation about body x, y, z; NaN where there is none
  Estimate S;                         ///< largest eigenvalue of Q, averaged over frames
  Director director;
  /// Cubatic order: the largest <sum over the body axes u of P4(u.n)> / (7/4) of any direction n, 1 for aligned cubes;
  /// of bodies with three axes.
  Estimate cubatic_order;
};

/// Results for all bodies, and for each group. Errors are standard errors over blocks. The correlations are averages
/// over all bodies; where some rotate about two axes and others about three, rot_msd is divided by twice their mean
/// number. The collision rate is 2 N_coll / (N t), the translational temperature is on 3 N - 3 degrees of freedom, and
/// axis_kT is that of a single group, NaN for several.
struct Results : GroupResults {
  double duration = 0;
  Estimate Z;  ///< 1 + sum of r_AB.dp / (3 N kT t), kT the measured translational temperature
  /// P V / (N kT): K + sum of r_AB dp^T / (N kT t), symmetrised, with K = 3 sum m v v^T / sum m v^2. Its trace is 3 Z.
  TensorEstimate pressure;
  /// Wave vectors of the box with the largest S(q) / N, in falling order: up to 32 of those that were strongest in the
  /// first frame, up to 8 / l.
  std::vector<BraggRow> bragg;
  Estimate bragg_peak;  ///< S(q) / N of the strongest, if it is a Bragg peak: at least 0.1 and 20 / N
  /// |<exp(i q.r)>| of the strongest Bragg peak within 15 degrees of the director: order in layers.
  Estimate smectic_order;
  Estimate columnar_order;  ///< order of those within 15 degrees of the plane across it
  Estimate q4;              ///< Steinhardt's q_4 and q_6, averaged over bodies, if BondOptions ask for them
  Estimate q6;
  /// Hexatic order |mean of psi_6| of each frame, averaged over frames, if BondOptions ask for it and the state has a
  /// director: psi_6 of a body is the mean of exp(6 i theta) over its bonds, theta their angle in the plane across the
  /// director. Bonds lead to the six nearest bodies in that plane among those within 2/3 of the bodies' mean length
  /// along the director: in layers or in neighbouring columns. Of bodies that have an orientation.
  Estimate psi6;
  Estimate psi6_local;  ///< mean of |psi_6| over bodies and frames: order that need not extend through the box
  std::vector<BlockRow> blocks;
  std::vector<GroupResults> groups;  ///< also a single group
  /// Structure of each two of 2 to kMostCrossedSpecies groups, in the order (0, 1), (0, 2), .., (1, 2), ..
  std::vector<CrossStructure> crosses;
};

/// Number of mean collision intervals (1 / collision rate) after which a run fits decays: before, motion is ballistic.
inline constexpr double kBallisticCollisions = 5;

/// Largest number of groups whose structure is measured for each two of them.
inline constexpr std::size_t kMostCrossedSpecies = 8;

/// Maximum number of wave numbers at which F_self is measured.
inline constexpr std::size_t kMostWaveNumbers = 8;

/// Returns the default wave numbers of F_self: that of the first peak of S(q), whose decay is fitted, and a quarter,
/// half and twice of it.
inline std::vector<double> wave_numbers_about(double first_peak) {
  return {first_peak, first_peak / 4, first_peak / 2, 2 * first_peak};
}

/// Order of the directions to neighbours.
struct BondOptions {
  bool steinhardt = false;  ///< q_4 and q_6 are measured
  int neighbours = 12;      ///< number of nearest neighbours of a body, for q_4 and q_6
  bool hexatic = false;     ///< psi_6 is measured
};
inline constexpr int kFewestNeighbours = 4;  ///< least BondOptions::neighbours
inline constexpr int kMostNeighbours = 50;   ///< largest BondOptions::neighbours

/// Settings of `Observables`, to be known beforehand.
struct ObservablesOptions {
  int number;              ///< number of bodies
  double duration;         ///< planned duration; the run may be stopped earlier
  double longest_lag = 0;  ///< longest lag, at most the duration; 0: duration / 16
  /// Groups of bodies, whose numbers add up to `number`; empty: one group of bodies of revolution.
  std::vector<BodyGroup> groups{};
  /// Wave numbers q at which F_self is measured, at most kMostWaveNumbers; the decay of the first one is fitted.
  std::vector<double> wave_numbers{};
  double time_unit = 1;  ///< ed::time_unit of the bodies
  /// True to measure F(q, t) / S(q) of all bodies, too, at these wave numbers: q means up to 48 wave vectors of the box
  /// whose length differs from it by at most pi / box.
  bool collective = false;
  BondOptions bonds{};
};

/// Observables of a run, measured while it proceeds, in memory that does not grow with its length.
///
/// Time origins are a time unit apart, but at least 4 and at most 16 in a longest lag (fewer for more than 10 000
/// bodies). Each is correlated with the states at 20 lags a decade after it (from a thousandth of the longest lag on;
/// 10 a decade below, down to 0.002 time units). Origins are gathered in blocks of one longest lag; when there are more
/// than 32 blocks, neighbours are merged. Correlations states when diffusion coefficients exist.
class ED_EXPORT Observables {
 public:
  /// Constructs the observables of a run that is about to start, at time 0. Throws std::invalid_argument for a duration
  /// that is not positive, a longest lag beyond it, no bodies, or groups that are not groups of them.
  explicit Observables(const ObservablesOptions& options);
  ~Observables();
  Observables(Observables&&) noexcept;             ///< moved-from objects can only be assigned to or destroyed
  Observables& operator=(Observables&&) noexcept;  ///< moved-from objects can only be assigned to or destroyed

  /// Returns the next time (since the start) at which a measurement is due; infinite when the planned duration is
  /// covered.
  double next_time() const;

  /// Takes the measurements that are due. `simulation`, started at time 0 together with this object, must first have
  /// been run to next_time().
  void measure(const Simulation& simulation);

  /// Changes the planned duration, to one beyond the last measurement. Measuring then continues, bit for bit as if the
  /// run had been planned with this duration and with the longest lag that it has, at its end too: a sample that the
  /// old duration has rounded to its end is taken again at its own time. The longest lag stays; `restore` wants it in
  /// its options (where it was 0, a sixteenth of the first duration). Throws std::invalid_argument for a duration that
  /// has been measured already, is shorter than the longest lag, or is not finite.
  void extend(double duration);

  /// Returns all results so far; the totals are taken from `simulation`.
  Results results(const Simulation& simulation) const;

  /// Returns all that was measured as bytes, see Simulation::save.
  std::string save() const;
  /// Overload that hands the bytes on piece by piece.
  void save(const std::function<void(std::string_view)>& sink) const;

  /// Restores saved observables. Throws std::invalid_argument, `state: ..`, if the bytes are not those of a run with
  /// these options.
  static Observables restore(std::string_view state, const ObservablesOptions& options);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the wave number of the first peak of S(q) of one state: the highest value between 1.5 and 7 / l, l the
/// radius of the sphere whose volume is the bodies' mean one. The value is arbitrary within this range for a gas, whose
/// S(q) has no peak.
ED_EXPORT double structure_peak(const System& system);

/// Returns the nematic order of one frame: the largest eigenvalue of Q = 3/2 <u u^T> - 1/2, averaged over bodies.
ED_EXPORT double nematic_order(const std::vector<Eigen::Vector3d>& axes);

/// Returns <P2(u.u0)> between two snapshots.
ED_EXPORT double c2_between(const Snapshot& origin, const Snapshot& now);
/// Returns <|r - r0|^2> between two snapshots.
ED_EXPORT double msd_between(const Snapshot& origin, const Snapshot& now);
/// Returns F_self(q) between two snapshots, averaged over the directions of q: <sin(q |r - r0|) / (q |r - r0|)>.
ED_EXPORT double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number);
/// Overload for `number` bodies from body `first` on.
/// @{
ED_EXPORT double c2_between(const Snapshot& origin, const Snapshot& now, int first, int number);
ED_EXPORT double msd_between(const Snapshot& origin, const Snapshot& now, int first, int number);
ED_EXPORT double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number, int first, int number);
/// @}

}  // namespace ed
