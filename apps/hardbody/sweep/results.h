#pragma once

/// Status and results of the points of a sweep.

#include "sweep/grid.h"
#include "sweep/tasks/cost_model.h"

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
  std::string missing{};      ///< reason for which there is no value
  bool of_direction = false;  ///< component of a director, which every run has for itself

  bool operator==(const PrintedEstimate&) const = default;
};

/// Results of a completed run, from its summary.json.
struct PointResults {
  std::string equilibration_time;
  std::string production_time;
  std::vector<PrintedEstimate> observables;  ///< scalar observables
  std::string wave_number;                   ///< first one of F_self, for tau_F, beta_F and t_F_1overe
  bool equilibrated = false;
  bool sound = false;  ///< whether no defect was found
  // Timing
  std::string wall_seconds;
  std::string collisions_per_second;
  std::string peak_memory_bytes;
};

/// Point, or one of its replicas, with its status.
struct PointRecord {
  SweepPoint point;
  std::string directory;  ///< name of the run's directory
  int replica = 0;        ///< number of the run among the replicas of its point
  std::int64_t seed = 1;
  std::optional<std::size_t> starts_from;  ///< index of another record, whose last state it compresses
  PointStatus status = PointStatus::pending;
  bool for_good = false;  ///< true if a run that has failed would fail again
  std::string message;    ///< reason for the failure
  std::string note{};     ///< disagreement of replicas, for a point that is done
  std::optional<PointResults> results;
  std::optional<Cost> cost{};  ///< cost by the config; nullopt if that is invalid
};

/// Returns whether nothing is to do: the run is done, or has failed for good.
bool is_over(const PointRecord& record);

/// Returns the results of the run in `directory` if it is complete. Throws std::runtime_error if its summary is
/// invalid.
std::optional<PointResults> finished_results(const std::filesystem::path& directory);

/// Returns the content of the run's state.json; `replicas` is the number of runs of a point.
std::string state_json(const PointRecord& record, int replicas);

}  // namespace hardbody
