#pragma once

#include "config.h"
#include "log.h"
#include "progress.h"
#include "run_directory.h"

#include <ed/system.h>

#include <chrono>

namespace hardbody {

/// Writes checkpoint.bin: at the end of a run, and every [output] checkpoint_every while it goes on. Writing changes
/// nothing in the run.
class Saver {
 public:
  Saver(const RunDirectory& directory, const Config& config, Progress& progress, Log& log);

  /// The phase whose states follow: "equilibration" or "production".
  void begin(const char* phase) { phase_ = phase; }

  bool due() const;

  /// The state at `time` since the phase began. A file that cannot be written is logged and does not end the run.
  void save(const ed::System& system, double time);

  /// The same for the end of a run; throws if the file cannot be written.
  void write(const ed::System& system, double time) const;

 private:
  using Clock = std::chrono::steady_clock;
  const RunDirectory& directory_;
  const Config& config_;
  Progress& progress_;
  Log& log_;
  const char* phase_ = "start";
  Clock::time_point last_;
};

}  // namespace hardbody
