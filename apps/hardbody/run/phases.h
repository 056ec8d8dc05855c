#pragma once

#include "base/log.h"
#include "base/progress.h"
#include "config/config.h"
#include "run/checkpoint.h"
#include "run/files/events_file.h"
#include "run/record.h"
#include "run/saver.h"
#include "run/trajectory_recorder.h"
#include "start/make_start.h"

#include <ed/equilibration.h>
#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <optional>

namespace hardbody {

/// The three phases of a run: what each begins with, how it goes on, and what a checkpoint holds of it. Each ends early
/// when a signal has come or the simulation has stalled. What they do to the state depends on the config alone, never
/// on a clock, on how often they look up or on whether they were resumed.

/// The start by itself.
Checkpoint checkpoint_of(const Start& start);

/// Equilibration on its way.
struct EquilibrationRun {
  ed::Simulation simulation;
  ed::EquilibrationMonitor monitor;
  Equilibration result;  ///< as of the last full unit of time
};

/// Chooses the thickness of the envelopes first; nothing if a signal came before it was chosen.
std::optional<EquilibrationRun> begin_equilibration(const Config& config, const Start& start, Progress& progress,
                                                    Saver& saver, Log& log);
/// Throws InputError if the state does not fit. Changes nothing on the disk; the checkpoint's bytes are let go as soon
/// as they are read.
EquilibrationRun resumed_equilibration(const Config& config, Checkpoint& checkpoint, const std::string& name);
Checkpoint checkpoint_of(const EquilibrationRun& run);
Equilibration equilibrate(const Config& config, EquilibrationRun& run, Progress& progress, Saver& saver, Log& log);

/// Production on its way.
struct ProductionRun {
  ed::Simulation simulation;
  ed::Observables observables;
  EventsFile events;
  Trajectory trajectory;
  Equilibration before;  ///< once production is under way, without its system
  Production result;
  std::optional<ed::System> begin{};  ///< for the first frame of trajectories, until it is taken
};

/// Goes on from the equilibration's system, which it takes.
ProductionRun begin_production(const Config& config, Equilibration equilibration, const RunDirectory& directory,
                               Log& log);
/// As resumed_equilibration.
ProductionRun resumed_production(const Config& config, Checkpoint& checkpoint, const RunDirectory& directory,
                                 const std::string& name);
/// Whether a longer production would have no longer lags.
bool lags_are_longest(const Config& config, const Production& production);

/// How far the files go that grow with production.
struct FilesMark {
  EventsMark events;
  TrajectoryMark trajectory;
};

/// Appends the collisions so far to events.csv and what is waiting to the trajectories, which throws if they cannot be
/// written.
Checkpoint checkpoint_of(ProductionRun& run);
void produce(const Config& config, ProductionRun& run, const FilesMark& files, Progress& progress, Saver& saver,
             Log& log);

}  // namespace hardbody
