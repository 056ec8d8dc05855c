#pragma once

/// Tables of a sweep: of its points, of their replicas, and of how these agree.

#include "sweep/replicas.h"
#include "sweep/results.h"

#include <string>
#include <vector>

namespace hardbody {

inline constexpr const char* kReplicasTableFile = "replicas.csv";
inline constexpr const char* kAgreementTableFile = "agreement.csv";

/// Returns sweep.csv: one row a point, in the order of the grid; columns of timing last. The columns of observables are
/// those of all points. The message of a completed point says which values are missing, and why, and where replicas
/// disagree.
std::string sweep_csv(const std::vector<PooledPoint>& points, int replicas);

/// Returns replicas.csv: one row a run, with the columns of sweep.csv and its number among the replicas of the point.
std::string replicas_csv(const std::vector<PointRecord>& records);

/// Returns agreement.csv: one row for each observable of a point with two replicas that are done.
std::string agreement_csv(const std::vector<PooledPoint>& points);

}  // namespace hardbody
