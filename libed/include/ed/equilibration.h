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
};

/// Decides when a run is equilibrated. C2 and F_self at the first peak of S(q) must have decayed below 0.05 twice in a
/// row, from one origin and then from another one, and Z and S must not drift: their means over the two relaxations
/// differ by no more than 1 % of Z and 0.05 in S, or three standard errors. While they drift, further relaxations
/// follow.
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
