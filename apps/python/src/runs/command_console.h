#pragma once

#include "base/unlocked.h"

#include <base/console.h>

#include <nanobind/nanobind.h>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Console of a command that Python has called without holding the GIL. Keeps what is printed and said, and hands it to
/// functions of Python. A function that raises stops the command.
class CommandConsole : public Console {
 public:
  /// Functions that may be None: print(text), say(line), show(text, fraction done or None); called at most every
  /// `interval`.
  CommandConsole(nb::object print, nb::object say, nb::object show, std::chrono::milliseconds interval);

  void print(std::string_view text) override;
  void say(std::string_view line) override;
  void show(std::string_view text, double done) override;
  void clear() override {}
  /// Throws what Python's signal handlers raise, KeyboardInterrupt after Ctrl-C.
  void poll() override { poll_(); }
  std::chrono::milliseconds interval() const override { return interval_; }

  const std::string& printed() const { return printed_; }
  const std::vector<std::string>& said() const { return said_; }

  /// Throws the exception that a function of Python has raised, if one has. The GIL must be held.
  void rethrow();

 private:
  template <class... Values>
  void call(const nb::object& function, Values... values);

  nb::object print_;
  nb::object say_;
  nb::object show_;
  std::chrono::milliseconds interval_;
  InterruptPoll poll_;
  std::string printed_;
  std::vector<std::string> said_;
  std::optional<nb::python_error> failure_;
};

}  // namespace hardbody::python
