#pragma once

#include <chrono>
#include <string_view>

namespace hardbody {

/// Place that the commands of a thread print to.
class Console {
 public:
  virtual ~Console() = default;

  /// Prints results: whole lines, each with its line break.
  virtual void print(std::string_view text) = 0;

  /// Prints a message about the work, one line.
  virtual void say(std::string_view line) = 0;

  /// Shows how far the work is, instead of what was shown before. `done` is the fraction done, NaN if it is not known.
  virtual void show(std::string_view text, double done) = 0;

  /// Removes what show() has left.
  virtual void clear() = 0;

  /// Called often by commands that have no progress to show and have not begun to write: may throw, which ends them.
  virtual void poll() {}

  /// Returns the time between two calls of show().
  virtual std::chrono::milliseconds interval() const = 0;
};

/// Returns the console of this thread. By default it is the process's own: results go to stdout, messages to stderr;
/// what show() is given is one line that is rewritten on a terminal, else a line every ten seconds.
Console& console();

/// Replaces the console of this thread during the object's lifetime.
class ConsoleScope {
 public:
  explicit ConsoleScope(Console& console);
  ~ConsoleScope();
  ConsoleScope(const ConsoleScope&) = delete;
  ConsoleScope& operator=(const ConsoleScope&) = delete;

 private:
  Console* before_;
};

}  // namespace hardbody
