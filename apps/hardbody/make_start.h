#pragma once

#include "config.h"
#include "log.h"
#include "progress.h"

#include <ed/simulation.h>
#include <ed/system.h>

#include <optional>

namespace hardbody {

/// The state, and what its compression has counted.
struct Start {
  ed::System system;
  ed::Counters counters;
};

/// What a run begins with: bodies from a file, the last state of another run, a random dilute state, or a lattice; the
/// second and third are compressed. Nothing if a signal came first. Throws InputError if there is no such state, and
/// std::runtime_error if the compression gets stuck.
std::optional<Start> make_start(const Config& config, Progress& progress, Log& log);

}  // namespace hardbody
