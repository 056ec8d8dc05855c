#pragma once

#include <string>
#include <vector>

namespace hardbody {

/// Runs the program: parses the command line and calls its subcommand. Errors are printed in one line on stderr.
/// Returns the exit status. `program` is the command that sweeps run their points with, see SweepArguments.
int run_command_line(int argc, char** argv, std::vector<std::string> program = {});

}  // namespace hardbody
