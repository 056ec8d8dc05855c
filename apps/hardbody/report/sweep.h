#pragma once

#include "report/run.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Number in the table of a sweep; NaN: none.
struct Measured {
  double value;
  double error;
  std::string missing{};           ///< reason for which there is none, if the point's run gives it
  std::vector<double> replicas{};  ///< values that it is the mean of; empty for a single run
};

struct SweepPointReport {
  std::vector<std::string> keys;  ///< values of the swept keys, as in the table
  std::vector<Measured> values;   ///< values of the observables
  std::string status;             ///< "done", "failed", ..
  std::string message;            ///< reason for which it failed or cannot be shown
  std::string equilibrated;       ///< "true", "false" or empty
  std::string directory;          ///< name of the directory; empty: none was found
  std::optional<RunReport> run;   ///< run of a point that has results; of replicas the first one
  std::size_t group = 0;          ///< index in SweepReport::groups
};

struct SweepReport {
  std::filesystem::path path;
  std::string name;
  std::string title;
  std::vector<std::string> keys;      ///< swept keys: system.packing_fraction
  std::vector<Headline> observables;  ///< names of the observables; their values are those of the points
  std::vector<SweepPointReport> points;
  std::vector<std::vector<Measured>> groups;  ///< values of points that differ in their seed alone, pooled
};

/// Returns the value of a point that counts; NaN if there is none. A failed point's values are no results.
double value_at(const SweepPointReport& point, std::size_t observable);

/// Pools an observable of several points, as the replicas of one; their values are its replicas. Missing, as that of
/// replicas, if one of the points is done without a value: a mean over the others would be biased.
Measured pooled_over(const std::vector<const SweepPointReport*>& points, std::size_t observable);

/// Returns whether the directory holds a sweep.
bool is_sweep(const std::filesystem::path& directory);

/// Reads a sweep. Throws InputError if its table cannot be read. A fault of a point's run is reported in the point's
/// message.
SweepReport read_sweep_report(const std::filesystem::path& directory);

}  // namespace hardbody
