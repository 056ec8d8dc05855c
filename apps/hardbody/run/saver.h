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

  /// What is made of the run where it stands. If that or writing fails it is logged and counted, and the run goes on.
  void save(const std::function<Checkpoint()>& make);

  /// The same for the end of a run; throws if it fails.
  void write(Checkpoint checkpoint);

  /// Up to now, but for production's seconds.
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
