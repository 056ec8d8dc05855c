#pragma once

/// Subcommands, one source file each. They return the program's exit status and throw the exceptions described in
/// errors.h.

#include <optional>
#include <string>
#include <vector>

namespace hardbody {

struct RunArguments {
  std::string config;                  ///< path of the TOML file
  std::optional<std::string> text;     ///< config as TOML, without a file; `config` is then its name in messages
  std::optional<std::string> out;      ///< run directory; by default out/<stem of the config>
  std::vector<std::string> overrides;  ///< section.key=value
  bool force = false;                  ///< overwrite an existing run
  int replicas = 1;                    ///< runs with different seeds; more than one: `out` is the directory of a sweep
  std::vector<std::string> program;    ///< command that runs replicas, as in SweepArguments
};

struct ResumeArguments {
  std::string path;                    ///< run directory
  std::vector<std::string> overrides;  ///< section.key=value of keys that change no result
};

struct ExtendArguments {
  std::string path;  ///< directory of a finished run
  double time = 0;   ///< length of the whole production, as production.time
};

struct AnalyzeArguments {
  std::string path;                   ///< path of a run directory, or of a .gsd file
  std::optional<std::string> out;     ///< output directory; by default analysis/ beside the file
  std::optional<double> time_step;    ///< time between two steps; nullopt: the stored times
  std::optional<double> longest_lag;  ///< longest lag; nullopt: a quarter of the trajectory
  std::optional<double> fit_from;  ///< lag from which decays are fitted; nullopt: as in the run itself, or by the MSD
  int every = 1;                   ///< stride: each `every`-th frame is read
  bool collective = false;         ///< whether F(q, t) / S(q) is computed, too; always if the run itself measured it
};

struct SweepArguments {
  std::string sweep;                   ///< path of the TOML file
  std::optional<std::string> text;     ///< sweep as TOML, without a file; `sweep` is then its name in messages
  std::optional<std::string> out;      ///< directory of the sweep; by default out/<stem of the file>
  std::optional<int> jobs;             ///< number of simultaneous runs; by default one for each processor
  std::optional<std::string> on;       ///< engine that runs it as tasks: slurm, local, or a profile of Snakemake
  double task_time = 600;              ///< wished length of such a task of several runs, in seconds
  std::vector<std::string> overrides;  ///< section.key=value, or grid.section.key=list
  std::vector<std::string> program;    ///< command that the subcommands of a point are appended to; empty: this program
};

struct MapArguments {
  std::string table;                ///< path of a sweep's directory, or of a table like its sweep.csv
  std::string x;                    ///< column of the x axis
  std::string y;                    ///< column of the y axis
  std::vector<std::string> values;  ///< columns whose contour lines are drawn
  std::vector<std::string> levels;  ///< levels of each value, separated by commas; empty: chosen automatically
  std::vector<std::string> where;   ///< filters of the form column=value
  bool log_x = false;
  bool log_y = false;
  std::optional<std::string> out;  ///< output file of the drawing; by default beside the table
  std::optional<std::string> csv;  ///< output file of the lines as numbers; by default beside the table
};

struct ReportArguments {
  std::vector<std::string> directories;  ///< run directories
  std::optional<std::string> out;        ///< HTML file; by default report.html in the directory, if it is one
};

/// Writes a template config; an empty path means standard output.
int init(const std::string& path, const std::string& template_name);
int run(const RunArguments& arguments);
int resume(const ResumeArguments& arguments);
int extend(const ExtendArguments& arguments);
int sweep(const SweepArguments& arguments);
/// Runs a sweep as tasks by Snakemake, on the engine that `on` names. Returns 75 if some are to do at the end.
int sweep_on(const SweepArguments& arguments);
int map(const MapArguments& arguments);
int check(const std::string& path);
int replay(const std::string& path);
int analyze(const AnalyzeArguments& arguments);
int report(const ReportArguments& arguments);
/// Answers the lines of a file; "-" means standard input.
int distance(const std::string& path);
/// Returns the description of the input and output lines for --help.
std::string distance_help();

}  // namespace hardbody
