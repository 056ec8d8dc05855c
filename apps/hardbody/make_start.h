#pragma once

#include "config.h"
#include "log.h"
#include "progress.h"

#include <ed/system.h>

#include <optional>

namespace hardbody {

/// What a run begins with: bodies from a file, the last state of another run, a random dilute state, or a lattice; the
/// second and third are compressed. Nothing if a signal came first. Throws InputError if there is no such state, and
/// std::runtime_error if the compression gets stuck.
std::optional<ed::System> make_start(const Config& config, Progress& progress, Log& log);

}  // namespace hardbody
