#pragma once

#include <ed/export.h>
#include <ed/simulation.h>

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ed {

/// Bodies that have to forget where they were by themselves: a species. Groups stand one after the other.
struct RelaxingGroup {
  int number;
  bool turns = true;  ///< false: spheres, which turn freely for ever; their orientations do not count
};

/// How far an equilibration has come. Values that are not known yet are NaN.
struct Relaxation {
  double q = std::numeric_limits<double>::quiet_NaN();  ///< first peak of S(q), latest; see below
  // Of the slowest group, between the current relaxation's begin and now, or of the last one, when it was over.
  double c2 = 1;      ///< <P2(u(t).u(0))>; NaN where no body turns
  double f_self = 1;  ///< F_self(q, t), at the q that the relaxation began with
  int relaxations = 0;
  double relaxation_time = std::numeric_limits<double>::quiet_NaN();  ///< of the last one
  // From the relaxation before to the last one, of the means over each.
  double Z_change = std::numeric_limits<double>::quiet_NaN();  ///< relative to Z
  double S_change = std::numeric_limits<double>::quiet_NaN();
  bool reached = false;
};

/// Decides when a run is equilibrated: when C2 and F_self at the first peak of S(q) have decayed below 0.05 twice in a
/// row, from one origin and then from another one, and Z and S do not drift: their means over the two relaxations
/// differ by no more than 1 % of Z and 0.05, or three standard errors. As long as they do, relaxations follow.
///
/// It looks at the run once in an ed::time_unit; a relaxation lasts at least four of them, for the means. The peak is
/// that of S(q) averaged over all looks of the current relaxation and of the one before; where it does not stand out of
/// these few, that of spheres' S(q) fitted to it (docs/output.md).
class ED_EXPORT EquilibrationMonitor {
 public:
  /// Begins now. Throws std::invalid_argument unless the groups are groups of all bodies.
  EquilibrationMonitor(const Simulation& simulation, const std::vector<RelaxingGroup>& groups);
  ~EquilibrationMonitor();
  EquilibrationMonitor(EquilibrationMonitor&&) noexcept;  ///< the one moved from can only be assigned to or destroyed
  EquilibrationMonitor& operator=(EquilibrationMonitor&&) noexcept;  ///< the same

  /// Looks at the run, a time_unit of its bodies after it looked last.
  void measure(const Simulation& simulation);

  /// As of the last look.
  const Relaxation& state() const;

  /// All that it knows as bytes, see Simulation::save.
  std::string save() const;
  /// Throws std::invalid_argument, `state: ..`, if the bytes are none of these groups.
  static EquilibrationMonitor restore(std::string_view state, const std::vector<RelaxingGroup>& groups);

 private:
  class Impl;
  explicit EquilibrationMonitor(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed
