#pragma once

/// Status and results of the points of a sweep, and the table of all.

#include "sweep/grid.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

enum class PointStatus { pending, running, stopped, done, failed };

/// Returns the name, "pending", ..
const char* to_string(PointStatus status);

/// Observable as printed in summary.json; empty texts stand for null.
struct PrintedEstimate {
  std::string name;
  std::string value;
  std::string error;
  std::string missing{};  ///< reason for which there is no value
};

/// Results of a completed run, from its summary.json.
struct PointResults {
  std::string equilibration_time;
  std::string production_time;
  std::vector<PrintedEstimate> observables;  ///< scalar observables
  bool equilibrated = false;
  bool sound = false;  ///< whether no defect was found
  // Timing
  std::string wall_seconds;
  std::string collisions_per_second;
};

/// Point with its status.
struct PointRecord {
  SweepPoint point;
  std::int64_t seed = 1;
  std::optional<std::size_t> starts_from;  ///< index of another point, whose last state it compresses
  PointStatus status = PointStatus::pending;
  std::string message;  ///< reason for the failure
  std::optional<PointResults> results;
};

/// Returns the results of the run in `directory` if it is complete. Throws std::runtime_error if its summary is
/// invalid.
std::optional<PointResults> finished_results(const std::filesystem::path& directory);

/// Returns the content of the point's state.json.
std::string state_json(const PointRecord& record);

/// Returns the table: one row a point, in the order of the grid; columns of timing last. The columns of observables are
/// those of all points. The message of a completed point says which values are missing, and why.
std::string sweep_csv(const std::vector<PointRecord>& records);

}  // namespace hardbody
