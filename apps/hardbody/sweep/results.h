#pragma once

/// What a sweep knows of its points: where each stands, what it has measured, and the table of all.

#include "sweep/grid.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

enum class PointStatus { pending, running, stopped, done, failed };

/// "pending", ..
const char* to_string(PointStatus status);

/// An observable as summary.json prints it; empty texts where it says null.
struct PrintedEstimate {
  std::string name;
  std::string value;
  std::string error;
  std::string missing{};  ///< why there is no value
};

/// Of a run that is over, from its summary.json.
struct PointResults {
  std::string equilibration_time;
  std::string production_time;
  std::vector<PrintedEstimate> observables;  ///< the scalar ones
  bool equilibrated = false;
  bool sound = false;  ///< no defect was found
  // Timing
  std::string wall_seconds;
  std::string collisions_per_second;
};

/// A point and how it stands.
struct PointRecord {
  SweepPoint point;
  std::int64_t seed = 1;
  std::optional<std::size_t> starts_from;  ///< another point, whose last state it compresses
  PointStatus status = PointStatus::pending;
  std::string message;  ///< why it failed
  std::optional<PointResults> results;
};

/// Of the run in `directory`, if it is over. Throws std::runtime_error if its summary is none.
std::optional<PointResults> finished_results(const std::filesystem::path& directory);

/// The point's state.json.
std::string state_json(const PointRecord& record);

/// One row a point, in the order of the grid; columns of timing last. Observables are those of all points. The message
/// of a point that is done says which values are missing, and why.
std::string sweep_csv(const std::vector<PointRecord>& records);

}  // namespace hardbody
