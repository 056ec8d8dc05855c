#pragma once

/// Records of a sweep with the files in which its directory shows them.

#include "sweep/replicas.h"
#include "sweep/results.h"
#include "sweep/workers.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hardbody {

/// Runs of a sweep; the replicas of a point one after the other.
class SweepState {
 public:
  SweepState(std::filesystem::path directory, std::vector<PointRecord> records, int replicas);

  const std::vector<PointRecord>& records() const { return records_; }
  int replicas() const { return replicas_; }

  /// Takes over what the directory holds of run k.
  void take_up(std::size_t k);
  /// Takes over the results of run k, whose process has ended by itself: it is done or failed.
  void end(std::size_t k, const WorkerEnd& end);
  void settle(std::size_t k, PointStatus status, const std::string& message);
  /// Settles run k as failed in a way that another attempt would repeat.
  void fail_for_good(std::size_t k, const std::string& message);

  /// Writes state.json of run k. Throws WriteError.
  void write_state(std::size_t k) const;
  /// Writes sweep.csv, with replicas also replicas.csv and agreement.csv. Throws WriteError.
  void write_tables();

  /// Returns the number of points with this status.
  std::size_t count(PointStatus status);
  /// Returns whether all runs are done or have failed for good. A point with a failed replica has failed though others
  /// may be to do.
  bool is_over() const;
  /// Returns how many points are done, and a line for each that has failed.
  std::string account();

 private:
  const std::vector<PooledPoint>& points();

  std::filesystem::path directory_;
  std::vector<PointRecord> records_;
  int replicas_;
  std::vector<PooledPoint> points_;
  std::vector<bool> changed_;  ///< points that are to be pooled again
};

}  // namespace hardbody
