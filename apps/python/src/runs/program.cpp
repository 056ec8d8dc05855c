#include <command_line.h>
#include "base/gil.h"
#include "runs/bind.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <csignal>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

namespace nb = nanobind;

/// Removes the handlers that Python has installed at its start. An ignored SIGINT, as of a command in the background,
/// is not Python's doing.
void restore_default_signals() {
  for (const int signal : {SIGINT, SIGPIPE, SIGXFSZ}) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN && signal == SIGINT) std::signal(signal, SIG_IGN);
  }
}

int run_program(const std::vector<nb::bytes>& arguments, std::vector<std::string> program) {
  std::vector<std::string> words = {"hardbody"};
  for (const nb::bytes& argument : arguments) words.emplace_back(argument.c_str(), argument.size());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const GilReleased released;
  restore_default_signals();
  const int status = run_command_line(static_cast<int>(words.size()), pointers.data(), std::move(program));
  (void)std::fflush(stdout);
  return status;
}

}  // namespace

void bind_program(nb::module_& module) {
  module.def("main", &run_program, nb::arg("arguments"), nb::arg("program"),
             "Runs the program `hardbody` in place of this process's own work; returns its exit status.\n"
             "\n"
             "arguments: those of the command line. program: the command that sweeps run their points with.");
}

}  // namespace hardbody::python
