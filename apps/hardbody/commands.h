#pragma once

/// The subcommands, one source file each. They return the program's exit status and throw what errors.h says.

#include <optional>
#include <string>
#include <vector>

namespace hardbody {

struct RunArguments {
  std::string config;                  ///< path of the TOML file
  std::optional<std::string> out;      ///< run directory; by default out/<stem of the config>
  std::vector<std::string> overrides;  ///< section.key=value
  bool force = false;                  ///< overwrite an existing run
};

struct SweepArguments {
  std::string sweep;               ///< path of the TOML file
  std::optional<std::string> out;  ///< directory of the sweep; by default out/<stem of the file>
  std::optional<int> jobs;         ///< runs at a time; by default one for each processor
};

/// An empty path: standard output.
int init(const std::string& path, const std::string& template_name);
int run(const RunArguments& arguments);
int resume(const std::string& path);
int sweep(const SweepArguments& arguments);
int check(const std::string& path);
int replay(const std::string& path);
/// "-": standard input.
int distance(const std::string& path);
/// The formats of its lines, for --help.
std::string distance_help();

}  // namespace hardbody
