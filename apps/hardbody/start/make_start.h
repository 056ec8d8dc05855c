#pragma once

#include "base/log.h"
#include "base/progress.h"
#include "config/config.h"
#include "start/from_file.h"

#include <ed/simulation.h>
#include <ed/system.h>

#include <optional>
#include <vector>

namespace hardbody {

/// Initial state, the counters of its compression, and the pairs that failed in it.
struct Start {
  ed::System system;
  ed::Counters counters;
  std::vector<ed::FailedPair> failures;
  double packing_of_file = 0;  ///< packing fraction of the state in the config's file; 0: there is none
};

/// States that a run begins with, as far as they have been loaded.
struct LoadedStates {
  std::optional<ed::System> origin;  ///< last state of the run that the config starts from
  std::optional<FileStart> file;
};

/// Makes the initial state of a run: bodies from a file, the last state of another run, a random dilute state, or a
/// lattice; the second and third are compressed, and the first if the config is denser. The state of an origin has to
/// be loaded. Returns nullopt if a signal came first. Throws InputError if there is no such state, and
/// std::runtime_error if the compression gets stuck.
std::optional<Start> make_start(const Config& config, LoadedStates loaded, Progress& progress, Log& log);

}  // namespace hardbody
