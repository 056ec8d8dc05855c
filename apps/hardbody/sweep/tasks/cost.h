#pragma once

/// Expected costs of the runs of a sweep, by their configs and by those that are done.

#include "sweep/results.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace hardbody {

/// Costs by configs, times a factor that is interpolated over the keys of a sweep: means of the logarithms of true
/// cost / cost by config of finished runs, weighted by 1 / distance^2 to the nearest of them. Keys that are numbers are
/// scaled to the unit interval, others are equal or not.
class Costs {
 public:
  explicit Costs(const std::vector<PointRecord>& records);

  /// Returns the cost of a run; nullopt if its config is invalid.
  std::optional<Cost> of(std::size_t k) const;

  /// Returns the factor by which a predicted time is typically off, at least 1: root mean square of the logarithms of
  /// predicted / true time of finished points, each predicted by the others; that of configs for fewer than three
  /// points.
  double error() const;

 private:
  Cost predicted(std::size_t k, bool by_other_points) const;
  double distance(std::size_t a, std::size_t b) const;

  const std::vector<PointRecord>& records_;
  std::vector<std::vector<double>> places_;  ///< keys of each record, numbers in [0, 1]; NaN for other keys
  std::vector<std::size_t> finished_;
};

}  // namespace hardbody
