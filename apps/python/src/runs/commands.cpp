#include <base/errors.h>
#include <base/signals.h>
#include <commands/commands.h>
#include <commands/sweep_tasks.h>
#include <io/text_file.h>
#include "base/gil.h"
#include "runs/bind.h"
#include "runs/command_console.h"
#include "runs/words.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

using Strings = std::vector<std::string>;
using Outcome = std::tuple<int, std::string, Strings>;
using Functions = nb::typed<nb::tuple, nb::object, nb::object, nb::object, double>;

/// Functions of Python that a command prints with, see CommandConsole.
struct Printers {
  nb::object print;
  nb::object say;
  nb::object show;
  double interval;  ///< seconds between two calls of `show`
};

Printers printers(const Functions& given) {
  return {given[0], given[1], given[2], nb::cast<double>(given[3])};
}

/// Runs a command without the GIL, with its own handlers of signals and the console of this call.
int status_of(CommandConsole& console, const std::function<int()>& command) {
  const GilReleased released;
  const SignalScope signals;
  const ConsoleScope scope(console);
  const StopScope requests;
  try {
    return command();
  } catch (const InputError& error) {
    throw std::invalid_argument(in_python(one_line(error.what(), 2000)));
  }
}

/// Throws what Python's handlers raise for signals that have arrived. KeyboardInterrupt is left to the caller if the
/// command was stopped by Ctrl-C, because it knows where.
void look_after_signals(int status) {
  if (PyErr_CheckSignals() == 0) return;
  if (status == exit_status_of(SIGINT) && PyErr_ExceptionMatches(PyExc_KeyboardInterrupt) != 0) {
    PyErr_Clear();
    return;
  }
  throw nb::python_error();
}

Outcome outcome(const Functions& functions, const std::function<int()>& command) {
  const Printers to = printers(functions);
  const auto interval = std::chrono::milliseconds(static_cast<long long>(1000 * to.interval));
  CommandConsole console(to.print, to.say, to.show, interval);
  int status = 0;
  try {
    status = status_of(console, command);
  } catch (...) {
    console.rethrow();
    throw;
  }
  console.rethrow();
  look_after_signals(status);
  return {status, console.printed(), console.said()};
}

}  // namespace

void bind_commands(nb::module_& module) {
  const auto text_or_none = nb::arg("text").none();
  const auto out_or_none = nb::arg("out").none();
  module.def(
      "run",
      [](const Functions& console, std::string config, std::optional<std::string> text, std::optional<std::string> out,
         Strings overrides, bool force, int replicas, Strings program) {
        const RunArguments arguments{std::move(config), std::move(text),   std::move(out), std::move(overrides), force,
                                     replicas,          std::move(program)};
        return outcome(console, [&] { return run(arguments); });
      },
      nb::arg("console"), nb::arg("config"), text_or_none, out_or_none, nb::arg("overrides"), nb::arg("force"),
      nb::arg("replicas"), nb::arg("program"), "Command run. Returns exit status, what was printed, and messages.");
  module.def(
      "resume",
      [](const Functions& console, std::string path, Strings overrides) {
        const ResumeArguments arguments{std::move(path), std::move(overrides)};
        return outcome(console, [&] { return resume(arguments); });
      },
      nb::arg("console"), nb::arg("path"), nb::arg("overrides"), "Command resume.");
  module.def(
      "extend",
      [](const Functions& console, std::string path, double time) {
        const ExtendArguments arguments{std::move(path), time};
        return outcome(console, [&] { return extend(arguments); });
      },
      nb::arg("console"), nb::arg("path"), nb::arg("time"), "Command extend.");
  module.def(
      "sweep",
      [](const Functions& console, std::string config, std::optional<std::string> text, std::optional<std::string> out,
         std::optional<int> jobs, Strings overrides, Strings program) {
        SweepArguments arguments;
        arguments.sweep = std::move(config);
        arguments.text = std::move(text);
        arguments.out = std::move(out);
        arguments.jobs = jobs;
        arguments.overrides = std::move(overrides);
        arguments.program = std::move(program);
        return outcome(console, [&] { return sweep(arguments); });
      },
      nb::arg("console"), nb::arg("config"), text_or_none, out_or_none, nb::arg("jobs").none(), nb::arg("overrides"),
      nb::arg("program"), "Command sweep.");
  module.def(
      "sweep_plan",
      [](const Functions& console, std::string config, std::optional<std::string> text, std::optional<std::string> out,
         Strings overrides, double task_time, std::optional<int> jobs) {
        SweepTaskArguments arguments;
        arguments.sweep = std::move(config);
        arguments.text = std::move(text);
        arguments.out = std::move(out);
        arguments.overrides = std::move(overrides);
        arguments.task_time = task_time;
        arguments.jobs = jobs;
        return outcome(console, [&] { return sweep_plan(arguments); });
      },
      nb::arg("console"), nb::arg("config"), text_or_none, out_or_none, nb::arg("overrides"), nb::arg("task_time"),
      nb::arg("jobs").none(), "Command sweep plan.");
  module.def(
      "sweep_collect",
      [](const Functions& console, const std::string& directory) {
        SweepTaskArguments arguments;
        arguments.sweep = directory + "/sweep.toml";
        arguments.out = directory;
        return outcome(console, [&] { return sweep_collect(arguments); });
      },
      nb::arg("console"), nb::arg("directory"), "Command sweep collect, of the sweep that a directory holds.");
  module.def(
      "check",
      [](const Functions& console, const std::string& path) { return outcome(console, [&] { return check(path); }); },
      nb::arg("console"), nb::arg("path"), "Command check.");
  module.def(
      "analyze",
      [](const Functions& console, std::string path, std::optional<std::string> out, std::optional<double> time_step,
         std::optional<double> longest_lag, std::optional<double> fit_from, int every, bool collective) {
        const AnalyzeArguments arguments{std::move(path), std::move(out), time_step, longest_lag,
                                         fit_from,        every,          collective};
        return outcome(console, [&] { return analyze(arguments); });
      },
      nb::arg("console"), nb::arg("path"), out_or_none, nb::arg("time_step").none(), nb::arg("longest_lag").none(),
      nb::arg("fit_from").none(), nb::arg("every"), nb::arg("collective"), "Command analyze.");
  module.def(
      "report",
      [](const Functions& console, Strings directories, std::optional<std::string> out) {
        const ReportArguments arguments{std::move(directories), std::move(out)};
        return outcome(console, [&] { return report(arguments); });
      },
      nb::arg("console"), nb::arg("directories"), out_or_none, "Command report.");
  module.def(
      "map",
      [](const Functions& console, std::string table, std::string x, std::string y, Strings values, Strings levels,
         Strings where, bool log_x, bool log_y, std::optional<std::string> out, std::optional<std::string> csv) {
        const MapArguments arguments{std::move(table), std::move(x), std::move(y), std::move(values), std::move(levels),
                                     std::move(where), log_x,        log_y,        std::move(out),    std::move(csv)};
        return outcome(console, [&] { return map(arguments); });
      },
      nb::arg("console"), nb::arg("table"), nb::arg("x"), nb::arg("y"), nb::arg("values"), nb::arg("levels"),
      nb::arg("where"), nb::arg("log_x"), nb::arg("log_y"), out_or_none, nb::arg("csv").none(), "Command map.");
}

}  // namespace hardbody::python
