#pragma once

#include "report/run.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// A number of the table of a sweep; NaN: none.
struct Measured {
  double value;
  double error;
  std::string missing{};  ///< why there is none, if the point's run says so
};

struct SweepPointReport {
  std::vector<std::string> keys;  ///< values of the swept keys, as the table has them
  std::vector<Measured> values;   ///< of the observables
  std::string status;             ///< "done", "failed", ..
  std::string message;            ///< why it failed or cannot be shown
  std::string equilibrated;       ///< "true", "false" or nothing
  std::string directory;          ///< name; empty: none was found
  std::optional<RunReport> run;   ///< of a point that has results
};

struct SweepReport {
  std::filesystem::path path;
  std::string name;
  std::string title;
  std::vector<std::string> keys;      ///< that are swept: system.packing_fraction
  std::vector<Headline> observables;  ///< what they are called; their values are those of the points
  std::vector<SweepPointReport> points;
};

/// Whether the directory holds a sweep.
bool is_sweep(const std::filesystem::path& directory);

/// Throws InputError if its table cannot be read. What is wrong with the run of a point is said in its message.
SweepReport read_sweep_report(const std::filesystem::path& directory);

}  // namespace hardbody
