#pragma once

#include <ed/export.h>
#include <ed/simulation.h>

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ed {

/// Group of bodies that must relax by itself: a species. The bodies of a group are consecutive.
struct RelaxingGroup {
  int number;
  bool turns = true;  ///< false: spheres, whose rotation never changes; their orientations are ignored
};

/// Criterion by which a run is equilibrated: C2 and F_self have decayed, or order and pressure of a nematic or a
/// crystal are stationary.
enum class EquilibratedBy { nothing, decay, stationarity };

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(EquilibratedBy by);

/// Order of a state over the last two thirds of the equilibration, as of the last time it was judged. Changes are those
/// from the first half of that time to the second one. Values that are not known yet are NaN.
struct Order {
  double S = std::numeric_limits<double>::quiet_NaN();          ///< nematic order of bodies that turn, mean over frames
  double S_octants = std::numeric_limits<double>::quiet_NaN();  ///< mean S of the eight octants of the box
  /// Largest S(q) / N of wave vectors of the box.
  double bragg = std::numeric_limits<double>::quiet_NaN();
  double Z_change = std::numeric_limits<double>::quiet_NaN();  ///< change of Z relative to Z
  double S_change = std::numeric_limits<double>::quiet_NaN();
  double bragg_change = std::numeric_limits<double>::quiet_NaN();
  bool nematic = false;     ///< S is at least 0.3, and 4 times that of an isotropic state
  bool crystal = false;     ///< S(q) / N is at least 0.2: positions are ordered, as in crystals and layers
  bool uniform = false;     ///< the octants' order exceeds S by no more than 0.1 + 8 / N: there are no domains
  bool stationary = false;  ///< the criterion holds
};

/// Progress of an equilibration. Values that are not known yet are NaN.
struct Relaxation {
  double q = std::numeric_limits<double>::quiet_NaN();  ///< latest first peak of S(q); see below
  // Values of the slowest group, between the begin of the current relaxation and now, or at the end of the last one.
  double c2 = 1;      ///< <P2(u(t).u(0))>; NaN if no body rotates
  double f_self = 1;  ///< F_self(q, t), at the q of the relaxation's begin
  int relaxations = 0;
  double relaxation_time = std::numeric_limits<double>::quiet_NaN();  ///< duration of the last relaxation
  // Changes from the previous relaxation to the last one, of the means over each.
  double Z_change = std::numeric_limits<double>::quiet_NaN();  ///< change of Z relative to Z
  double S_change = std::numeric_limits<double>::quiet_NaN();
  bool reached = false;
  EquilibratedBy by = EquilibratedBy::nothing;  ///< criterion that was met first
  Order order{};
};

/// Decides when a run is equilibrated. C2 and F_self at the first peak of S(q) must have decayed below 0.05 twice in a
/// row, from one origin and then from another one, and Z and S must not drift: their means over the two relaxations
/// differ by no more than 1 % of Z and 0.05 in S, or three standard errors. While they drift, further relaxations
/// follow.
///
/// C2 of a nematic and F_self of a crystal do not decay. Such a state, with a large S or a Bragg peak (Order), is
/// equilibrated if it is stationary. From 48 samples on, the last two thirds of them are judged at each eighth: the
/// means of their halves differ by no more than 1 % of Z, 0.05 in S, and 0.05 in S(q) / N of a crystal, or two standard
/// errors (of four or eight stretches of the samples, so that correlations count), and these errors are no larger than
/// those limits. A nematic must be uniform, and without a Bragg peak its F_self must have decayed, for as long again as
/// that took.
///
/// The run is sampled once in an ed::time_unit; a relaxation lasts at least four of them, for the means. The peak is
/// that of S(q) averaged over all samples of the current relaxation and of the previous one. If it is not significant
/// in these few samples, the peak of spheres' S(q) fitted to it is used (docs/output.md).
class ED_EXPORT EquilibrationMonitor {
 public:
  /// Begins the first relaxation now. Throws std::invalid_argument unless the groups together are all bodies.
  EquilibrationMonitor(const Simulation& simulation, const std::vector<RelaxingGroup>& groups);
  ~EquilibrationMonitor();
  EquilibrationMonitor(EquilibrationMonitor&&) noexcept;  ///< moved-from objects can only be assigned to or destroyed
  /// Moved-from objects can only be assigned to or destroyed.
  EquilibrationMonitor& operator=(EquilibrationMonitor&&) noexcept;

  /// Samples the run; to be called one time_unit of its bodies after the last sample.
  void measure(const Simulation& simulation);

  /// Returns the progress as of the last sample.
  const Relaxation& state() const;

  /// Returns the whole state as bytes, see Simulation::save.
  std::string save() const;
  /// Restores a saved monitor. Throws std::invalid_argument, `state: ..`, if the bytes are not a state of these groups.
  static EquilibrationMonitor restore(std::string_view state, const std::vector<RelaxingGroup>& groups);

 private:
  class Impl;
  explicit EquilibrationMonitor(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed
