#pragma once

#include "base/errors.h"
#include "config/config.h"
#include "run/checkpoint.h"

#include <ed/simulation.h>

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace hardbody {

/// Returns what `restore` gives. Throws InputError, naming the checkpoint, if it does not fit.
template <class F>
auto restored(const std::string& name, const F& restore) {
  try {
    return restore();
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: holds an impossible state ({}); accepted: an undamaged checkpoint", name, error.what()));
  }
}

/// Returns the simulation of a checkpoint, whose bytes are let go.
ed::Simulation restored_simulation(const Config& config, Checkpoint& checkpoint, const std::string& name);

}  // namespace hardbody
