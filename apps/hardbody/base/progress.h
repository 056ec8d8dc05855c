#pragma once

#include "base/log.h"

#include <chrono>
#include <string>

namespace hardbody {

/// Progress of a run on stderr: one line that is rewritten on a terminal, else a line every ten seconds.
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
  void show(const std::string& text);

  /// Prints a line that is not overwritten.
  void say(const std::string& text);

  /// Clears the line that is being rewritten.
  void clear();

  /// Returns the seconds since the phase began.
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point begun_;
  Clock::time_point last_;
};

/// Logs a line and prints it.
void announce(const std::string& text, Progress& progress, Log& log);

/// Returns the remaining time as text, "ETA 1.5 h", "ETA 42 s"; empty if nothing is done yet.
std::string eta(double seconds, double done, double total);

}  // namespace hardbody
