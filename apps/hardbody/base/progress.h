#pragma once

#include "base/log.h"

#include <chrono>
#include <limits>
#include <string>

namespace hardbody {

/// Progress of a command, shown on the console of this thread from time to time.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Begins a new phase and starts its clock.
  void begin();

  /// Returns whether an update is due; to be called before the text is composed.
  bool due() const;

  /// Shows how far the phase is; `done` is the fraction done, NaN if it is not known.
  void show(const std::string& text, double done = std::numeric_limits<double>::quiet_NaN());

  /// Prints a line that is not overwritten.
  void say(const std::string& text);

  /// Clears the line that is being rewritten.
  void clear();

  /// Returns the seconds since the phase began.
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begun_;
  Clock::time_point last_;
};

/// Logs a line and prints it.
void announce(const std::string& text, Progress& progress, Log& log);

/// Returns the remaining time as text, "ETA 1.5 h", "ETA 42 s"; empty if nothing is done yet.
std::string eta(double seconds, double done, double total);

}  // namespace hardbody
