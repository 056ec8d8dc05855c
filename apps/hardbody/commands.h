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

struct AnalyzeArguments {
  std::string path;                   ///< of a run directory, or of a .gsd file
  std::optional<std::string> out;     ///< by default analysis/ beside the file
  std::optional<double> time_step;    ///< time between two steps; nothing: the times that are stored
  std::optional<double> longest_lag;  ///< nothing: a quarter of the trajectory
  int every = 1;                      ///< frames taken
};

/// An empty path: standard output.
int init(const std::string& path, const std::string& template_name);
int run(const RunArguments& arguments);
int resume(const std::string& path);
int check(const std::string& path);
int replay(const std::string& path);
int analyze(const AnalyzeArguments& arguments);
/// "-": standard input.
int distance(const std::string& path);
/// The formats of its lines, for --help.
std::string distance_help();

}  // namespace hardbody
