#pragma once

/// Replicas of a point: runs that differ in their seed alone, and the row that they are pooled to.

#include "sweep/results.h"

#include <ed/replicas.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

inline constexpr int kMostReplicas = 1000;

/// Returns the name of a replica's directory: that of the point for replica 0, NAME_replica=K for the others. A point
/// without a name, in a sweep without a grid, has replica=0, replica=1, ...
std::string replica_directory(std::string_view point, int replica);

/// Pooled value of an observable.
struct PooledValue {
  std::string observable;
  ed::Pooled pooled;
};

/// Point with what its replicas are pooled to.
struct PooledPoint {
  PointRecord record;      ///< values of the replicas that are done, pooled; those of the run itself for a single one
  std::size_t number = 0;  ///< replicas with results
  std::vector<PooledValue> agreement;  ///< observables that all these replicas have; empty for fewer than two
};

/// Pools the replicas of a point. A value is missing if one of the replicas has none. The point has failed if one of
/// them has, or if two are the same run, because nothing in it depends on the seed; it is done if all are.
PooledPoint pooled_point(std::span<const PointRecord> replicas);

}  // namespace hardbody
