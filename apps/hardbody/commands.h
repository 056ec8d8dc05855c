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

struct ReportArguments {
  std::vector<std::string> directories;  ///< of runs
  std::optional<std::string> out;        ///< HTML file; by default report.html in the directory, if it is one
};

/// An empty path: standard output.
int init(const std::string& path, const std::string& template_name);
int run(const RunArguments& arguments);
int resume(const std::string& path);
int check(const std::string& path);
int replay(const std::string& path);
int report(const ReportArguments& arguments);
/// "-": standard input.
int distance(const std::string& path);
/// The formats of its lines, for --help.
std::string distance_help();

}  // namespace hardbody
