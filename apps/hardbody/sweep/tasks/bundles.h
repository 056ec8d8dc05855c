#pragma once

/// Tasks of a cluster: runs that are made one after the other.

#include "sweep/results.h"
#include "sweep/tasks/cost.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace hardbody {

struct Bundle {
  int id = 0;                     ///< number, from 1
  std::vector<std::size_t> runs;  ///< indices of records, in the order in which they are run
  std::optional<int> after;       ///< id of the bundle that ends before this one may start
  std::optional<double> seconds;  ///< expected time of all runs
  std::optional<double> memory;   ///< expected memory of the largest, bytes
};

/// Bundles the runs that are neither done nor failed, so that a bundle takes about `task_seconds`: at most that, unless
/// it is one run. Runs of unknown cost are bundles of their own. A run and the one that it starts from are in one
/// bundle, in this order, or in two, one after the other.
///
/// `jobs`: number of bundles that run at once, if it is known. Runs outside chains are then in at least `jobs` bundles
/// of about the same time, or each in its own if there are fewer. A chain is one bundle if that is short enough, since
/// its runs wait for each other anyway.
std::vector<Bundle> bundles_of(const std::vector<PointRecord>& records, const std::vector<std::optional<Cost>>& costs,
                               double task_seconds, const std::optional<int>& jobs = std::nullopt);

}  // namespace hardbody
