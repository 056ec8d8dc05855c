#pragma once

/// Whether order and pressure of a nematic or a crystal are stationary.

#include "base/archive.h"
#include "observables/lag_sums.h"

#include <ed/equilibration.h>
#include <ed/snapshot.h>

#include <Eigen/Core>

#include <cstddef>
#include <utility>
#include <vector>

namespace ed::internal {

/// Returns the mean over the eight octants of the box of the largest eigenvalue of Q of the bodies in each, weighted
/// with their numbers. Of a uniform nematic it is about S of all, of domains it is larger.
double octant_order(const Snapshot& snapshot, double box, const std::vector<BodyRange>& ranges);

/// Values that tell whether a run is stationary, sampled once a time unit.
class Stationarity {
 public:
  /// `ranges`: bodies whose rotation changes.
  explicit Stationarity(std::vector<BodyRange> ranges = {}) : ranges_(std::move(ranges)) {}

  /// Begins with a box, of bodies with this mean radius.
  void begin(double box, double length) {
    box_ = box;
    length_ = length;
  }

  /// Adds a sample; `Z` is that of the last time unit.
  void add(const Snapshot& now, double Z);

  /// Returns whether samples should be judged now: every eighth time, from kLeastSamples on.
  bool due() const;

  /// Judges the last two thirds of the samples; `forgotten`: whether positions have decayed.
  Order judge(bool forgotten) const;

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.box_, self.length_, self.samples_, self.per_mean_, self.in_sum_, self.sum_, self.means_,
            self.vectors_);
    expect(archive, self.fits(), "the equilibration does not fit together");
  }

 private:
  /// Z, S, its octants' and the strongest intensity.
  using Sample = Eigen::Vector4d;

  bool fits() const;
  double strongest_intensity(const Snapshot& now);
  double order_of(const Snapshot& now) const;

  double box_ = 0;
  double length_ = 0;
  std::vector<BodyRange> ranges_;
  int samples_ = 0;
  int per_mean_ = 1;  ///< number of samples of each mean
  int in_sum_ = 0;    ///< number of samples in sum_
  Sample sum_ = Sample::Zero();
  std::vector<Sample> means_;
  std::vector<Eigen::Vector3i> vectors_;  ///< strongest wave vectors of the latest search
};

}  // namespace ed::internal
