#pragma once

#include <chrono>
#include <string>

namespace hardbody {

/// What a run shows on stderr while it goes on: one line that is rewritten on a terminal, else a line every
/// ten seconds.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A new phase: its clock starts.
  void begin();

  /// Whether it is time to show something; ask before composing the text.
  bool due() const;
  void show(const std::string& text);

  /// A line that stays.
  void say(const std::string& text);

  /// Clears the line that is being rewritten.
  void clear();

  /// Since the phase began.
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point begun_;
  Clock::time_point last_;
};

/// "ETA 1.5 h", "ETA 42 s"; empty if nothing is done yet.
std::string eta(double seconds, double done, double total);

}  // namespace hardbody
