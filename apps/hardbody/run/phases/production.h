#pragma once

/// The production of a run: what it begins with, how it goes on, and what a checkpoint holds of it; see
/// equilibration.h.

#include "base/log.h"
#include "base/progress.h"
#include "config/config.h"
#include "run/checkpoint.h"
#include "run/files/events_file.h"
#include "run/record.h"
#include "run/saver.h"
#include "run/trajectory_recorder.h"

#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <optional>
#include <string>

namespace hardbody {

/// A production that is under way.
struct ProductionRun {
  ed::Simulation simulation;
  ed::Observables observables;
  EventsFile events;
  Trajectory trajectory;
  Equilibration before;  ///< equilibration before; once production is under way, without its system
  Production result;
  std::optional<ed::System> begin{};  ///< state of the first frame of trajectories, until it is taken
};

/// Length of a production, and the longest lag of what is measured in it.
struct ProductionTimes {
  double length;  ///< time of the first test of a target error, if there is one
  double longest_lag;
};

/// Returns the times of a production after an equilibration with a number of collisions (0: not known).
ProductionTimes production_times(const Config& config, double equilibration_time, double collisions);

/// Continues from the equilibration's system, which it takes.
ProductionRun begin_production(const Config& config, Equilibration equilibration, const RunDirectory& directory,
                               Log& log);
/// Resumes a production, with the contract of resumed_equilibration().
ProductionRun resumed_production(const Config& config, Checkpoint& checkpoint, const RunDirectory& directory,
                                 const std::string& name);

/// Returns the plan of a production that goes on to the time that `longer` names, as a new run would have it.
Production extended_production(const Config& longer, const Production& production);
/// Returns the stored observables of `state` for a longer production. Throws std::invalid_argument if they do not fit.
std::string extended_observables(const Config& config, const Config& longer, const RunState& state);

/// Appends the collisions so far to events.csv and what is waiting to the trajectories, which throws if they cannot be
/// written.
Checkpoint checkpoint_of(ProductionRun& run);
void produce(const Config& config, ProductionRun& run, const FilesMark& files, Progress& progress, Saver& saver,
             Log& log);

}  // namespace hardbody
