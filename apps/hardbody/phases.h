#pragma once

#include "config.h"
#include "log.h"
#include "progress.h"
#include "run_record.h"
#include "saver.h"

#include <ed/system.h>

#include <optional>

namespace hardbody {

/// The three phases of a run. Each returns early when a signal has come. What they do to the state depends on
/// the config alone, never on a clock or on how often they look up.

/// Random dilute state, compressed; nothing if a signal came first.
std::optional<ed::System> make_start(const Config& config, Progress& progress, Log& log);

Equilibration equilibrate(const Config& config, const ed::System& start, Progress& progress, Saver& saver, Log& log);

Production produce(const Config& config, const Equilibration& equilibration, Progress& progress, Saver& saver,
                   Log& log);

}  // namespace hardbody
