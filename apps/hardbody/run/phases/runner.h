#pragma once

#include "base/progress.h"
#include "run/checkpoint.h"
#include "run/saver.h"

#include <ed/simulation.h>

#include <cstdint>
#include <functional>
#include <string>

namespace hardbody {

/// Advances a simulation in slices, shows how far its phase is, and saves it.
class Runner {
 public:
  Runner(ed::Simulation& simulation, std::string phase, Progress& progress, Saver& saver,
         std::function<Checkpoint()> checkpoint, std::function<void()> keep_up = {});

  /// Runs to `time`; false if a signal came first, or the simulation has stalled.
  bool run_to(double time, double planned_end);

 private:
  bool run_slice(double time);
  std::string text(double planned_end) const;

  ed::Simulation& simulation_;
  Progress& progress_;
  Saver& saver_;
  std::function<Checkpoint()> checkpoint_;
  std::function<void()> keep_up_;  ///< called after each slice
  std::string phase_;
  double begin_;  ///< time at which this process began
  double slice_;  ///< collisions in the next slice
  std::uint64_t collisions_;
  double energy_;
};

}  // namespace hardbody
