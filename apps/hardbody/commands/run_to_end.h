#pragma once

/// Part that run, resume and extend share: a run from the state where it stands to its end.

#include "base/log.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/phases/equilibration.h"
#include "run/phases/production.h"
#include "run/record.h"
#include "start/make_start.h"

#include <ed/system.h>

#include <optional>
#include <string>

namespace hardbody {

/// State at which a run begins, or is continued.
struct Continuation {
  LoadedStates loaded;
  std::optional<Start> start;
  std::optional<EquilibrationRun> equilibration;
  std::optional<ProductionRun> production;
  FilesMark files;
  Upkeep upkeep;
};

/// Returns the last state of the run that the config starts from. Throws InputError if there is none, or it is not one
/// of the config's bodies at its packing fraction or below.
ed::System read_origin_state(const Config& config);

/// Makes the state to continue from. All errors are detected here, before anything is changed. Throws InputError.
Continuation continuation(const Config& config, Checkpoint checkpoint, const RunDirectory& directory,
                          const std::string& name);

/// Runs all that is left and writes the results. Returns the exit status of the program.
int run_to_end(const Config& config, const RunDirectory& directory, Continuation at, Log& log);

}  // namespace hardbody
