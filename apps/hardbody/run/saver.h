#pragma once

#include "base/log.h"
#include "base/progress.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/record.h"

#include <chrono>
#include <functional>

namespace hardbody {

/// Writes checkpoint.bin: at the end of a run, and every [output] checkpoint_every while it goes on. Writing changes
/// nothing in the run, and the last good file stays until the next one is complete.
class Saver {
 public:
  /// `earlier`: of the processes that have worked at the run before.
  Saver(const RunDirectory& directory, const Config& config, Upkeep earlier, Progress& progress, Log& log);

  bool due() const;

  /// Saves a checkpoint of the current state, which `make` makes. A failure of that or of writing is logged and
  /// counted, and the run continues.
  void save(const std::function<Checkpoint()>& make);

  /// Writes the checkpoint at the end of a run; throws if that fails.
  void write(Checkpoint checkpoint);

  /// Returns the statistics up to now, without production's seconds.
  Upkeep upkeep() const;

 private:
  /// Never the wall clock, which may be set back.
  using Clock = std::chrono::steady_clock;
  static_assert(Clock::is_steady);

  const RunDirectory& directory_;
  const Config& config_;
  Upkeep upkeep_;  ///< seconds: without those of this process
  Progress& progress_;
  Log& log_;
  Clock::time_point last_;
};

}  // namespace hardbody
