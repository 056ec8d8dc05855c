#include "runs/command_console.h"

#include "base/gil.h"
#include "runs/words.h"

#include <base/signals.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <utility>

namespace hardbody::python {

CommandConsole::CommandConsole(nb::object print, nb::object say, nb::object show, std::chrono::milliseconds interval)
    : print_(std::move(print)), say_(std::move(say)), show_(std::move(show)), interval_(interval) {}

template <class... Values>
void CommandConsole::call(const nb::object& function, Values... values) {
  if (function.is_none() || failure_) return;
  const GilAcquired gil;
  try {
    function(std::move(values)...);
  } catch (nb::python_error& error) {
    failure_.emplace(std::move(error));
    request_stop();
  }
}

void CommandConsole::print(std::string_view text) {
  const std::string words = in_python(std::string(text));
  printed_ += words;
  call(print_, words);
}

void CommandConsole::say(std::string_view line) {
  said_.push_back(in_python(std::string(line)));
  call(say_, said_.back());
}

void CommandConsole::show(std::string_view text, double done) {
  call(show_, std::string(text), std::isnan(done) ? std::nullopt : std::optional<double>(done));
}

void CommandConsole::rethrow() {
  if (!failure_) return;
  nb::python_error error = std::move(*failure_);
  failure_.reset();
  throw error;  // NOLINT(cert-err60-cpp): it has a move constructor
}

}  // namespace hardbody::python
