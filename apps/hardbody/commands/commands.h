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
  std::optional<double> fit_from;     ///< lag from which decays are fitted; nothing: as the run itself has done
  int every = 1;                      ///< frames taken
};

struct SweepArguments {
  std::string sweep;               ///< path of the TOML file
  std::optional<std::string> out;  ///< directory of the sweep; by default out/<stem of the file>
  std::optional<int> jobs;         ///< runs at a time; by default one for each processor
};

struct MapArguments {
  std::string table;                ///< path of a sweep's directory, or of a table like its sweep.csv
  std::string x;                    ///< column
  std::string y;                    ///< column
  std::vector<std::string> values;  ///< columns whose lines are wanted
  std::vector<std::string> levels;  ///< of each value, with commas between; empty: chosen
  std::vector<std::string> where;   ///< column=value
  bool log_x = false;
  bool log_y = false;
  std::optional<std::string> out;  ///< the drawing; by default beside the table
  std::optional<std::string> csv;  ///< the lines as numbers; the same
};

struct ReportArguments {
  std::vector<std::string> directories;  ///< of runs
  std::optional<std::string> out;        ///< HTML file; by default report.html in the directory, if it is one
};

/// An empty path: standard output.
int init(const std::string& path, const std::string& template_name);
int run(const RunArguments& arguments);
int resume(const std::string& path);
int sweep(const SweepArguments& arguments);
int map(const MapArguments& arguments);
int check(const std::string& path);
int replay(const std::string& path);
int analyze(const AnalyzeArguments& arguments);
int report(const ReportArguments& arguments);
/// "-": standard input.
int distance(const std::string& path);
/// The formats of its lines, for --help.
std::string distance_help();

}  // namespace hardbody
