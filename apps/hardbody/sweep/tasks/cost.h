#pragma once

/// Expected costs of the runs of a sweep, by those that are done.

#include "sweep/results.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace hardbody {

/// Expected cost of a run.
struct Cost {
  double seconds;  ///< time on the processors of the runs that are done
  double memory;   ///< bytes
};

/// Interpolates costs over the keys of a sweep: means of the logarithms of the costs of finished runs, weighted by
/// 1 / distance^2 to the nearest of them. Keys that are numbers are scaled to the unit interval, others are equal or
/// not.
class Costs {
 public:
  explicit Costs(const std::vector<PointRecord>& records);

  /// Returns the cost of a run; nullopt if no run is done.
  std::optional<Cost> of(std::size_t k) const;

  /// Returns the factor by which a predicted time is typically off, at least 1: root mean square of the logarithms of
  /// predicted / true time of finished points, each predicted by the others. nullopt for fewer than three points.
  std::optional<double> error() const;

 private:
  std::optional<Cost> predicted(std::size_t k, bool by_other_points) const;
  double distance(std::size_t a, std::size_t b) const;

  const std::vector<PointRecord>& records_;
  std::vector<std::vector<double>> places_;  ///< keys of each record, numbers in [0, 1]; NaN for other keys
  std::vector<std::size_t> finished_;
};

}  // namespace hardbody
