#pragma once

/// Start and equilibration of a run: what each begins with, how it goes on, and what a checkpoint holds of it.
///
/// Rules of all phases, production included: each ends early when a signal has come or the simulation has stalled. What
/// they do to the state depends on the config alone, never on a clock, on how often they look up or on whether they
/// were resumed.

#include "base/log.h"
#include "base/progress.h"
#include "config/config.h"
#include "run/checkpoint.h"
#include "run/record.h"
#include "run/saver.h"
#include "start/make_start.h"

#include <ed/equilibration.h>
#include <ed/simulation.h>

#include <optional>
#include <string>

namespace hardbody {

/// Returns the checkpoint of the start by itself.
Checkpoint checkpoint_of(const Start& start);

/// An equilibration that is under way.
struct EquilibrationRun {
  ed::Simulation simulation;
  ed::EquilibrationMonitor monitor;
  Equilibration result;  ///< result as of the last full unit of time
};

/// Chooses the thickness of the envelopes first; nullopt if a signal came before it was chosen.
std::optional<EquilibrationRun> begin_equilibration(const Config& config, const Start& start, Progress& progress,
                                                    Saver& saver, Log& log);
/// Throws InputError if the state does not fit. Changes nothing on the disk; the checkpoint's bytes are let go as soon
/// as they are read.
EquilibrationRun resumed_equilibration(const Config& config, Checkpoint& checkpoint, const std::string& name);
Checkpoint checkpoint_of(const EquilibrationRun& run);
Equilibration equilibrate(const Config& config, EquilibrationRun& run, Progress& progress, Saver& saver, Log& log);

}  // namespace hardbody
